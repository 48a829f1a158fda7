// tests/scene/first_root.h: where a ray first meets the surface of a field, proved, not sampled:
// stretches of the ray whose interval is above zero hold no root, nor do short ones beside a value
// that is larger than they are long; others are halved until a change of sign in double precision
// is caught. And what tracing has to keep of that.
#pragma once

#include "sdfgrid/field/field.h"
#include "sdfgrid/trace/camera.h"

namespace sdfgrid::test {

// Before `possible` the field is proved to be above zero; at `certain` it is below zero in double
// precision, and not before it at the ends of any stretch that the proof leaves open. Both are
// infinite if there is no root. A ray that grazes within a millionth of its coordinates has
// `possible` before `certain`.
struct FirstRoot {
  double possible, certain;
};

// Between two places of a ray that begins outside.
[[nodiscard]] FirstRoot first_root(const Field& field, const Ray& ray, double from, double to);
// Along all of a ray that is in a box.
[[nodiscard]] FirstRoot first_root(const Field& field, const Ray& ray, const Box& box);

// The first of so many places beside each other, the ends among them, where the field is below
// zero in double precision: what knows nothing of intervals. Infinite if it is at none.
[[nodiscard]] double first_sample_inside(const Field& field, const Ray& ray, double from, double to,
                                         int samples);

enum class Verdict {
  right,
  missed,   // the hit is beyond the root, or there is none
  invented  // the field is not as near to zero as a hit says
};

// Of a ray whose hit was found at `depth`, infinite if there was none, with a tracer's tolerance
// (field_trace.h).
[[nodiscard]] Verdict judge(const Field& field, const Ray& ray, const FirstRoot& root, double depth,
                            double tolerance);

}  // namespace sdfgrid::test
