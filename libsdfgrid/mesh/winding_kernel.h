// mesh/winding_kernel.h: the winding number's tree as its vector kernel reads it (not installed).
// Sixteen children of a node, or sixteen triangles of a leaf, lie side by side in each array, so
// that one query meets sixteen of them at a time and its result depends on nothing but itself.
#pragma once

#include <cstddef>
#include <cstdint>

#include "sdfgrid/core/kernel.h"

namespace sdfgrid::winding {

inline constexpr int kWidth = 16;

// Numbers of the multipole expansion of one child about its centre: 3 of degree one, 5 of degree
// two, 7 of degree three (see winding_moments.h for which).
inline constexpr int kCoefficients = 15;

struct alignas(64) Node {
  float center[3][kWidth];
  float reach2[kWidth];  // squared distance from the centre below which the child is opened
  float radius[kWidth];  // no triangle of the child is farther from the centre
  float coefficient[kCoefficients][kWidth];
  std::uint32_t first;   // index of the first child, among nodes or leaves
  std::uint32_t leaves;  // 1 if the children are leaves
};

// Unused places repeat one corner of the leaf three times: a triangle without area.
struct alignas(64) Leaf {
  float corner[3][3][kWidth];  // [which corner][axis]
};

// Node 0 is the root. Coordinates are the soup's, times `scale`.
struct TreeView {
  const Node* nodes;
  const Leaf* leaves;
  double scale;
};

// Winding numbers at `count` positions, three doubles each, in the soup's local coordinates.
using Evaluate = void (*)(const TreeView& tree, const double* positions, std::size_t count,
                          double* out);

// Beyond this many sizes of the soup the winding number is below 1e-10 even for 2^32 triangles,
// each as large as the soup, and float powers of the distance would overflow.
inline constexpr double kFarthest = 1e10;

// The same at the 8^3 points corner + step * (x, y, z), z fastest: once scaled all of them must be
// within kFarthest.
inline constexpr int kCubePoints = 512;
using EvaluateCube = void (*)(const TreeView& tree, const double (&corner)[3], double step,
                              double* out);

}  // namespace sdfgrid::winding

namespace sdfgrid {
SDFGRID_DECLARE_ISAS(void evaluate_winding(const winding::TreeView& tree, const double* positions,
                                           std::size_t count, double* out))
SDFGRID_DECLARE_ISAS(void evaluate_winding_cube(const winding::TreeView& tree,
                                                const double (&corner)[3], double step,
                                                double* out))
}  // namespace sdfgrid
