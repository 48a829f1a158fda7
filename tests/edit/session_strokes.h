// tests/edit/session_strokes.h: the strokes that the sessions of the tests are made of.
#pragma once

#include <cmath>
#include <cstddef>
#include <cstdio>
#include <string>

namespace sdfgrid::test {

// The text of the stroke with that number: small balls around a ball of 12 voxels of 0.1.
inline std::string stroke_text(std::size_t number) {
  const double angle = 0.7 * static_cast<double>(number);
  char text[200];
  std::snprintf(text, sizeof text,
                "{op: %s, brush: {sphere: {radius: 0.3}}, path: [[%.4f, %.4f, %.4f]]}",
                number % 2 == 0 ? "union" : "difference", 1.2 * std::cos(angle),
                1.2 * std::sin(angle), 0.3 * std::sin(3 * angle));
  return text;
}

// What session_child does as record `number` of its session, so that whoever reads the journal
// knows what must be there: strokes, and among them undos of two and redos of one of these.
enum class ChildStep { stroke, undo_two, redo_one };

inline ChildStep child_step(std::size_t number) {
  if (number % 9 == 5) return ChildStep::undo_two;
  return number % 9 == 6 ? ChildStep::redo_one : ChildStep::stroke;
}

}  // namespace sdfgrid::test
