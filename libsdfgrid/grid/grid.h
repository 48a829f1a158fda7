// grid/grid.h: the sparse distance grid. An OpenVDB float level set at heart (grid/vdb.h hands it
// out), with what it was made from and the error that it states of itself.
#pragma once

#include <cstddef>
#include <glm/vec3.hpp>
#include <map>
#include <memory>
#include <string>
#include <vector>

#include "sdfgrid/core/lattice.h"

namespace sdfgrid {

struct GridStorage;  // holds the OpenVDB grid; defined in grid/vdb.h

// A handle: copies share the same grid, clone() does not.
class Grid {
 public:
  Grid();  // empty, voxel size 1, background 3
  explicit Grid(std::shared_ptr<GridStorage> storage) : storage_(std::move(storage)) {}

  [[nodiscard]] Lattice lattice() const;
  // Distance stored beyond the band, world units, > 0. Inside it may differ (--inwidth).
  [[nodiscard]] float background() const;
  // OpenVDB's word: "level set" (signed, negative inside), "unknown" (distances without sign, or
  // anything), "fog volume" (no distances), "staggered".
  [[nodiscard]] std::string grid_class() const;
  [[nodiscard]] bool is_level_set() const;
  [[nodiscard]] std::size_t active_voxels() const;
  [[nodiscard]] std::size_t bricks() const;  // 8^3 leaves
  [[nodiscard]] std::size_t bytes() const;   // memory of trees and voxels, paint included
  // Index box of the active voxels, inclusive; lo > hi if there are none.
  void active_bounds(glm::ivec3& lo, glm::ivec3& hi) const;
  // Samples of that box along each axis; zeros if there are none.
  [[nodiscard]] glm::ivec3 dims() const;
  // World box of the active voxels; empty if there are none.
  [[nodiscard]] Box bounds() const;
  // Value at an index point, world units, negative inside.
  [[nodiscard]] float value(const glm::ivec3& index) const;
  // Whether any value is below 0.
  [[nodiscard]] bool has_inside() const;

  [[nodiscard]] std::string name() const;
  // Metadata as text, by full name ("sdfgrid:method"); empty if absent.
  [[nodiscard]] std::string metadata(const std::string& key) const;
  [[nodiscard]] std::map<std::string, std::string> all_metadata() const;
  void set_metadata(const std::string& key, const std::string& value);
  void set_metadata(const std::string& key, double value);
  void remove_metadata(const std::string& key);

  [[nodiscard]] Grid clone() const;
  [[nodiscard]] GridStorage& storage() const { return *storage_; }

 private:
  std::shared_ptr<GridStorage> storage_;
};

// Reads the level set of a .vdb file: the grid called `surface`, else the first float level set,
// else the first float grid. Throws Error{input} if there is none or its transform is not uniform.
[[nodiscard]] Grid read_grid(const std::string& path);

// Reads a scalar field, such as fog: the grid called `density`, else the first float grid that is
// no level set, else the first float grid. Throws as read_grid() does.
[[nodiscard]] Grid read_scalar_grid(const std::string& path);

// Throws Error{usage} if a .vdb file cannot hold voxels of that size (below 1.45e-5 units).
void check_storable(double voxel);

// The extensions that write_grid knows, lower case with the dot.
[[nodiscard]] const std::vector<std::string>& grid_extensions();

// Writes `grid` to `path`, as blosc-compressed OpenVDB or, if it is named .nvdb, as uncompressed
// NanoVDB. The file appears whole or not at all: it is written beside its place and renamed. Throws
// Error{failed}.
void write_grid(const Grid& grid, const std::string& path);

}  // namespace sdfgrid
