// The table of subcommands, in the order in which a user meets them.
#include "command.h"

namespace sdfgrid::cli {
namespace {

constexpr Command kCommands[] = {
    {"convert", "IN -o OUT.vdb", "turn a mesh into a sparse distance grid", add_convert},
    {"compare", "A B", "measure a grid against a mesh, or two of either", add_compare},
    {"info", "FILE", "say what a mesh or a grid holds", add_info},
    {"render", "IN -o OUT.png|.exr", "show a grid or a mesh in a picture", add_render},
};

}  // namespace

std::span<const Command> commands() { return kCommands; }

}  // namespace sdfgrid::cli
