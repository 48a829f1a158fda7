// grid/compare_claims.h: what a grid claims about distances, at places drawn at random. Internal to
// grid/compare.h; includes OpenVDB.
#pragma once

#include <openvdb/openvdb.h>

#include <cstdint>
#include <glm/vec3.hpp>
#include <optional>
#include <vector>

#include "sdfgrid/core/lattice.h"
#include "sdfgrid/grid/grid.h"

namespace sdfgrid {

// Random numbers by counter: sample i is the same whoever draws it, and when.
class CounterRandom {
 public:
  CounterRandom(std::uint64_t seed, std::uint64_t counter);
  std::uint64_t next();  // splitmix64 (Steele, Lea and Flood 2014)
  double unit();         // in [0, 1)
  std::size_t below(std::size_t count);

 private:
  std::uint64_t state_;
};

// A signed distance at a place, from whoever.
struct Claim {
  glm::dvec3 world{0.0};
  double value = 0;       // world units, negative inside
  bool at_least = false;  // the distance is |value| or more
  bool has_sign = true;   // false where either sign is right
};

class GridClaims {
 public:
  // Throws Error{input} if the grid has no active voxels. The grid must not change meanwhile.
  explicit GridClaims(const Grid& grid);

  [[nodiscard]] std::size_t active_voxels() const { return first_.back(); }
  // Tiles that are active have one value for many voxels, which is no distance: they are not
  // measured.
  [[nodiscard]] std::size_t active_tiles() const { return active_tiles_; }
  [[nodiscard]] double voxel() const { return lattice_.voxel; }
  [[nodiscard]] bool is_signed() const { return signed_; }

  // Sample `i` of `count` samples spread over the active voxels in their order: neighbours in i are
  // neighbours in space. With count == active_voxels(), every voxel.
  [[nodiscard]] Claim at_voxel(std::size_t i, std::size_t count, std::uint64_t seed) const;
  // The same for random points in cells; nothing if no cell with eight active corners was found.
  [[nodiscard]] std::optional<Claim> in_cell(std::size_t i, std::size_t count,
                                             std::uint64_t seed) const;
  // The same for voxels that are not active: half of the samples in bricks, half anywhere around.
  [[nodiscard]] std::optional<Claim> beyond_band(std::size_t i, std::size_t count,
                                                 std::uint64_t seed) const;

  // What the grid says of any place: the trilinear value, a bound if inactive voxels take part.
  [[nodiscard]] Claim at(const glm::dvec3& world) const;

  // Whether an inactive value is the background, or minus the one inside.
  [[nodiscard]] bool is_background(double value) const;

 private:
  using Tree = openvdb::FloatTree;
  using Accessor = openvdb::FloatGrid::ConstUnsafeAccessor;

  [[nodiscard]] openvdb::Coord active_voxel(std::size_t k) const;
  [[nodiscard]] bool beyond(double value) const;
  [[nodiscard]] Claim stored(const openvdb::Coord& at, float value, bool active) const;
  void find_inner_background();

  openvdb::FloatGrid::ConstPtr grid_;
  Lattice lattice_;
  bool signed_;
  std::vector<const Tree::LeafNodeType*> leaves_;
  std::vector<std::size_t>
      first_;  // number of the first active voxel of each leaf, and their total
  std::size_t active_tiles_ = 0;
  openvdb::CoordBBox around_;  // the active voxels and some more
  double outer_background_;    // > 0
  double inner_background_;    // > 0; infinite if nothing inactive is negative
};

}  // namespace sdfgrid
