// The arithmetic of visibility.h, sixteen points at a time. Compiled once for each instruction set:
// include nothing here that emits functions shared with other files.
#include "sdfgrid/core/simd.h"
#include "sdfgrid/trace/visibility.h"

namespace sdfgrid::SDFGRID_ISA {
namespace {

constexpr int kEdge = 9;  // of an Atlas brick

struct V16 {
  F16 x, y, z;
};

inline F16 dot(const V16& a, const V16& b) { return a.x * b.x + a.y * b.y + a.z * b.z; }
inline F16 dot(const V16& a, const float* b) { return a.x * b[0] + a.y * b[1] + a.z * b[2]; }
inline F16 clamp(F16 v, F16 lo, F16 hi) { return min(max(v, lo), hi); }
inline F16 clamp(F16 v, float lo, float hi) { return clamp(v, splat(lo), splat(hi)); }
inline F16 mix(F16 a, F16 b, F16 t) { return a + t * (b - a); }
inline F16 smooth(F16 t) { return t * t * (3.0F - 2.0F * t); }
inline V16 along(const V16& p, const V16& d, F16 t) {
  return {p.x + t * d.x, p.y + t * d.y, p.z + t * d.z};
}

// Interpolates between the eight samples from p[base] on.
inline F16 trilinear(const float* p, I16 base, std::int32_t sx, std::int32_t sy, const V16& t) {
  const auto edge = [&](I16 at) { return mix(gather(p, at), gather(p, at + 1), t.z); };
  const auto face = [&](I16 at) { return mix(edge(at), edge(at + sy), t.y); };
  return mix(face(base), face(base + sx), t.x);
}

// The atlas's field.
inline F16 near_field(const VisibilityScene& s, const V16& p) {
  const V16 slot = {floor(p.x * 0.125F), floor(p.y * 0.125F), floor(p.z * 0.125F)};
  const I16 exists = (slot.x >= 0.0F) & (slot.y >= 0.0F) & (slot.z >= 0.0F) &
                     (slot.x < static_cast<float>(s.dims[0])) &
                     (slot.y < static_cast<float>(s.dims[1])) &
                     (slot.z < static_cast<float>(s.dims[2]));
  F16 value = splat(s.outside);
  if (!any(exists)) return value;
  const auto held = [&](F16 v) { return to_int(select(exists, v, splat(0.0F))); };
  const I16 place = (held(slot.x) * s.dims[1] + held(slot.y)) * s.dims[2] + held(slot.z);
  const I16 brick = select(exists, gather(s.bricks, place), splat(-1));
  value = select(brick < -1, splat(s.inside), value);
  const I16 there = brick >= 0;
  if (!any(there)) return value;
  const V16 local = {p.x - 8.0F * slot.x, p.y - 8.0F * slot.y, p.z - 8.0F * slot.z};
  const I16 x = to_int(local.x);
  const I16 y = to_int(local.y);
  const I16 z = to_int(local.z);
  const I16 sample = brick * (kEdge * kEdge * kEdge) + (x * kEdge + y) * kEdge + z;
  const V16 t = {local.x - to_float(x), local.y - to_float(y), local.z - to_float(z)};
  const F16 in_brick =
      trilinear(s.samples, select(there, sample, splat(0)), kEdge * kEdge, kEdge, t);
  return select(there, in_brick, value);
}

// The far field; beyond its box what it is at the box's wall, plus how far away that is.
inline F16 far_field(const VisibilityScene& s, const V16& p) {
  const F16 in[3] = {(p.x - s.far_origin[0]) / s.far_spacing,
                     (p.y - s.far_origin[1]) / s.far_spacing,
                     (p.z - s.far_origin[2]) / s.far_spacing};
  F16 beyond = splat(0.0F);
  F16 t[3];
  I16 cell[3];
  for (int a = 0; a < 3; ++a) {
    const F16 held = clamp(in[a], 0.0F, static_cast<float>(s.far_dims[a]) - 1.001F);
    beyond += (in[a] - held) * (in[a] - held);
    cell[a] = to_int(held);
    t[a] = held - to_float(cell[a]);
  }
  const std::int32_t stride = s.far_dims[2];
  const I16 base = (cell[0] * s.far_dims[1] + cell[1]) * stride + cell[2];
  const F16 value =
      trilinear(s.far_values, base, s.far_dims[1] * stride, stride, {t[0], t[1], t[2]});
  return sqrt(value * value + beyond * (s.far_spacing * s.far_spacing));
}

// Distance to the surface, the band's where it is sure and blending into the far field's towards
// the band's end. Inside always the band's, since a negative value is all that callers ask there.
inline F16 field(const VisibilityScene& s, const V16& p) {
  const F16 close = near_field(s, p);
  const F16 trust = clamp((close / s.outside - 0.6F) * 2.5F, 0.0F, 1.0F);
  if (!any(trust > 0.0F)) return close;
  return mix(close, max(close, far_field(s, p)), smooth(trust));
}

// The open part of a cone: what the field leaves of its radius, at distances that double. Occluders
// count less the further away they are, so that the reach has no visible end.
inline F16 cone_openness(const VisibilityScene& s, const V16& from, const V16& direction) {
  constexpr float kRadius = 0.5F;  // of a cone of half-angle 30 degrees, a sphere at distance 1
  F16 open = splat(1.0F);
  for (float t = 1.5F; t < s.sky_reach; t *= 2.0F) {
    const F16 value = field(s, along(from, direction, splat(t)));
    const F16 blocked = 1.0F - clamp(value / (kRadius * t), 0.0F, 1.0F);
    const float counts = 1.0F - t / s.sky_reach;
    open = min(open, 1.0F - counts * blocked);
  }
  return open;
}

inline F16 sky(const VisibilityScene& s, const V16& from, const V16& normal) {
  constexpr float kWeights[6] = {0.25F, 0.15F, 0.15F, 0.15F, 0.15F, 0.15F};
  // The rotation that takes the axis to the normal, and so a smooth function of the normal wherever
  // that is not opposite to the axis: v -> v - (v.h) / (1 + axis.n) h + 2 (v.axis) n, h = axis + n.
  const V16 h = {normal.x + s.axis[0], normal.y + s.axis[1], normal.z + s.axis[2]};
  const F16 scale = 1.0F / max(1.0F + dot(normal, s.axis), splat(1e-3F));
  F16 sum = splat(0.0F);
  for (int c = 0; c < 6; ++c) {
    const float* v = s.cones[c];
    const F16 k = dot(h, v) * scale;
    const float m = 2.0F * (v[0] * s.axis[0] + v[1] * s.axis[1] + v[2] * s.axis[2]);
    const V16 direction = {v[0] - k * h.x + m * normal.x, v[1] - k * h.y + m * normal.y,
                           v[2] - k * h.z + m * normal.z};
    sum += kWeights[c] * cone_openness(s, from, direction);
  }
  return sum;
}

inline F16 sun(const VisibilityScene& s, const V16& from, const V16& normal) {
  constexpr int kMaxSteps = 64;
  const V16 direction = {splat(s.sun[0]), splat(s.sun[1]), splat(s.sun[2])};
  I16 active = dot(normal, s.sun) > 0.0F;
  F16 open = splat(1.0F);
  F16 before = splat(1e18F);  // the field at the step before; so large that the first cuts nothing
  F16 stride = splat(1.0F);   // since then
  F16 t = splat(1.0F);
  for (int step = 0; step < kMaxSteps && any(active); ++step) {
    const F16 value = field(s, along(from, direction, t));
    // Where the empty spheres of the two steps cut each other, `back` before t, the surface may be
    // closest to the ray. That is a guess: it may at most halve the passage.
    const F16 cut = (stride * stride + value * value - before * before) / (2.0F * stride);
    const F16 back = clamp(cut, splat(0.0F), min(0.87F * value, stride));
    const F16 closest = sqrt(max(value * value - back * back, splat(0.0F)));
    const F16 passage = closest / max(s.sun_tan * (t - back), splat(1e-3F));
    open = select(active, min(open, select(value > 0.0F, passage, splat(0.0F))), open);
    before = value;
    stride = max(0.85F * value, 0.5F + 0.02F * t);
    t += select(active, stride, splat(0.0F));  // a lane that is done stays where it is
    active = active & (open > 0.01F) & (t < s.sun_reach);
  }
  return smooth(clamp(open, 0.0F, 1.0F));
}

}  // namespace

void visibility(const VisibilityScene& scene, const VisibilityBatch& batch) {
  constexpr float kLift = 0.25F;  // off the surface, where the interpolated field may dip
  for (std::int32_t i = 0; i < batch.count; i += kLanes) {
    const V16 normal = {load(batch.nx + i), load(batch.ny + i), load(batch.nz + i)};
    const V16 point = {load(batch.x + i), load(batch.y + i), load(batch.z + i)};
    const V16 from = along(point, normal, splat(kLift));
    store(batch.sun + i, sun(scene, from, normal));
    store(batch.sky + i, sky(scene, from, normal));
  }
}

}  // namespace sdfgrid::SDFGRID_ISA
