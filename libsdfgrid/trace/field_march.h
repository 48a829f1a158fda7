// trace/field_march.h: rays against one field, from where they may first meet it (internal to
// trace/): the steps of sphere tracing. field_trace.h says what they are.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "sdfgrid/field/field.h"
#include "sdfgrid/field/local_bounds.h"
#include "sdfgrid/trace/camera.h"
#include "sdfgrid/trace/step_kernel.h"

namespace sdfgrid {

// Where a ray is in the box: from > to if it is not.
struct Span {
  double from, to;
};
[[nodiscard]] Span clip(const Ray& ray, const Box& box);

// The largest coordinate of a box, without its sign.
[[nodiscard]] double reach(const Box& box);

// A part of a ray, by its place in the bundle.
struct Stretch {
  std::uint32_t ray;
  double from, to;
};

struct MarchRules {
  bool relax = true;
  bool prune = true;
  bool beams = true;                    // rays beside each other first go together
  bool convex = false;                  // the field's value is a convex function along any ray
  const LocalBounds* bounds = nullptr;  // null: the slope is 1 everywhere
  double tolerance = 0;                 // as in FieldTracer::trace
  float sign = 1;                       // of the field where the stretches begin
};

// The rays of one bundle and what is known of them so far. Ray i is lane i % 16 of group i / 16.
struct Bundle {
  std::size_t size = 0;
  std::vector<RayLanes> rays;
  std::vector<double> depth;         // of the first hit; infinite if there is none
  std::vector<std::uint32_t> steps;  // evaluations

  // Nothing is known yet of so many rays.
  void reset(std::size_t count);
  void set(std::span<const Ray> of);
};

// Memory is kept from one run to the next.
class FieldMarch {
 public:
  // Lowers the bundle's depths to the first hits of the field within the stretches. Those that lie
  // beside each other in the list should be beside each other in space.
  void run(Bundle& bundle, const Field& field, const MarchRules& rules,
           std::span<const Stretch> stretches);
  // All rays, within a box.
  void run(Bundle& bundle, const Field& field, const MarchRules& rules, const Box& box);

 private:
  static constexpr int kLanes = RayGroup::kLanes;

  struct alignas(64) Column {
    float lanes[kLanes];
  };
  // Groups beside each other, and what is not known to be free of their way.
  struct Part {
    std::uint32_t begin, end;
    double t0, t1;
  };

  void reset(Bundle& bundle, const MarchRules& rules, std::size_t groups);
  [[nodiscard]] glm::dvec3 beginning(const Stretch& stretch) const;
  void add_group(std::span<const Stretch> stretches);
  void begin(const RayLanes& rays, double* depth, const double* from, const double* to);
  void run(const Field& field);
  void march(const Field& field, const Part& part);
  void trace(const Field& field, const Part& part, double grain);
  void lead(const Field& field, double base, StepRule rule);
  void steps(const Field& field, std::vector<RayGroup>& groups, std::vector<std::uint32_t>& list,
             const StepRule& rule, const float* from);
  void finish();
  [[nodiscard]] FreeWays ways_of(std::span<const std::uint32_t> list, const StepRule& rule,
                                 const float* values);

  const StepKernel& kernel_ = step_kernel();
  Bundle* bundle_ = nullptr;
  MarchRules rules_;
  // Never made smaller; lane i of beam j leads the group 16 j + i.
  std::vector<RayGroup> rays_, beams_;
  std::vector<RayLanes> axes_;  // of the beams
  std::size_t groups_in_use_ = 0;
  double grain_ = 1;                 // of the places of groups that set out
  std::vector<double> clear_, end_;  // of each, GroupWay in columns
  // Of groups that are not the bundle's own: their rays, depths, and whose these are.
  std::vector<RayLanes> packed_;
  std::vector<double> packed_depth_;
  std::vector<std::uint32_t> ray_of_;
  std::vector<std::uint32_t> list_, groups_, beam_list_;
  std::vector<Column> columns_;
  std::vector<float> ways_, from_, starts_;
};

}  // namespace sdfgrid
