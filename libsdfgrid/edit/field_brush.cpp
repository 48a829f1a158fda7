#include "sdfgrid/edit/field_brush.h"

#include <cmath>

#include "sdfgrid/core/error.h"

namespace sdfgrid {

std::shared_ptr<const BrushShape> make_brush(const Field& field, bool exact) {
  auto shape = std::make_shared<BrushShape>();
  shape->bounds = field.bounds();
  if (shape->bounds.empty()) throw Error(ErrorKind::input, "the brush is empty");
  for (int a = 0; a < 3; ++a) {
    if (!std::isfinite(shape->bounds.lo[a]) || !std::isfinite(shape->bounds.hi[a])) {
      throw Error(ErrorKind::input,
                  "the brush has no end; intersect it with a box or a ball to bound it");
    }
  }
  shape->exact = exact;
  shape->shallow = !exact;
  shape->distances = [field](const float* x, const float* y, const float* z, float* distance,
                             std::size_t count) { field.evaluate(count, x, y, z, distance); };
  return shape;
}

}  // namespace sdfgrid
