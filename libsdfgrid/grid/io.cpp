// Reading and writing .vdb files; declared in grid.h.
#include <fmt/format.h>
#include <openvdb/io/Archive.h>
#include <openvdb/io/File.h>

#include <array>
#include <cerrno>
#include <cstdint>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <string>
#include <string_view>
#include <vector>

#include "sdfgrid/core/atomic_file.h"
#include "sdfgrid/core/error.h"
#include "sdfgrid/grid/grid.h"
#include "sdfgrid/grid/nanovdb.h"
#include "sdfgrid/grid/paint.h"
#include "sdfgrid/grid/vdb.h"

namespace sdfgrid {
namespace {

// How well a grid in a file serves as the distance grid: higher is better, 0 not at all.
int suitability(const openvdb::GridBase& grid) {
  if (!grid.isType<openvdb::FloatGrid>()) return 0;
  if (grid.getName() == "surface") return 3;
  return grid.getGridClass() == openvdb::GRID_LEVEL_SET ? 2 : 1;
}

// The same for scalar fields such as fog.
int suitability_as_scalars(const openvdb::GridBase& grid) {
  if (!grid.isType<openvdb::FloatGrid>()) return 0;
  if (grid.getName() == "density") return 3;
  return grid.getGridClass() == openvdb::GRID_LEVEL_SET ? 1 : 2;
}

// OpenVDB gives every file a random identifier, so that the same grid never has the same bytes
// twice. Replaces it by a hash of the rest of the file (FNV-1a, twice), in the same form.
void make_identifier_reproducible(const std::string& path) {
  // OpenVDB's header: magic (8 bytes), file format and library versions (3 x 4), whether the file
  // has grid offsets (1), then the identifier as text.
  constexpr std::streamoff kAt = 21;
  constexpr std::size_t kLength = 36;
  std::fstream file(path, std::ios::in | std::ios::out | std::ios::binary);
  std::uint64_t hash[2] = {0xcbf29ce484222325ULL, 0x84222325cbf29ce4ULL};
  std::vector<char> chunk(1 << 20);
  for (std::streamoff offset = 0; file.good();
       offset += static_cast<std::streamoff>(chunk.size())) {
    file.read(chunk.data(), static_cast<std::streamsize>(chunk.size()));
    for (std::streamoff i = 0; i < file.gcount(); ++i) {
      if (offset + i >= kAt && offset + i < kAt + static_cast<std::streamoff>(kLength)) continue;
      const auto byte = static_cast<unsigned char>(chunk[static_cast<std::size_t>(i)]);
      hash[0] = (hash[0] ^ byte) * 0x100000001b3ULL;
      hash[1] = (hash[1] ^ (byte + 1U)) * 0x100000001b3ULL;
    }
  }
  std::string id =
      fmt::format("{:08x}-{:04x}-8{:03x}-8{:03x}-{:012x}", hash[0] >> 32, hash[0] >> 16 & 0xffff,
                  hash[0] & 0xfff, hash[1] >> 52, hash[1] & 0xffffffffffff);
  file.clear();
  file.seekp(kAt);
  file.write(id.data(), kLength);
  if (!file.flush()) throw Error(ErrorKind::failed, path + ": cannot be written");
}

// openvdb::io::File opens its own stream and does not look whether the bytes arrived: on a full
// disk it reports success. This one writes the same bytes to a stream that can be asked.
class StreamArchive : public openvdb::io::Archive {
 public:
  void write_to(std::ostream& out, const openvdb::GridCPtrVec& grids) const {
    constexpr bool kSeekable = true;
    Archive::write(out, grids, kSeekable);
  }
};

bool is_paint(const openvdb::GridBase& grid) {
  return grid.getName() == kPaintName && grid.isType<openvdb::Int32Grid>();
}

bool begins_with(const std::string& path, std::string_view word) {
  std::string begins(word.size(), '\0');
  std::ifstream(path, std::ios::binary).read(begins.data(), std::ssize(begins));
  return begins == word;
}

// By its name or, if that is another, by the word that it begins with.
bool is_nanovdb(const std::string& path) {
  return path.ends_with(".nvdb") || begins_with(path, "NanoVDB");
}

bool is_openvdb(const std::string& path) { return begins_with(path, " BDV"); }

// The grid of the file that suits best, with its paint.
Grid read_best(const std::string& path, int (*score_of)(const openvdb::GridBase& grid)) {
  openvdb::initialize();
  if (!std::filesystem::exists(path)) {
    throw input_error(path, "", "no such file", "check the path");
  }
  if (is_nanovdb(path)) {
    throw input_error(path, "", "it is a NanoVDB file, which is written, but not read",
                      "give the .vdb of the same");
  }
  if (!std::ifstream(path)) {
    throw input_error(path, "", "it cannot be opened", "check its permissions");
  }
  if (!is_openvdb(path)) {
    throw input_error(path, "", "it is no OpenVDB file",
                      "`sdfgrid convert` makes one of a mesh, a volume or a scene");
  }
  openvdb::GridBase::Ptr best;
  openvdb::GridBase::Ptr paint;
  try {
    openvdb::io::File file(path);
    file.open(false);
    std::string name;
    int best_score = 0;
    // Names as the file's index has them: several grids may share one otherwise.
    for (auto at = file.beginName(); at != file.endName(); ++at) {
      const openvdb::GridBase::Ptr known = file.readGridMetadata(at.gridName());
      if (is_paint(*known)) paint = file.readGrid(at.gridName());
      const int score = score_of(*known);
      if (score > best_score) {
        best_score = score;
        name = at.gridName();
      }
    }
    if (best_score > 0) best = file.readGrid(name);
    file.close();
  } catch (const std::exception& e) {  // OpenVDB's own, and what damaged counts make of std's
    throw input_error(path, "", std::string("not a readable OpenVDB file (") + e.what() + ")",
                      "convert the mesh again, or check that the copy is complete");
  }
  if (!best || !best->isType<openvdb::FloatGrid>()) {
    throw input_error(path, "", "it holds no float grid", "give a level set or distance grid");
  }
  Grid grid = from_vdb(openvdb::gridPtrCast<openvdb::FloatGrid>(best), path);
  if (paint && paint->transform() == best->transform()) {
    grid.storage().paint = openvdb::gridPtrCast<openvdb::Int32Grid>(paint);
  }
  return grid;
}

void write_openvdb(const Grid& grid, std::ostream& out) {
  StreamArchive archive;
  archive.setCompression(openvdb::io::COMPRESS_BLOSC | openvdb::io::COMPRESS_ACTIVE_MASK);
  openvdb::GridCPtrVec grids = {vdb(grid)};
  if (has_paint(grid)) grids.push_back(grid.storage().paint);
  archive.write_to(out, grids);
}

}  // namespace

Grid read_grid(const std::string& path) { return read_best(path, suitability); }

Grid read_scalar_grid(const std::string& path) { return read_best(path, suitability_as_scalars); }

const std::vector<std::string>& grid_extensions() {
  static const std::vector<std::string> all = {".vdb", ".nvdb"};
  return all;
}

void check_storable(double voxel) {
  // OpenVDB takes a transform whose determinant is below 3e-15 for singular.
  constexpr double kSmallest = 1.45e-5;
  if (voxel >= kSmallest) return;
  throw Error(
      ErrorKind::usage,
      fmt::format("a voxel of {:.3g} units is too small for a .vdb file, which needs {:.3g} "
                  "or more; scale the mesh up (millimetres for metres)",
                  voxel, kSmallest));
}

void write_grid(const Grid& grid, const std::string& path) {
  check_storable(grid.lattice().voxel);
  const bool nano = path.ends_with(".nvdb");
  write_atomically(path, [&](const std::string& temporary) {
    try {
      std::ofstream file(temporary, std::ios::binary);
      if (nano) {
        write_nanovdb(grid, file);
      } else {
        write_openvdb(grid, file);
      }
      errno = 0;
      file.close();
      if (!file) {
        const std::string reason = errno != 0 ? std::strerror(errno) : "is the disk full?";
        throw Error(ErrorKind::failed, path + ": cannot be written (" + reason + ")");
      }
      if (!nano) make_identifier_reproducible(temporary);
    } catch (const openvdb::Exception& e) {
      throw Error(ErrorKind::failed, path + ": cannot be written (" + e.what() + ")");
    }
  });
}

}  // namespace sdfgrid
