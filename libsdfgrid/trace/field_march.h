// trace/field_march.h: rays against one field, from where they may first meet it (internal to
// trace/): the steps of sphere tracing. field_trace.h says what they are.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "sdfgrid/field/field.h"
#include "sdfgrid/field/local_bounds.h"
#include "sdfgrid/trace/camera.h"

namespace sdfgrid {

// What float evaluation may be off, in proportion to a coordinate.
inline constexpr double kFieldSlack = 1.5e-6;

// Where a ray is in the box: from > to if it is not.
struct Span {
  double from, to;
};
[[nodiscard]] Span clip(const Ray& ray, const Box& box);

// A part of a ray, by its place in the bundle.
struct Stretch {
  std::uint32_t ray;
  double from, to;
};

struct MarchRules {
  bool relax = true;
  bool prune = true;
  bool convex = false;                  // the field's value is a convex function along any ray
  const LocalBounds* bounds = nullptr;  // null: the slope is 1 everywhere
  double tolerance = 0;                 // as in FieldTracer::trace
  float sign = 1;                       // of the field where the stretches begin
};

// The rays of one bundle and what is known of them so far.
struct Bundle {
  std::span<const Ray> rays;
  std::vector<double> depth;         // of the first hit; infinite if there is none
  std::vector<std::uint32_t> steps;  // evaluations

  explicit Bundle(std::span<const Ray> of);
};

// Memory is kept from one run to the next.
class FieldMarch {
 public:
  explicit FieldMarch(Bundle& bundle) : bundle_(bundle) {}

  // Lowers the bundle's depths to the first hits of the field within the stretches.
  void run(const Field& field, const MarchRules& rules, std::span<const Stretch> stretches);

 private:
  struct State {
    std::uint32_t ray;
    bool relaxed = false;  // the step to `next` may have to be taken back
    bool known = false;    // `last` and `value` are
    bool done = false;
    int steps = 0;
    double clear;       // the way up to here is known to be free
    double next;        // where the field is evaluated next: more than clear only if relaxed
    double end;         // of the stretch
    double last = 0;    // where the field was evaluated last, and
    double value = 0;   // what it was there
    double slope = -1;  // of the field along the ray, smoothed
  };

  // What a value says of the way: how far it is free, and how far the surface is at least as long
  // as the slope stays.
  struct Free {
    double way, surface;
  };

  void march(const Field& field, double t0, double t1);
  void trace(const Field& field, double t1);
  void jump(double t1);
  void step(State& s, double r, double error, double t1);
  [[nodiscard]] bool taken_back(State& s, double r) const;
  [[nodiscard]] Free ahead_of(const State& s, double r, double error) const;
  [[nodiscard]] Free free_way(const Ray& ray, double t, double r, double direction) const;
  [[nodiscard]] Box box_of(double t0, double t1) const;

  Bundle& bundle_;
  MarchRules rules_;
  std::vector<State> states_;
  std::vector<std::uint32_t> active_;  // states that are not done
  std::vector<float> columns_;
};

}  // namespace sdfgrid
