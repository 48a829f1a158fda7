// The table of subcommands, in the order in which a user meets them.
#include "command.h"

namespace sdfgrid::cli {
namespace {

constexpr Command kCommands[] = {
    {"convert", "IN -o OUT.vdb", "turn a mesh, a volume or a scene into a sparse distance grid",
     add_convert},
    {"compare", "A B", "measure a grid against a mesh, or two of either", add_compare},
    {"info", "FILE", "say what a mesh, a volume, a grid, a scene, a stroke file or a session holds",
     add_info},
    {"transform", "VOLUME -o OUT", "make a distance transform of a mask, labels or grey values",
     add_transform},
    {"render", "IN -o OUT.png|.exr", "show a grid, a mesh, a volume or a scene in a picture",
     add_render},
    {"sample", "IN -o OUT.npy", "take distances of a grid, a mesh or a scene at points",
     add_sample},
    {"shapes", "[NAME]", "list the shapes and operations of scene files", add_shapes},
    {"chart", "IN -o OUT.svg", "chart time against error on your own input", add_chart},
    {"sculpt", "GRID --strokes FILE -o OUT.vdb", "carve a grid by strokes, with sessions and undo",
     add_sculpt},
};

}  // namespace

std::span<const Command> commands() { return kCommands; }

}  // namespace sdfgrid::cli
