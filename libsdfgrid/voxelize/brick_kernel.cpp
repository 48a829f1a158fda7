// The arithmetic of brick_kernel.h, sixteen samples at a time. Compiled once for each instruction
// set: include nothing here that emits functions shared with other files.
//
// A brick is cut into 32 groups of 2 x 2 x 4 samples, the lanes of one vector. For each group only
// those triangles are evaluated that can be nearest to one of its samples: with m the distance from
// the group's centre to the nearest triangle and R the group's radius, a triangle further than m +
// 2R from the centre cannot. The same distance function serves for both, on the 32 centres first.
// Where surfaces are smooth that is far too much: over a plane, the foot of a sample is within R of
// the centre's foot, and the triangle it is in within sqrt(m^2 + R^2).
#include "sdfgrid/voxelize/brick_kernel.h"

#include "sdfgrid/core/simd.h"

namespace sdfgrid::SDFGRID_ISA {
namespace {

constexpr float kHuge = 1e30F;
constexpr float kGroupRadius = 1.6583124F;  // sqrt(0.5^2 + 0.5^2 + 1.5^2)
constexpr int kGroups = 32;
// For Culling::smooth: how far along the surface from the centre's foot triangles are tried, and
// the least cosine between the normals, each towards the centre, of one smooth surface. On the
// hollow side of a curved surface feet spread by 1 / (1 - m / radius): right up to a third of the
// radius of curvature; beyond, a foot's distance is stationary, so that the error is small.
constexpr float kPatch = 1.5F * kGroupRadius;
constexpr float kSameFacing = 0.8F;

struct Point16 {
  F16 x, y, z;
};

// Lane l of a group is its sample (l >> 3, (l >> 2) & 1, l & 3).
alignas(64) constexpr float kLaneX[kLanes] = {0, 0, 0, 0, 0, 0, 0, 0, 1, 1, 1, 1, 1, 1, 1, 1};
alignas(64) constexpr float kLaneY[kLanes] = {0, 0, 0, 0, 1, 1, 1, 1, 0, 0, 0, 0, 1, 1, 1, 1};
alignas(64) constexpr float kLaneZ[kLanes] = {0, 1, 2, 3, 0, 1, 2, 3, 0, 1, 2, 3, 0, 1, 2, 3};

// Group g is at samples (2 (g >> 3), 2 ((g >> 1) & 3), 4 (g & 1)).
constexpr int group_x(int g) { return 2 * (g >> 3); }
constexpr int group_y(int g) { return 2 * ((g >> 1) & 3); }
constexpr int group_z(int g) { return 4 * (g & 1); }

Point16 group_samples(int g) {
  return {load(kLaneX) + (static_cast<float>(group_x(g)) - 3.5F),
          load(kLaneY) + (static_cast<float>(group_y(g)) - 3.5F),
          load(kLaneZ) + (static_cast<float>(group_z(g)) - 3.5F)};
}

// The centres of the groups 16 * half to 16 * half + 15.
Point16 group_centers(int half) {
  Point16 p;
  for (int l = 0; l < kLanes; ++l) {
    const int g = 16 * half + l;
    p.x[l] = static_cast<float>(group_x(g)) - 3.0F;
    p.y[l] = static_cast<float>(group_y(g)) - 3.0F;
    p.z[l] = static_cast<float>(group_z(g)) - 2.0F;
  }
  return p;
}

struct Distance16 {
  F16 squared;
  F16 height;  // over the triangle's plane
  I16 face;    // whether the nearest feature is the face
};

inline F16 linear(const TriangleFrame& f, int i, const Point16& p) {
  return fma(splat(f.gz[i]), p.z, fma(splat(f.gy[i]), p.y, f.gx[i] * p.x));
}

inline Distance16 distance(const TriangleFrame& f, const Point16& p) {
  const F16 zero = splat(0.0F);
  const F16 height = linear(f, 0, p) + f.k[0];
  F16 edge[3];
  F16 beyond[3];  // how far the foot on the edge's line is outside the edge, with sign
  F16 across[3];
  for (int i = 0; i < 3; ++i) {
    const F16 along = linear(f, 1 + i, p);
    beyond[i] = min(along + f.k[1 + i], zero) + max(along + f.w[i], zero);
    across[i] = linear(f, 4 + i, p) + f.k[4 + i];
    edge[i] = fma(beyond[i], beyond[i], across[i] * across[i]);
  }
  // The foot on the longest edge lies on that edge for every point over the face. Asking for it
  // keeps rounding in `across` from calling a point far beyond the tip of a needle "inside".
  const I16 face =
      (across[0] > zero) & (across[1] > zero) & (across[2] > zero) & (beyond[0] == zero);
  const F16 nearest_edge = min(edge[0], min(edge[1], edge[2]));
  return {fma(height, height, select(face, zero, nearest_edge)), height, face};
}

// Of the centres of sixteen groups.
struct NearestTriangle {
  F16 squared = splat(kHuge);
  F16 x = splat(0.0F), y = splat(0.0F), z = splat(0.0F);  // normal, towards the centre
};

// Squared distances from the centres up to which triangles are candidates.
struct CandidateLimit {
  F16 any;
  F16 same_facing;
};

inline CandidateLimit candidate_limit(const NearestTriangle& nearest, float reach,
                                      Culling culling) {
  const F16 m = sqrt(nearest.squared);
  // A little more than the geometry asks for, so that rounding cannot drop the nearest triangle.
  const F16 furthest = min(m + (2 * kGroupRadius + 1e-3F), splat(reach + kGroupRadius + 1e-3F));
  const I16 out_of_reach = m > splat(reach + kGroupRadius + 1e-3F);
  const F16 any = select(out_of_reach, splat(-1.0F), furthest * furthest);
  if (culling == Culling::exact) return {any, any};
  return {any, min(any, nearest.squared + kPatch * kPatch)};
}

// Which groups have a triangle as a candidate, of sixteen. The sign of its squared distance says on
// which side of it the centre is.
inline std::uint32_t wanted_by(const TriangleFrame& f, const NearestTriangle& nearest,
                               F16 signed_square, const CandidateLimit& limit, Culling culling) {
  const F16 squared = abs(signed_square);
  if (culling == Culling::exact) return bits(squared <= limit.any);
  const F16 up =
      fma(nearest.x, splat(f.gx[0]), fma(nearest.y, splat(f.gy[0]), nearest.z * splat(f.gz[0])));
  const F16 cosine = select(signed_square < splat(0.0F), -up, up);
  return bits(squared <= select(cosine > splat(kSameFacing), limit.same_facing, limit.any));
}

// Fills the list of each group with the triangles that can be nearest to one of its samples.
void choose_candidates(const TriangleFrame* frames, std::int32_t count, float reach,
                       Culling culling, const BrickScratch& scratch, std::int32_t sizes[kGroups]) {
  NearestTriangle nearest[2];
  const Point16 centers[2] = {group_centers(0), group_centers(1)};
  for (std::int32_t i = 0; i < count; ++i) {
    const TriangleFrame& f = frames[i];
    for (int half = 0; half < 2; ++half) {
      const Distance16 d = distance(f, centers[half]);
      const I16 behind = d.height < splat(0.0F);
      store(scratch.center_distance + 32 * i + 16 * half, select(behind, -d.squared, d.squared));
      NearestTriangle& n = nearest[half];
      const I16 nearer = d.squared < n.squared;
      n.squared = min(n.squared, d.squared);
      if (culling == Culling::exact) continue;
      // A foot far from the normal is on a sharp edge or a border: no smooth surface to rely on.
      const I16 oblique = d.height * d.height < d.squared * (kSameFacing * kSameFacing);
      const F16 side = select(oblique, splat(0.0F), select(behind, splat(-1.0F), splat(1.0F)));
      n.x = select(nearer, side * f.gx[0], n.x);
      n.y = select(nearer, side * f.gy[0], n.y);
      n.z = select(nearer, side * f.gz[0], n.z);
    }
  }
  const CandidateLimit limit[2] = {candidate_limit(nearest[0], reach, culling),
                                   candidate_limit(nearest[1], reach, culling)};
  for (int g = 0; g < kGroups; ++g) sizes[g] = 0;
  for (std::int32_t i = 0; i < count; ++i) {
    const float* squared = scratch.center_distance + 32 * i;
    std::uint32_t wanted = wanted_by(frames[i], nearest[0], load(squared), limit[0], culling) |
                           wanted_by(frames[i], nearest[1], load(squared + 16), limit[1], culling)
                               << 16;
    while (wanted != 0) {
      const int g = __builtin_ctz(wanted);
      wanted &= wanted - 1;
      scratch.lists[g * count + sizes[g]++] = i;
    }
  }
}

void store_group(int g, F16 squared, I16 nearest, BrickDistances& out) {
  const int base = (group_x(g) * 8 + group_y(g)) * 8 + group_z(g);
  const int offset[4] = {base, base + 8, base + 64, base + 72};
  for (int part = 0; part < 4; ++part) {
    __builtin_memcpy(out.squared + offset[part], (const char*)&squared + 16 * part, 16);
    __builtin_memcpy(out.nearest + offset[part], (const char*)&nearest + 16 * part, 16);
  }
}

void distances(const TriangleFrame* frames, std::int32_t count, float reach, Culling culling,
               const BrickScratch& scratch, BrickDistances& out) {
  std::int32_t sizes[kGroups];
  choose_candidates(frames, count, reach, culling, scratch, sizes);
  const F16 zero = splat(0.0F);
  for (int g = 0; g < kGroups; ++g) {
    const Point16 p = group_samples(g);
    F16 best = splat(kHuge);
    I16 nearest = splat(-1);
    const std::int32_t* list = scratch.lists + static_cast<std::ptrdiff_t>(g) * count;
    for (std::int32_t j = 0; j < sizes[g]; ++j) {
      const Distance16 d = distance(frames[list[j]], p);
      const I16 side = select(d.face, select(d.height < zero, splat(2), splat(1)), splat(0));
      const I16 closer = d.squared < best;
      best = min(d.squared, best);
      nearest = select(closer, side + 4 * list[j], nearest);
    }
    // Beyond reach a triangle that is not in the brick's list may be nearer.
    store_group(g, best, select(best > splat(reach * reach), splat(-1), nearest), out);
  }
  for (int i = 512; i < 512 + 80; i += kLanes) store(out.squared + i, splat(kHuge));
}

void links(const BrickDistances& distances, float reach, BrickLinks& out) {
  alignas(64) float d[512 + 80];
  for (int i = 0; i < 512 + 80; i += kLanes) {
    store(d + i, min(sqrt(load(distances.squared + i)), splat(reach)));
  }
  for (int x = 0; x < 8; ++x) {
    std::uint64_t known = 0;
    std::uint64_t negative = 0;
    std::uint64_t lx = 0;
    std::uint64_t ly = 0;
    std::uint64_t lz = 0;
    for (int part = 0; part < 4; ++part) {
      const int at = 64 * x + 16 * part;
      const int shift = 16 * part;
      const I16 nearest = load(distances.nearest + at);
      const I16 side = select(nearest < splat(0), splat(0), nearest & splat(3));
      known |= static_cast<std::uint64_t>(bits(side != splat(0))) << shift;
      negative |= static_cast<std::uint64_t>(bits(side == splat(2))) << shift;
      const F16 here = load(d + at);
      const F16 apart = splat(1.0001F);
      lx |= static_cast<std::uint64_t>(bits(here + load(d + at + 64) > apart)) << shift;
      ly |= static_cast<std::uint64_t>(bits(here + load(d + at + 8) > apart)) << shift;
      lz |= static_cast<std::uint64_t>(bits(here + load(d + at + 1) > apart)) << shift;
    }
    out.known[x] = known;
    out.negative[x] = negative;
    out.link_x[x] = x == 7 ? 0 : lx;
    out.link_y[x] = ly & 0x00ffffffffffffffULL;
    out.link_z[x] = lz & 0x7f7f7f7f7f7f7f7fULL;
  }
}

void finish(const BrickDistances& distances, const std::uint64_t negative[8],
            const BandWidths& band, float values[512], std::uint64_t active[8]) {
  alignas(64) static constexpr std::int32_t kBit[kLanes] = {
      1,      2,      4,      8,      0x10,   0x20,   0x40,   0x80,
      0x0100, 0x0200, 0x0400, 0x0800, 0x1000, 0x2000, 0x4000, 0x8000};
  for (int x = 0; x < 8; ++x) {
    std::uint64_t on = 0;
    for (int part = 0; part < 4; ++part) {
      const int at = 64 * x + 16 * part;
      const auto word = static_cast<std::int32_t>(negative[x] >> (16 * part) & 0xffffU);
      const I16 inside = (load(kBit) & splat(word)) != splat(0);
      const F16 d = sqrt(load(distances.squared + at));
      const I16 in_band = d < select(inside, splat(band.inwidth), splat(band.exwidth));
      const F16 beyond = select(inside, splat(-band.in_background), splat(band.background));
      const F16 world = d * band.voxel;
      store(values + at, select(in_band, select(inside, -world, world), beyond));
      on |= static_cast<std::uint64_t>(bits(in_band)) << (16 * part);
    }
    active[x] = on;
  }
}

void functions_at(const TriangleRecord& r, const double c[3], double value[8]) {
  for (int f = 0; f < TriangleRecord::kFunctions; ++f) {
    value[f] = fma(r.gx[f], c[0], fma(r.gy[f], c[1], fma(r.gz[f], c[2], r.k[f])));
  }
}

void make_frame(const TriangleRecord& r, const double center[3], TriangleFrame& frame) {
  double value[8];
  functions_at(r, center, value);
  for (int f = 0; f < 7; ++f) {
    frame.gx[f] = static_cast<float>(r.gx[f]);
    frame.gy[f] = static_cast<float>(r.gy[f]);
    frame.gz[f] = static_cast<float>(r.gz[f]);
    frame.k[f] = static_cast<float>(value[f]);
  }
  for (int i = 0; i < 3; ++i) frame.w[i] = static_cast<float>(value[1 + i] - r.length[i]);
  frame.unused = 0;
}

double squared_distance(const TriangleRecord& r, const double center[3]) {
  double value[8];
  functions_at(r, center, value);
  double edge = 1e300;
  bool face = true;
  for (int i = 0; i < 3; ++i) {
    const double s = value[1 + i];
    const double t = value[4 + i];
    const double beyond = (s < 0 ? s : 0.0) + (s > r.length[i] ? s - r.length[i] : 0.0);
    const double d = fma(beyond, beyond, t * t);
    edge = d < edge ? d : edge;
    face = face && t > 0 && (i > 0 || beyond == 0);
  }
  return fma(value[0], value[0], face ? 0.0 : edge);
}

}  // namespace

extern const BrickKernel kBrickKernel;
const BrickKernel kBrickKernel = {make_frame, squared_distance, distances, links, finish};

}  // namespace sdfgrid::SDFGRID_ISA
