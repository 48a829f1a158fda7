// edit/paint_bricks.h: what a stroke of paint does to a grid. Internal to edit/.
#pragma once

#include "sdfgrid/core/job.h"
#include "sdfgrid/edit/brick_edit.h"
#include "sdfgrid/edit/undo.h"

namespace sdfgrid {

// Gives the stroke's material to the active samples within the brush: a coat as deep as the band.
// What each brick held before goes into `record`.
void paint_bricks(const Stroke& stroke, const StrokePlan& plan, const EditContext& context,
                  GridBricks& bricks, UndoRecord& record, const Job& job);

}  // namespace sdfgrid
