#include "sdfgrid/edit/stroke.h"

namespace sdfgrid {

std::string_view stroke_op_word(StrokeOp op) {
  switch (op) {
    case StrokeOp::unite:
      return "union";
    case StrokeOp::subtract:
      return "difference";
    case StrokeOp::intersect:
      return "intersection";
    case StrokeOp::inflate:
      return "inflate";
    case StrokeOp::deflate:
      return "deflate";
    case StrokeOp::flatten:
      return "flatten";
    case StrokeOp::smooth:
      return "smooth";
    case StrokeOp::pinch:
      return "pinch";
    case StrokeOp::paint:
      break;
  }
  return "paint";
}

bool is_csg(StrokeOp op) {
  return op == StrokeOp::unite || op == StrokeOp::subtract || op == StrokeOp::intersect;
}

}  // namespace sdfgrid
