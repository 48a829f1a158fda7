// field/levels.h: a range of values of a node that matter (internal to field/).
#pragma once

namespace sdfgrid {

// From lo <= 0 inside to hi >= 0 outside, mostly; around 0 of a surface that nothing moves.
struct Levels {
  double lo = 0;
  double hi = 0;

  [[nodiscard]] Levels wider(double by) const { return {lo - by, hi + by}; }
  [[nodiscard]] Levels scaled(double by) const { return {lo * by, hi * by}; }
  [[nodiscard]] Levels negated() const { return {-hi, -lo}; }
};

}  // namespace sdfgrid
