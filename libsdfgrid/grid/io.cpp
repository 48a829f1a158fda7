// Reading and writing .vdb files; declared in grid.h.
#include <openvdb/io/File.h>

#include <filesystem>

#include "sdfgrid/core/atomic_file.h"
#include "sdfgrid/core/error.h"
#include "sdfgrid/grid/grid.h"
#include "sdfgrid/grid/vdb.h"

namespace sdfgrid {
namespace {

// How well a grid in a file serves as the distance grid: higher is better, 0 not at all.
int suitability(const openvdb::GridBase& grid) {
  if (!grid.isType<openvdb::FloatGrid>()) return 0;
  if (grid.getName() == "surface") return 3;
  return grid.getGridClass() == openvdb::GRID_LEVEL_SET ? 2 : 1;
}

}  // namespace

Grid read_grid(const std::string& path) {
  openvdb::initialize();
  if (!std::filesystem::exists(path)) {
    throw input_error(path, "", "no such file", "check the path");
  }
  openvdb::GridBase::Ptr best;
  try {
    openvdb::io::File file(path);
    file.open(false);
    std::string name;
    int best_score = 0;
    const auto all = file.readAllGridMetadata();
    for (const auto& grid : *all) {
      const int score = suitability(*grid);
      if (score > best_score) {
        best_score = score;
        name = grid->getName();
      }
    }
    if (best_score > 0) best = file.readGrid(name);
    file.close();
  } catch (const openvdb::Exception& e) {
    throw input_error(path, "", std::string("not a readable OpenVDB file (") + e.what() + ")",
                      "convert the mesh again, or check that the copy is complete");
  }
  if (!best) {
    throw input_error(path, "", "it holds no float grid", "give a level set or distance grid");
  }
  return from_vdb(openvdb::gridPtrCast<openvdb::FloatGrid>(best), path);
}

void write_grid(const Grid& grid, const std::string& path) {
  write_atomically(path, [&](const std::string& temporary) {
    try {
      openvdb::io::File file(temporary);
      file.setCompression(openvdb::io::COMPRESS_BLOSC | openvdb::io::COMPRESS_ACTIVE_MASK);
      file.write(openvdb::GridCPtrVec{vdb(grid)});
      file.close();
    } catch (const openvdb::Exception& e) {
      throw Error(ErrorKind::failed, path + ": cannot be written (" + e.what() + ")");
    }
  });
}

}  // namespace sdfgrid
