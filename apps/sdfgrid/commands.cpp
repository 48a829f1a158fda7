// The table of subcommands, in the order in which a user meets them.
#include "command.h"

namespace sdfgrid::cli {
namespace {

constexpr std::span<const Command> kCommands;

}  // namespace

std::span<const Command> commands() { return kCommands; }

}  // namespace sdfgrid::cli
