// grid/live_atlas.h: an atlas that follows the edits of its grid: after a stroke only the bricks
// that changed, and those that share samples with them, are made anew.
#pragma once

#include <cstdint>
#include <glm/vec3.hpp>
#include <span>
#include <vector>

#include "sdfgrid/core/job.h"
#include "sdfgrid/grid/atlas.h"
#include "sdfgrid/grid/bricks.h"
#include "sdfgrid/grid/grid.h"

namespace sdfgrid {

struct PartRanges;  // internal to grid/

class LiveAtlas {
 public:
  // Throws what make_atlas() throws.
  LiveAtlas(const Grid& grid, const Job& job);

  [[nodiscard]] const Atlas& atlas() const { return atlas_; }

  // Makes the atlas say of these bricks (index >> 3) and of the cells beside them what the grid
  // says now. Its field and its crossing cells are then those of make_atlas(); the order of its
  // bricks is not, and jumps may be shorter than they could be. Costs what the bricks cost, except
  // where the grid grew beyond the tables: then all is made anew. Not safe beside readers of the
  // atlas.
  void refresh(std::span<const glm::ivec3> changed, const Job& job);

 private:
  void adopt();
  bool within(const glm::ivec3& slot) const;
  enum class Stale : std::uint8_t { no, slope, all };
  [[nodiscard]] Stale staleness(const glm::ivec3& slot, const PartRanges& parts, int n) const;
  void fetch(const glm::ivec3& slot) const;
  bool copy_brick(const glm::ivec3& brick);
  void refresh_slope(const glm::ivec3& slot);
  void refresh_slot(const glm::ivec3& slot);
  bool gather(const glm::ivec3& slot, float* samples) const;
  std::int32_t take_brick(std::size_t place, bool crossing);
  void free_brick(std::size_t place);
  void move_brick(std::int32_t from, std::int32_t to);
  void shorten_jumps(const glm::ivec3& slot);
  void lengthen_jumps(const glm::ivec3& slot);

  Grid grid_;
  GridBricks bricks_;
  Atlas atlas_;
  std::vector<std::size_t> owner_;           // the place of each brick, kNobody for a free one
  std::vector<std::int32_t> free_crossing_;  // free bricks before atlas_.crossing
  std::vector<std::int32_t> free_other_;     // and after
  std::vector<glm::ivec3> stale_;            // slots of which some samples changed
  std::vector<Stale> marks_;                 // in what, for each slot
};

}  // namespace sdfgrid
