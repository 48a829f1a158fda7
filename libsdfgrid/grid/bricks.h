// grid/bricks.h: the 8^3 bricks of a Grid by their coordinates, for those who change them in place.
// OpenVDB stays behind it.
#pragma once

#include <cstdint>
#include <glm/vec3.hpp>
#include <memory>
#include <vector>

#include "sdfgrid/grid/grid.h"

namespace sdfgrid {

inline constexpr int kBrickSamples = 512;  // z fastest: (x * 8 + y) * 8 + z
inline constexpr int kBrickWords = 8;      // of a bit a sample: word x, bit y * 8 + z

// What the grid holds of one brick: samples, or one value everywhere.
struct GridBrick {
  float* values = nullptr;          // kBrickSamples, world units; null where the grid has no leaf
  std::uint64_t* active = nullptr;  // kBrickWords; null with `values`
  float constant = 0;               // the value of all samples where `values` is null
};

// A brick, and which of its samples became others: a superset will do.
struct BrickChange {
  glm::ivec3 brick{0};
  std::uint64_t samples[kBrickWords] = {};
};

// Looks bricks up, makes and drops them. Pointers stay good until that brick is dropped. One object
// serves one thread (it remembers the way to the last brick); finding is safe beside other finders,
// making and dropping is not. Keeps the grid alive.
class GridBricks {
 public:
  explicit GridBricks(const Grid& grid);
  GridBricks(const GridBricks& other);
  GridBricks& operator=(const GridBricks&) = delete;
  ~GridBricks();

  // `brick` is the sample's index >> 3.
  [[nodiscard]] GridBrick find(const glm::ivec3& brick) const;
  // Ask for what find() will read, ahead of time: first the one for all bricks, then the other.
  void fetch_place(const glm::ivec3& brick) const;
  void fetch(const glm::ivec3& brick) const;
  // As find, but where there was a constant there are samples of it now.
  [[nodiscard]] GridBrick make(const glm::ivec3& brick);
  // The same for who writes all its samples and states: they are not set where it is new.
  [[nodiscard]] GridBrick make_unset(const glm::ivec3& brick);
  // Puts one inactive value in place of the brick.
  void drop(const glm::ivec3& brick, float value);
  // To be called after the last drop, before anybody else reads the grid: makes OpenVDB's accessors
  // forget what was dropped, any of which may remember it. The destructor does it, too.
  void finish();

  // The materials of its kBrickSamples samples (grid/paint.h); null where none is painted. Good
  // until that brick is painted again.
  [[nodiscard]] const std::int32_t* paint(const glm::ivec3& brick) const;
  // Null, or no material but 0, takes the brick's paint away.
  void set_paint(const glm::ivec3& brick, const std::int32_t* materials);

 private:
  struct Access;
  Grid grid_;
  std::unique_ptr<Access> access_;
  bool dropped_ = false;
};

// Samples from lo to hi, both included; empty while lo > hi.
struct IndexBox {
  glm::ivec3 lo{0};
  glm::ivec3 hi{-1};
};

// Every brick of the grid that has samples, in the order of the tree.
[[nodiscard]] std::vector<glm::ivec3> all_bricks(const Grid& grid);

// Every brick from `first` to `last` (bricks, both included) that has samples, or one value below
// `outside`, ordered by x, then y, then z. Visits the nodes of the tree, not the space between.
[[nodiscard]] std::vector<glm::ivec3> bricks_below(const Grid& grid, const glm::ivec3& first,
                                                   const glm::ivec3& last, float outside);

// Puts constants in place of all bricks and larger nodes of one value and state, so that grids with
// the same samples have the same file, whatever was done to them before.
void compact(const Grid& grid);

// The two values of a level set beyond its band, world units.
struct BandLimits {
  float inside;   // < 0
  float outside;  // > 0, the background
};

// `inside` is the value of the first interior tile or inactive interior sample, or minus the
// background in a grid without any.
[[nodiscard]] BandLimits band_limits(const Grid& grid);

}  // namespace sdfgrid
