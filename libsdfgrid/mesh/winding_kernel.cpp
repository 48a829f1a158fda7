// The winding number of one point, sixteen children or triangles at a time: far children by their
// multipole expansion, near triangles by their exact solid angle (van Oosterom and Strackee 1983).
#include "sdfgrid/mesh/winding_kernel.h"

#include "sdfgrid/core/simd.h"

namespace sdfgrid::SDFGRID_ISA {
namespace {

using winding::kFarthest;
using winding::kWidth;
using winding::Leaf;
using winding::Node;
static_assert(kWidth == kLanes);

constexpr double kInverseTwoPi = 0.15915494309189533577;

// Levels of a tree over 2^32 triangles, times the children that wait at each.
constexpr int kStack = 8 * kWidth;

struct F16x3 {
  F16 x, y, z;
};

inline F16x3 offset(const float (&at)[3][kWidth], const float (&from)[3]) {
  return {load(at[0]) - from[0], load(at[1]) - from[1], load(at[2]) - from[2]};
}
inline F16 dot(const F16x3& a, const F16x3& b) { return a.x * b.x + a.y * b.y + a.z * b.z; }

// 1 / sqrt(a) and 1 / a for a > 0, to a few units in the last place: on AVX-512 an estimate of 14
// bits and one Newton step, several times as fast as the exact instructions.
inline F16 inverse_sqrt(F16 a) {
#if defined(__AVX512F__)
  const F16 e = (F16)_mm512_rsqrt14_ps((__m512)a);
  return e * (1.5F - 0.5F * a * e * e);
#else
  return 1.0F / sqrt(a);
#endif
}
inline F16 inverse(F16 a) {
#if defined(__AVX512F__)
  const F16 e = (F16)_mm512_rcp14_ps((__m512)a);
  return e * (2.0F - a * e);
#else
  return 1.0F / a;
#endif
}

// Keeps the powers of a distance below within float's range.
constexpr float kLeastSquare = 1e-24F;

inline F16 length(const F16x3& a) {
  const F16 square = dot(a, a);
  return square * inverse_sqrt(max(square, splat(kLeastSquare)));
}

inline float sum(F16 v) {
  float s = 0.0F;
  for (int i = 0; i < kLanes; ++i) s += v[i];
  return s;
}

// atan(y / x) for x > 0. The odd polynomial is minimax on [0, 1] (our own Remez run), error 2.5e-7.
inline F16 arctangent(F16 y, F16 x) {
  const F16 size = abs(y);
  const I16 steep = size > x;
  const F16 t = min(size, x) * inverse(max(size, x));
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
  const F16 la = length(a);
  const F16 lb = length(b);
  const F16 lc = length(c);
  const F16x3 cross = {b.y * c.z - b.z * c.y, b.z * c.x - b.x * c.z, b.x * c.y - b.y * c.x};
  const F16 y = dot(a, cross);
  const F16 x = la * lb * lc + dot(a, b) * lc + dot(b, c) * la + dot(c, a) * lb;
  // From afar x is 4/27 of this cube. Where it is a small part, or negative, the angle is large or
  // its terms cancel, and rounding could even turn its sign. Nor may x leave float's range.
  const F16 around = la + lb + lc;
  const F16 least = max(around * around * around * 1e-3F, splat(1e-30F));
  const I16 near = x <= least;
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
  const F16 i1 = inverse_sqrt(max(r2, splat(kLeastSquare)));
  const F16 i2 = i1 * i1;
  const F16 i3 = i2 * i1;
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

struct Query {
  double exact[3];
  float q[3];
  F16 far_sum;
  F16 near_sum;
};

// Neighbouring queries walk the tree together, so that nodes and leaves are fetched once for all of
// them. Each still takes its own decisions and adds in the order in which it would alone.
constexpr int kPacket = 8;

constexpr std::uint32_t kAllChildren = (1U << kWidth) - 1;

struct Visit {
  std::uint32_t node;
  std::uint32_t queries;                  // one bit each
  std::uint32_t children = kAllChildren;  // that are still to be added, one bit each
};

// The lanes of a node's children that are none of these.
I16 lanes_but(std::uint32_t children) {
  I16 lanes{};
  for (int lane = 0; lane < kWidth; ++lane)
    lanes[lane] = static_cast<int>(children >> lane & 1) - 1;
  return lanes;
}

// Adds the children that are far from each of the queries; in `wanted` the queries that need each
// child opened. Returns the children that any query does.
std::uint32_t add_far_children(const Node& node, const Visit& visit, Query* packet,
                               std::uint32_t (&wanted)[kWidth]) {
  std::uint32_t opened = 0;
  const I16 added = lanes_but(visit.children);
  for (std::uint32_t rest = visit.queries; rest != 0; rest &= rest - 1) {
    Query& query = packet[__builtin_ctz(rest)];
    const F16x3 d = offset(node.center, query.q);
    const F16 r2 = dot(d, d);
    const I16 near = r2 < load(node.reach2);
    query.far_sum += select(near | added, F16{}, expansions(node, d, r2));
    const std::uint32_t lanes = bits(near) & visit.children;
    for (std::uint32_t l = lanes & ~opened; l != 0; l &= l - 1) wanted[__builtin_ctz(l)] = 0;
    for (std::uint32_t l = lanes; l != 0; l &= l - 1) wanted[__builtin_ctz(l)] |= rest & -rest;
    opened |= lanes;
  }
  return opened;
}

void add_leaf(const Leaf& leaf, std::uint32_t queries, Query* packet) {
  for (std::uint32_t rest = queries; rest != 0; rest &= rest - 1) {
    Query& query = packet[__builtin_ctz(rest)];
    query.near_sum += half_angles(leaf, query.q, query.exact);
  }
}

// Adds the part of the tree that starts at `from`.
void walk(const winding::TreeView& tree, const Visit& from, Query* packet) {
  Visit stack[kStack];
  int waiting = 0;
  stack[waiting++] = from;
  while (waiting > 0) {
    const Visit visit = stack[--waiting];
    const Node& node = tree.nodes[visit.node];
    std::uint32_t wanted[kWidth];
    std::uint32_t rest = add_far_children(node, visit, packet, wanted);
    for (; rest != 0; rest &= rest - 1) {
      const auto lane = static_cast<std::uint32_t>(__builtin_ctz(rest));
      const std::uint32_t child = node.first + lane;
      if (node.leaves != 0) {
        add_leaf(tree.leaves[child], wanted[lane], packet);
      } else {
        stack[waiting++] = {child, wanted[lane]};
      }
    }
  }
}

// Sets up a query; false if its position is not finite or so far away that the answer is zero.
bool start(Query& query, const double* position, double scale) {
  bool within = true;
  for (int a = 0; a < 3; ++a) {
    query.exact[a] = position[a] * scale;
    query.q[a] = static_cast<float>(query.exact[a]);
    within = within && __builtin_fabs(query.exact[a]) < kFarthest;
  }
  query.far_sum = F16{};
  query.near_sum = F16{};
  return within;
}

double total(const Query& query) {
  return static_cast<double>(sum(query.far_sum)) +
         kInverseTwoPi * static_cast<double>(sum(query.near_sum));
}

// The far part of the tree is smooth over a cube: it is evaluated at kNodes^3 points and
// interpolated. Chebyshev's points of an interval of half length 3.5 about 3.5.
constexpr int kNodes = 4;
constexpr double kNodeAt[kNodes] = {
    3.5 - 3.5 * 0.92387953251128674, 3.5 - 3.5 * 0.38268343236508977,
    3.5 + 3.5 * 0.38268343236508977, 3.5 + 3.5 * 0.92387953251128674};

// Triangles are far if they keep this many radii of the cube's ball away from it, and so is the
// centre of an expansion: the interpolation is then off by a few thousandths of what they add.
constexpr float kGap = 0.5F;

constexpr int kMostParts = 256;  // of the tree that are left to the single points
constexpr std::uint32_t kWholePacket = (1U << kPacket) - 1;

class Cube {
 public:
  Cube(const double (&corner)[3], double step, double scale) {
    const double middle[3] = {corner[0] + 3.5 * step, corner[1] + 3.5 * step,
                              corner[2] + 3.5 * step};
    start(center_, middle, scale);
    radius_ = static_cast<float>(3.5 * 1.7320508075688773 * step * scale);
    for (int n = 0; n < kNodes * kNodes * kNodes; ++n) {
      const double p[3] = {corner[0] + step * kNodeAt[n / (kNodes * kNodes)],
                           corner[1] + step * kNodeAt[n / kNodes % kNodes],
                           corner[2] + step * kNodeAt[n % kNodes]};
      start(nodes_[n], p, scale);
    }
  }

  // Adds what is far from the cube; writes the rest to `rest` and returns how many parts that is.
  int add_far_parts(const winding::TreeView& tree, Visit (&rest)[kMostParts]) {
    std::uint32_t stack[kStack];
    int waiting = 0;
    int parts = 0;
    stack[waiting++] = 0;
    while (waiting > 0) {
      const std::uint32_t index = stack[--waiting];
      const Node& node = tree.nodes[index];
      std::uint32_t opened = add_expansions(node);
      if (node.leaves != 0) {
        opened = add_far_leaves(tree, node, opened);
        if (opened != 0) rest[parts++] = {index, kWholePacket, opened};
      } else if (parts + waiting + __builtin_popcount(opened) > kMostParts) {
        // A place is kept for all that waits, as each may leave a part.
        rest[parts++] = {index, kWholePacket, opened};
      } else {
        for (std::uint32_t l = opened; l != 0; l &= l - 1) {
          stack[waiting++] = node.first + static_cast<std::uint32_t>(__builtin_ctz(l));
        }
      }
    }
    return parts;
  }

  void interpolate(double* out) const {
    double weight[8][kNodes];
    for (int i = 0; i < 8; ++i) {
      for (int n = 0; n < kNodes; ++n) {
        weight[i][n] = 1.0;
        for (int m = 0; m < kNodes; ++m) {
          if (m != n) weight[i][n] *= (i - kNodeAt[m]) / (kNodeAt[n] - kNodeAt[m]);
        }
      }
    }
    double value[kNodes * kNodes * kNodes];
    for (int n = 0; n < kNodes * kNodes * kNodes; ++n) {
      value[n] = total(nodes_[n]);
    }
    // Along one axis after the other: [l][m][n] to [l][m][z] to [l][y][z] to [x][y][z].
    double along_z[kNodes * kNodes][8];
    for (int lm = 0; lm < kNodes * kNodes; ++lm) {
      for (int z = 0; z < 8; ++z) {
        along_z[lm][z] = 0.0;
        for (int n = 0; n < kNodes; ++n) along_z[lm][z] += weight[z][n] * value[lm * kNodes + n];
      }
    }
    double along_y[kNodes][64];
    for (int l = 0; l < kNodes; ++l) {
      for (int yz = 0; yz < 64; ++yz) {
        along_y[l][yz] = 0.0;
        for (int m = 0; m < kNodes; ++m) {
          along_y[l][yz] += weight[yz >> 3][m] * along_z[l * kNodes + m][yz & 7];
        }
      }
    }
    for (int xyz = 0; xyz < winding::kCubePoints; ++xyz) {
      out[xyz] = 0.0;
      for (int l = 0; l < kNodes; ++l) out[xyz] += weight[xyz >> 6][l] * along_y[l][xyz & 63];
    }
  }

 private:
  // Returns the children that must be opened, one bit each.
  std::uint32_t add_expansions(const Node& node) {
    const F16x3 away = offset(node.center, center_.q);
    const F16 least = max(sqrt(load(node.reach2)), splat(kGap * radius_)) + radius_;
    const I16 near = dot(away, away) < least * least;
    const std::uint32_t lanes = bits(near);
    if (lanes == kAllChildren) return lanes;
    for (Query& query : nodes_) {
      const F16x3 d = offset(node.center, query.q);
      query.far_sum += select(near, F16{}, expansions(node, d, dot(d, d)));
    }
    return lanes;
  }

  // Of these leaves adds those that are far though their expansion does not do; returns the others.
  std::uint32_t add_far_leaves(const winding::TreeView& tree, const Node& node,
                               std::uint32_t leaves) {
    const F16x3 away = offset(node.center, center_.q);
    const F16 least = load(node.radius) + (1.0F + kGap) * radius_;
    const std::uint32_t near = bits(dot(away, away) < least * least) & leaves;
    for (std::uint32_t l = leaves & ~near; l != 0; l &= l - 1) {
      const Leaf& leaf = tree.leaves[node.first + static_cast<std::uint32_t>(__builtin_ctz(l))];
      for (Query& query : nodes_) query.near_sum += half_angles(leaf, query.q, query.exact);
    }
    return near;
  }

  Query center_;
  float radius_;
  Query nodes_[kNodes * kNodes * kNodes];
};

}  // namespace

void evaluate_winding(const winding::TreeView& tree, const double* positions, std::size_t count,
                      double* out) {
  Query packet[kPacket];
  for (std::size_t first = 0; first < count; first += kPacket) {
    const int size = count - first < kPacket ? static_cast<int>(count - first) : kPacket;
    std::uint32_t queries = 0;
    for (int i = 0; i < size; ++i) {
      const bool within = start(packet[i], positions + 3 * (first + i), tree.scale);
      queries |= static_cast<std::uint32_t>(within) << i;
    }
    if (queries != 0) walk(tree, {0, queries}, packet);
    for (int i = 0; i < size; ++i) {
      out[first + i] = total(packet[i]);
    }
  }
}

void evaluate_winding_cube(const winding::TreeView& tree, const double (&corner)[3], double step,
                           double* out) {
  Cube cube(corner, step, tree.scale);
  Visit rest[kMostParts];
  const int parts = cube.add_far_parts(tree, rest);
  cube.interpolate(out);
  for (int first = 0; parts > 0 && first < winding::kCubePoints; first += kPacket) {
    Query packet[kPacket];
    for (int i = 0; i < kPacket; ++i) {
      const int at = first + i;
      const double p[3] = {corner[0] + step * (at >> 6), corner[1] + step * (at >> 3 & 7),
                           corner[2] + step * (at & 7)};
      start(packet[i], p, tree.scale);
    }
    for (int part = 0; part < parts; ++part) walk(tree, rest[part], packet);
    for (int i = 0; i < kPacket; ++i) out[first + i] += total(packet[i]);
  }
}

}  // namespace sdfgrid::SDFGRID_ISA
