// The winding number of one point, sixteen children or triangles at a time: far children by their
// multipole expansion, near triangles by their exact solid angle (van Oosterom and Strackee 1983).
#include "sdfgrid/mesh/winding_kernel.h"

#include "sdfgrid/core/simd.h"

namespace sdfgrid::SDFGRID_ISA {
namespace {

using winding::kWidth;
using winding::Leaf;
using winding::Node;
static_assert(kWidth == kLanes);

constexpr double kInverseTwoPi = 0.15915494309189533577;

// Beyond this many sizes of the soup the winding number is below 1e-10 even for 2^32 triangles,
// each as large as the soup, and float powers of the distance would overflow.
constexpr double kFarthest = 1e10;

// Levels of a tree over 2^32 triangles, times the children that wait at each.
constexpr int kStack = 8 * kWidth;

struct F16x3 {
  F16 x, y, z;
};

inline F16x3 offset(const float (&at)[3][kWidth], const float (&from)[3]) {
  return {load(at[0]) - from[0], load(at[1]) - from[1], load(at[2]) - from[2]};
}
inline F16 dot(const F16x3& a, const F16x3& b) { return a.x * b.x + a.y * b.y + a.z * b.z; }

inline float sum(F16 v) {
  float s = 0.0F;
  for (int i = 0; i < kLanes; ++i) s += v[i];
  return s;
}

// atan(y / x) for x > 0. The odd polynomial is minimax on [0, 1] (our own Remez run), error 2.5e-7.
inline F16 arctangent(F16 y, F16 x) {
  const F16 size = abs(y);
  const I16 steep = size > x;
  const F16 t = min(size, x) / max(size, x);
  const F16 s = t * t;
  F16 p = splat(0.006811795726F);
  p = p * s - 0.033604228F;
  p = p * s + 0.07962368102F;
  p = p * s - 0.1323334258F;
  p = p * s + 0.198078157F;
  p = p * s - 0.3331736807F;
  p = (p * s + 0.9999961116F) * t;
  p = select(steep, 1.57079632679F - p, p);
  return select(y < 0.0F, -p, p);
}

struct D3 {
  double x, y, z;
};
inline double dot(const D3& a, const D3& b) { return a.x * b.x + a.y * b.y + a.z * b.z; }

// Half the solid angle of one triangle, in double: for points so near that float would cancel.
double exact_half_angle(const Leaf& leaf, int lane, const double (&q)[3]) {
  D3 v[3];
  double length[3];
  for (int k = 0; k < 3; ++k) {
    v[k] = {leaf.corner[k][0][lane] - q[0], leaf.corner[k][1][lane] - q[1],
            leaf.corner[k][2][lane] - q[2]};
    length[k] = __builtin_sqrt(dot(v[k], v[k]));
  }
  const D3 e = {v[1].x - v[0].x, v[1].y - v[0].y, v[1].z - v[0].z};
  const D3 f = {v[2].x - v[0].x, v[2].y - v[0].y, v[2].z - v[0].z};
  const D3 n = {e.y * f.z - e.z * f.y, e.z * f.x - e.x * f.z, e.x * f.y - e.y * f.x};
  const double y = dot(n, v[0]);
  const double x = length[0] * length[1] * length[2] + dot(v[0], v[1]) * length[2] +
                   dot(v[1], v[2]) * length[0] + dot(v[2], v[0]) * length[1];
  return y == 0.0 ? 0.0 : __builtin_atan2(y, x);  // zero on the triangle's own plane
}

// Half the sum of the solid angles of a leaf's triangles, by lane.
inline F16 half_angles(const Leaf& leaf, const float (&q)[3], const double (&exact_q)[3]) {
  const F16x3 a = offset(leaf.corner[0], q);
  const F16x3 b = offset(leaf.corner[1], q);
  const F16x3 c = offset(leaf.corner[2], q);
  const F16 la = sqrt(dot(a, a));
  const F16 lb = sqrt(dot(b, b));
  const F16 lc = sqrt(dot(c, c));
  const F16x3 cross = {b.y * c.z - b.z * c.y, b.z * c.x - b.x * c.z, b.x * c.y - b.y * c.x};
  const F16 y = dot(a, cross);
  const F16 x = la * lb * lc + dot(a, b) * lc + dot(b, c) * la + dot(c, a) * lb;
  // From afar x is 4/27 of this cube. Where it is a small part, or negative, the angle is large or
  // its terms cancel, and rounding could even turn its sign.
  const F16 around = la + lb + lc;
  const I16 near = x * 1000.0F <= around * around * around;
  F16 angle = arctangent(y, x);
  if (const std::uint32_t lanes = bits(near); lanes != 0) [[unlikely]] {
    for (std::uint32_t rest = lanes; rest != 0; rest &= rest - 1) {
      const int lane = __builtin_ctz(rest);
      angle[lane] = static_cast<float>(exact_half_angle(leaf, lane, exact_q));
    }
  }
  return angle;
}

// The expansions of a node's children; lanes that must be opened hold rubbish.
inline F16 expansions(const Node& node, const F16x3& d, F16 r2) {
  const auto c = [&](int i) { return load(node.coefficient[i]); };
  const F16 i2 = 1.0F / r2;
  const F16 i3 = i2 * sqrt(i2);
  const F16 xx = d.x * d.x;
  const F16 yy = d.y * d.y;
  const F16 zz = d.z * d.z;
  const F16 one = c(0) * d.x + c(1) * d.y + c(2) * d.z;
  const F16 two =
      c(3) * (xx - zz) + c(4) * (yy - zz) + d.x * (c(5) * d.y + c(6) * d.z) + c(7) * d.y * d.z;
  const F16 three = d.x * (c(8) * (3.0F * yy - xx) + c(9) * (3.0F * zz - xx)) +
                    d.y * (c(10) * (3.0F * xx - yy) + c(11) * (3.0F * zz - yy)) +
                    d.z * (c(12) * (3.0F * xx - zz) + c(13) * (3.0F * yy - zz)) +
                    c(14) * d.x * d.y * d.z;
  return i3 * (one + i2 * (two + i2 * three));
}

double winding_at(const winding::TreeView& tree, const double* position) {
  double exact_q[3];
  float q[3];
  for (int a = 0; a < 3; ++a) {
    exact_q[a] = position[a] * tree.scale;
    if (!(__builtin_fabs(exact_q[a]) < kFarthest)) return 0.0;
    q[a] = static_cast<float>(exact_q[a]);
  }
  F16 far_sum{};
  F16 near_sum{};
  std::uint32_t stack[kStack];
  int waiting = 0;
  stack[waiting++] = 0;
  while (waiting > 0) {
    const Node& node = tree.nodes[stack[--waiting]];
    const F16x3 d = offset(node.center, q);
    const F16 r2 = dot(d, d);
    const I16 near = r2 < load(node.reach2);
    far_sum += select(near, F16{}, expansions(node, d, r2));
    for (std::uint32_t rest = bits(near); rest != 0; rest &= rest - 1) {
      const std::uint32_t child = node.first + static_cast<std::uint32_t>(__builtin_ctz(rest));
      if (node.leaves != 0) {
        near_sum += half_angles(tree.leaves[child], q, exact_q);
      } else {
        stack[waiting++] = child;
      }
    }
  }
  return static_cast<double>(sum(far_sum)) + kInverseTwoPi * static_cast<double>(sum(near_sum));
}

}  // namespace

void evaluate_winding(const winding::TreeView& tree, const double* positions, std::size_t count,
                      double* out) {
  for (std::size_t i = 0; i < count; ++i) out[i] = winding_at(tree, positions + 3 * i);
}

}  // namespace sdfgrid::SDFGRID_ISA
