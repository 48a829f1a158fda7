// transform/parabola_kernel.h: the vector arithmetic of an exact distance transform, between the
// ordinary code and parabola_kernel.cpp, which is compiled once for each instruction set. Plain
// data only (not installed).
//
// Squared distances of both sides share one number: positive outside, negative inside, as either is
// zero on the other's side. A sample without a site is far.
#pragma once

#include <cstddef>
#include <cstdint>

#include "sdfgrid/core/kernel.h"

namespace sdfgrid {

// Columns of one call: groups of sixteen, which are worked on in lockstep.
inline constexpr int kColumnGroups = 4;
inline constexpr int kColumns = 16 * kColumnGroups;

enum class Sides : int { outside = 1, inside = 2, both = 3 };

// How the squares of the last pass become distances.
template <class Number>
struct ParabolaFinish {
  bool wanted;
  float scale;        // world units of one unit whose square was counted
  float shift;        // taken off both sides, world units
  Number limit;       // squares at or beyond this ...
  float cut;          // ... become this, world units
  float inside_sign;  // -1, or 1 where the inside alone is wanted
};

// One pass along columns whose rows are `stride` numbers apart.
template <class Number>  // float or std::int32_t
struct ParabolaPass {
  int rows;
  std::ptrdiff_t stride;
  Sides sides;
  const Number* square;  // square[d] for |d| <= rows + 2: what d rows add to a square
  Number far;            // squares at or beyond this are far, and become this; far + square fits
  bool windowed;         // far is so near that to look at every row within `reach` is fastest
  int reach;             // rows beyond which every square is far; `rows` if not windowed
  ParabolaFinish<Number> finish;
};

struct ParabolaScratch {
  void* numbers;        // (kColumns + 48) * rows of them, aligned to 64 bytes
  std::int32_t* range;  // 2 * rows
};

template <class Number>
struct ParabolaKernel {
  // Squares along one row of samples to the nearest sample on the other side. `inside` has `count`
  // bytes, not zero inside; `out` has room for 16 numbers more.
  void (*row)(const ParabolaPass<Number>& pass, const std::uint8_t* inside, Number* out);
  // Replaces each number v of `lanes` (at most kColumns) neighbouring columns by the least of
  // v' + square[rows between them] over the column, for each side. `columns` holds Number, and
  // float after a pass with a finish.
  void (*columns)(const ParabolaPass<Number>& pass, int lanes, void* columns,
                  const ParabolaScratch& scratch);
};

// The kernels for this machine.
template <class Number>
const ParabolaKernel<Number>& parabola_kernel();

SDFGRID_DECLARE_ISAS(extern const ParabolaKernel<float> kParabolaOfFloats;
                     extern const ParabolaKernel<std::int32_t> kParabolaOfInts)

}  // namespace sdfgrid
