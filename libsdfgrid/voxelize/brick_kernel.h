// voxelize/brick_kernel.h: the vector arithmetic of one 8^3 brick, between the ordinary code and
// brick_kernel.cpp, which is compiled once for each instruction set. Plain data only (not
// installed).
//
// All lengths are in voxels. Samples of a brick are ordered z fastest: (x * 8 + y) * 8 + z; a bit
// set over them is eight words, one for each x, with bit y * 8 + z.
#pragma once

#include <cstddef>
#include <cstdint>

#include "sdfgrid/core/kernel.h"

namespace sdfgrid {

// A triangle as seven affine functions of position: its height z over the plane, and for each edge
// i the position s_i along it and t_i across it (positive inside). A point's distance to the
// triangle is |z| where every t_i > 0, else that to the nearest edge. Edge 0 is the longest.
struct TriangleRecord {
  static constexpr int kFunctions = 8;  // z, s0, s1, s2, t0, t1, t2, and one unused
  // value of function f at p: gx[f] * p.x + gy[f] * p.y + gz[f] * p.z + k[f]
  double gx[kFunctions], gy[kFunctions], gz[kFunctions], k[kFunctions];
  double length[3];
};

// The same seen from the centre of a brick, in float: the constants are subtracted in double, so
// that whatever decides a distance nearby is small, and a triangle may be thousands of voxels
// large.
struct TriangleFrame {
  float gx[7], gy[7], gz[7];
  float k[7];  // at the brick's centre
  float w[3];  // s_i - length_i at the brick's centre
  float unused;
};

// Which triangles are tried for a few samples side by side.
enum class Culling : int {
  exact,   // all that can be nearest to one of them
  smooth,  // of those that face as the nearest does only what can be if they lie in a plane
};

struct BrickScratch {
  float* center_distance;  // 32 a triangle
  std::int32_t* lists;     // 32 a triangle
};

// What is known of a brick's samples before their signs are.
struct BrickDistances {
  // Squared distance, exact within reach, at least the reach's square beyond it. The 80 beyond 512
  // are padding.
  alignas(64) float squared[512 + 80];
  // 4 * frame + side for the nearest triangle, -1 if none is within reach. Side: 0 the nearest
  // feature is an edge or a vertex, 1 the face seen from in front, 2 the face seen from behind.
  alignas(64) std::int32_t nearest[512];
};

struct BrickLinks {
  std::uint64_t known[8];     // the nearest feature is a face, so the sign is known ...
  std::uint64_t negative[8];  // ... and it is this
  // Whether the sample and its successor along the axis are certainly on the same side: the balls
  // around them that hold no triangle overlap. No bits where the successor is outside the brick.
  std::uint64_t link_x[8], link_y[8], link_z[8];
};

struct BandWidths {
  float voxel;                      // world units
  float exwidth, inwidth;           // voxels
  float background, in_background;  // world units, both positive
};

struct BrickKernel {
  void (*make_frame)(const TriangleRecord& record, const double center[3], TriangleFrame& frame);
  // Squared distance from `center` to the triangle.
  double (*squared_distance)(const TriangleRecord& record, const double center[3]);
  // `frames` must hold every triangle within `reach` voxels (>= 1) of a sample of the brick.
  void (*distances)(const TriangleFrame* frames, std::int32_t count, float reach, Culling culling,
                    const BrickScratch& scratch, BrickDistances& out);
  void (*links)(const BrickDistances& distances, float reach, BrickLinks& out);
  // Signed values in world units, and which are within the band.
  void (*finish)(const BrickDistances& distances, const std::uint64_t negative[8],
                 const BandWidths& band, float values[512], std::uint64_t active[8]);
};

// The kernel for this machine.
const BrickKernel& brick_kernel();

SDFGRID_DECLARE_ISAS(extern const BrickKernel kBrickKernel)

}  // namespace sdfgrid
