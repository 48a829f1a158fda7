// grid/live_atlas.h: an atlas that follows the edits of its grid: after a stroke only the bricks
// that changed, and those that share samples with them, are made anew.
#pragma once

#include <array>
#include <cstdint>
#include <glm/vec3.hpp>
#include <span>
#include <vector>

#include "sdfgrid/core/job.h"
#include "sdfgrid/grid/atlas.h"
#include "sdfgrid/grid/bricks.h"
#include "sdfgrid/grid/grid.h"

namespace sdfgrid {

class LiveAtlas {
 public:
  // Throws what make_atlas() throws.
  LiveAtlas(const Grid& grid, const Job& job);

  [[nodiscard]] const Atlas& atlas() const { return atlas_; }

  // Makes the atlas say of these samples and of the cells beside them what the grid says now. Its
  // field is then that of make_atlas(), and so are its crossing cells but for the margin, which is
  // that of the steepest brick so far; the order of its bricks is not, and jumps may be shorter
  // than they could be. Costs what the bricks cost, except where the grid grew beyond the tables:
  // then all is made anew. Not safe beside readers of the atlas.
  void refresh(std::span<const BrickChange> changes, const Job& job);

 private:
  // A slot that has samples which changed: for each part of it (copy_part() in atlas_tables.h)
  // which of the changed bricks they are in, or -1.
  struct Target {
    glm::ivec3 slot;
    std::size_t place;
    std::array<std::int32_t, 8> from;
  };

  void adopt();
  [[nodiscard]] bool within(const glm::ivec3& slot) const;
  bool collect(std::span<const BrickChange> changes);
  Target& target_at(const glm::ivec3& slot);
  void fetch(std::int32_t brick) const;
  void fetch_jumps(const glm::ivec3& slot) const;
  [[nodiscard]] bool is_reached(const Target& target, bool inside) const;
  [[nodiscard]] GridBrick part(const Target& target, int n) const;
  void update(const Target& target);
  std::int32_t take_brick(std::size_t place, bool crossing);
  void free_brick(std::size_t place);
  void move_brick(std::int32_t from, std::int32_t to);
  void shorten_jumps(const glm::ivec3& slot);
  void shorten_jumps(const glm::ivec3& slot, int table);
  void lengthen_jumps(const glm::ivec3& slot);

  Grid grid_;
  GridBricks bricks_;
  Atlas atlas_;
  std::vector<std::size_t> owner_;           // the place of each brick, kNobody for a free one
  std::vector<std::int32_t> free_crossing_;  // free bricks before atlas_.crossing
  std::vector<std::int32_t> free_other_;     // and after
  // Of the refresh that runs; kept for their memory.
  std::vector<GridBrick> sources_;  // the bricks that changed, as they are now
  std::vector<Target> targets_;
  std::vector<std::int32_t> found_;   // hash table of targets_ by their places, -1 for free
  std::vector<glm::ivec3> appeared_;  // slots that are crossing now
  std::vector<glm::ivec3> vanished_;  // and that have no crossing brick any more
};

}  // namespace sdfgrid
