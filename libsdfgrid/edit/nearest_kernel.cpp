// The arithmetic of nearest_kernel.h, sixteen points at a time. Compiled once for each instruction
// set: include nothing here that emits functions shared with other files.
#include "sdfgrid/edit/nearest_kernel.h"

#include "sdfgrid/core/simd.h"

namespace sdfgrid::SDFGRID_ISA {
namespace {

alignas(64) constexpr std::int32_t kLane[kLanes] = {0, 1, 2,  3,  4,  5,  6,  7,
                                                    8, 9, 10, 11, 12, 13, 14, 15};

// Sorts the lanes' own nearest points into `out`.
void take_least(F16 squared, I16 which, NearPoints& out) {
  for (int i = 0; i < NearPoints::kMost; ++i) {
    out.squared[i] = 3e38F;
    out.index[i] = -1;
  }
  for (int lane = 0; lane < kLanes; ++lane) {
    float d = squared[lane];
    std::int32_t index = which[lane];
    for (int i = 0; i < NearPoints::kMost; ++i) {
      const bool before = d < out.squared[i] || (d == out.squared[i] && index < out.index[i]);
      if (!before) continue;
      const float later = out.squared[i];
      const std::int32_t later_index = out.index[i];
      out.squared[i] = d;
      out.index[i] = index;
      d = later;
      index = later_index;
    }
  }
}

void nearest(const Positions& points, const float p[3], NearPoints& out) {
  F16 best = splat(3e38F);
  I16 which = splat(0);
  I16 index = load(kLane);
  for (std::int32_t i = 0; i < points.count; i += kLanes) {
    const F16 dx = load(points.x + i) - p[0];
    const F16 dy = load(points.y + i) - p[1];
    const F16 dz = load(points.z + i) - p[2];
    const F16 squared = dx * dx + dy * dy + dz * dz;
    const I16 nearer = squared < best;
    best = select(nearer, squared, best);
    which = select(nearer, index, which);
    index = index + kLanes;
  }
  take_least(best, which, out);
}

constexpr int kNewtonSteps = 6;
constexpr float kShorter = 0.3F;
constexpr float kOnSurface = 1e-3F;  // voxels
constexpr float kLeastSlope2 = 0.01F;

struct V16 {
  F16 x, y, z;
};
V16 operator+(const V16& a, const V16& b) { return {a.x + b.x, a.y + b.y, a.z + b.z}; }
V16 operator-(const V16& a, const V16& b) { return {a.x - b.x, a.y - b.y, a.z - b.z}; }
V16 operator*(const V16& a, const F16& s) { return {a.x * s, a.y * s, a.z * s}; }
F16 dot(const V16& a, const V16& b) { return a.x * b.x + a.y * b.y + a.z * b.z; }
V16 either(const I16& mask, const V16& yes, const V16& no) {
  return {select(mask, yes.x, no.x), select(mask, yes.y, no.y), select(mask, yes.z, no.z)};
}
V16 load_at(const Positions& p, std::int32_t i) {
  return {load(p.x + i), load(p.y + i), load(p.z + i)};
}

struct Field16 {
  F16 value;
  V16 gradient;
};

F16 mix(const F16& a, const F16& b, const F16& t) { return a + (b - a) * t; }

// The cell that a position is in, and the place in it; positions are clamped to the block.
void split(const BlockSamples& block, const F16& p, I16& cell, F16& t) {
  const F16 low = splat(static_cast<float>(-block.apron));
  const F16 high = splat(static_cast<float>(block.edge - block.apron - 2));
  const F16 whole = min(max(floor(p), low), high);
  t = min(max(p - whole, splat(0.0F)), splat(1.0F));
  cell = to_int(whole) + block.apron;
}

// As Block::sample() does.
Field16 sample(const BlockSamples& block, const V16& p) {
  I16 x;
  I16 y;
  I16 z;
  V16 t;
  split(block, p.x, x, t.x);
  split(block, p.y, y, t.y);
  split(block, p.z, z, t.z);
  const I16 at = (x * block.edge + y) * block.edge + z;
  const float* v = block.values;
  const std::int32_t dy = block.edge;
  const std::int32_t dx = dy * block.edge;
  const F16 c000 = gather(v, at);
  const F16 c001 = gather(v + 1, at);
  const F16 c010 = gather(v + dy, at);
  const F16 c011 = gather(v + dy + 1, at);
  const F16 c100 = gather(v + dx, at);
  const F16 c101 = gather(v + dx + 1, at);
  const F16 c110 = gather(v + dx + dy, at);
  const F16 c111 = gather(v + dx + dy + 1, at);
  // Along z, then y, then x; and the differences along each.
  const F16 v00 = mix(c000, c001, t.z);
  const F16 v01 = mix(c010, c011, t.z);
  const F16 v10 = mix(c100, c101, t.z);
  const F16 v11 = mix(c110, c111, t.z);
  const F16 v0 = mix(v00, v01, t.y);
  const F16 v1 = mix(v10, v11, t.y);
  const F16 gz = mix(mix(c001 - c000, c011 - c010, t.y), mix(c101 - c100, c111 - c110, t.y), t.x);
  return {mix(v0, v1, t.x), {v1 - v0, mix(v01 - v00, v11 - v10, t.x), gz}};
}

void signs(const BlockSamples& block, std::uint64_t* rows) {
  const std::uint64_t in_row = ~std::uint64_t{0} >> (64 - block.edge);
  for (std::int32_t row = 0; row < block.edge * block.edge; ++row) {
    const float* values = block.values + static_cast<std::int64_t>(row) * block.edge;
    std::uint64_t word = 0;
    for (std::int32_t z = 0; z < block.edge; z += kLanes) {
      word |= static_cast<std::uint64_t>(bits(load(values + z) < 0.0F)) << z;
    }
    rows[row] = word & in_row;
  }
}

void agree(const BlockSamples& block, const Positions& samples, float tolerance,
           std::uint16_t* bits_out) {
  const std::int32_t dy = block.edge;
  const std::int32_t dx = dy * block.edge;
  for (std::int32_t i = 0; i < samples.count; i += kLanes) {
    const V16 p = load_at(samples, i);
    const I16 x = to_int(p.x) + block.apron;
    const I16 y = to_int(p.y) + block.apron;
    const I16 at = (x * block.edge + y) * block.edge + to_int(p.z) + block.apron;
    const float* v = block.values;
    const F16 value = gather(v, at);
    const V16 twice = {gather(v, at + dx) - gather(v, at - dx),
                       gather(v, at + dy) - gather(v, at - dy),
                       gather(v, at + 1) - gather(v, at - 1)};
    const F16 length = sqrt(dot(twice, twice)) * 0.5F;
    const I16 steep = length > 0.5F;
    const V16 normal = twice * (0.5F / max(length, splat(0.5F)));
    const V16 foot = p - normal * value;
    const F16 there = abs(sample(block, foot).value);
    const F16 side = select(value < 0.0F, splat(-0.5F), splat(0.5F));
    const F16 beyond = sample(block, foot - normal * side).value * side;
    bits_out[i / kLanes] =
        static_cast<std::uint16_t>(bits(steep & (there <= tolerance) & (beyond < 0.0F)));
  }
}

void improve(const BlockSamples& block, const Positions& from, const Positions& to,
             float* distances) {
  for (std::int32_t i = 0; i < from.count; i += kLanes) {
    const V16 p = load_at(from, i);
    V16 c = load_at(to, i);
    F16 best = sqrt(dot(p - c, p - c));
    Field16 here = sample(block, c);
    F16 part = splat(1.0F);  // of a step that is made
    I16 going = best >= 0.0F;
    for (int step = 0; step < kNewtonSteps; ++step) {
      const F16 squared = dot(here.gradient, here.gradient);
      going = going & (squared > kLeastSlope2);
      // Towards the foot of p on the tangent plane at c, then back to the surface from there.
      const F16 along =
          (here.value + dot(here.gradient, p - c)) / max(squared, splat(kLeastSlope2));
      const V16 moved = (p - here.gradient * along - c) * part;
      const F16 length = sqrt(dot(moved, moved));
      const V16 foot = c + moved * (1.0F / max(length, splat(1.0F)));
      const Field16 there = sample(block, foot);
      const F16 slope = dot(there.gradient, there.gradient);
      going = going & (slope > kLeastSlope2);
      const V16 back = foot - there.gradient * (there.value / max(slope, splat(kLeastSlope2)));
      const Field16 reached = sample(block, back);
      const F16 distance = sqrt(dot(p - back, p - back));
      const I16 better = going & (distance < best) & (abs(reached.value) < kOnSurface);
      best = select(better, distance, best);
      c = either(better, back, c);
      here = {select(better, reached.value, here.value),
              either(better, reached.gradient, here.gradient)};
      // Where the surface is bent more sharply than the sphere around p, steps lead past the foot.
      part = select(better, part, part * kShorter);
      going = going & (length >= 0.01F);
      if (!any(going)) break;
    }
    store(distances + i, best);
  }
}

}  // namespace

extern const NearestKernel kNearestKernel;
const NearestKernel kNearestKernel = {signs, nearest, agree, improve};

}  // namespace sdfgrid::SDFGRID_ISA
