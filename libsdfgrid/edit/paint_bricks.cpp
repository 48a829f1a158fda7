#include "sdfgrid/edit/paint_bricks.h"

namespace sdfgrid {

void paint_bricks(const Stroke& stroke, const StrokePlan& plan, const EditContext& context,
                  GridBricks& bricks, UndoRecord& record, const Job& job) {
  alignas(64) float distances[kBrickSamples];
  std::int32_t materials[kBrickSamples];
  for (const PlannedBrick& planned : plan.bricks) {
    job.checkpoint();
    const GridBrick brick = bricks.find(planned.brick);
    if (brick.values == nullptr) continue;
    const std::int32_t* before = bricks.paint(planned.brick);
    if (before == nullptr && stroke.material == 0) continue;
    brush_distances(stroke, plan, planned, context, distances);
    bool changed = false;
    for (int i = 0; i < kBrickSamples; ++i) {
      const bool reached = distances[i] < 0 && (brick.active[i >> 6] >> (i & 63) & 1) != 0;
      const std::int32_t old = before != nullptr ? before[i] : 0;
      materials[i] = reached ? stroke.material : old;
      changed = changed || materials[i] != old;
    }
    if (!changed) continue;
    record.add_paint(planned.brick, before);
    bricks.set_paint(planned.brick, materials);
  }
}

}  // namespace sdfgrid
