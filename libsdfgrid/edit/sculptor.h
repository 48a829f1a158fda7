// edit/sculptor.h: applies strokes to a distance grid in place, each as cheap as its brush is
// small, and undoes and redoes them to the last bit. Opens no files and reads no clock.
//
// A stroke reads and writes only the bricks that its brush reaches. Bricks are made where they are
// missing, and dropped where they become constant. Afterwards the samples whose distance may be
// wrong (min and max of distances are only bounds) are measured anew: edit/redistance.h.
#pragma once

#include <cstddef>
#include <glm/vec3.hpp>
#include <string>
#include <vector>

#include "sdfgrid/core/job.h"
#include "sdfgrid/edit/redistance.h"
#include "sdfgrid/edit/stroke.h"
#include "sdfgrid/edit/undo.h"
#include "sdfgrid/grid/bricks.h"
#include "sdfgrid/grid/grid.h"

namespace sdfgrid {

struct BrickEdit;  // internal to edit/

enum class Redistance {
  off,    // values stay what min and max made of them: bounds
  local,  // samples that the stroke made doubtful are measured anew
  full,   // so is every sample of the grid
};

struct SculptOptions {
  Redistance redistance = Redistance::local;
  // The samples that strokes may change; if empty, the grid's own, grown on all sides by half the
  // longest of them and at least 64 voxels.
  IndexBox range;
  double max_bricks = 1e6;  // of one stroke
  UndoOptions undo;
};

struct StrokeReport {
  std::size_t dabs = 0;            // places of the brush along the path
  std::size_t bricks_touched = 0;  // bricks whose values changed
  std::size_t remeasured = 0;      // bricks in which distances were measured anew
  std::vector<std::string> warnings;
};

class Sculptor {
 public:
  // Changes `grid` itself. Throws Error{input} if it is no level set, has no samples, or its band
  // is wider than kWidestBand.
  explicit Sculptor(const Grid& grid, const SculptOptions& options = {});
  ~Sculptor();
  Sculptor(const Sculptor&) = delete;
  Sculptor& operator=(const Sculptor&) = delete;

  // Throws Error{usage} for a stroke out of range, Error{cancelled}; the grid is then as before.
  StrokeReport apply(const Stroke& stroke, const Job& job);
  // Throws what apply() would throw of the stroke, and changes nothing.
  void check(const Stroke& stroke, const Job& job);
  // Whether there was a stroke to undo or redo.
  bool undo();
  bool redo();
  // Undoes the last stroke as if it had not been: neither it nor what it displaced can be redone.
  bool take_back();

  // What the last call of the four above changed: what an atlas must refresh. Of bricks that were
  // painted, no samples.
  [[nodiscard]] const std::vector<BrickChange>& touched() const { return touched_; }
  [[nodiscard]] const Grid& grid() const { return grid_; }
  [[nodiscard]] const UndoHistory& history() const { return history_; }
  [[nodiscard]] const IndexBox& range() const { return options_.range; }

 private:
  class Pass;

  Grid grid_;
  SculptOptions options_;
  BandLimits limits_;
  GridBricks bricks_;
  UndoHistory history_;
  std::vector<BrickChange> touched_;
  std::vector<BrickEdit> edits_;  // kept from one stroke to the next
};

}  // namespace sdfgrid
