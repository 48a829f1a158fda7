// trace/field_trace.h: where rays meet the surface of an analytic field, by sphere tracing that
// needs no tuning. Lengths are in world units.
//
// The parts of a union are objects of their own, met through a hierarchy of boxes (object_tree.h);
// along a ray past a convex one its distance is a convex function, so that the next step goes to
// where the line through the last two values ends, or nowhere. Where a ray would meet the boxes of
// several of them a picture has them pruned together, as one object. Of one object:
//
// Rays go in bundles that run close to each other. The space that a bundle runs through is divided
// in two, again and again, along the rays or across them, and the program pruned on the way down:
// where the field's interval shows nothing, all of them jump; elsewhere they are traced with what
// is left of the program, a batch of them at a time. Sixteen rays beside each other first go
// together, as a beam. Steps are as long as the local bound on the gradient allows
// (field/local_bounds.h), and longer where the field lets them: relaxed as by R. Ban and G.
// Valasek, "Automatic Step Size Relaxation in Sphere Tracing" (2023), taken back where two steps do
// not prove the way between them free.
#pragma once

#include <cstdint>
#include <memory>
#include <span>
#include <vector>

#include "sdfgrid/core/job.h"
#include "sdfgrid/field/field.h"
#include "sdfgrid/field/local_bounds.h"
#include "sdfgrid/trace/camera.h"
#include "sdfgrid/trace/trace.h"

namespace sdfgrid {

// All on: each alone changes the work, not what is hit but for rays that graze.
struct FieldTraceOptions {
  bool relax = true;
  bool local_bounds = true;
  bool prune = true;
  bool objects = true;  // parts of a union each by itself, where a ray does not meet most of them:
                        // evaluated next where its own last value ends, whatever the others make of
                        // the ray (the triangle inequality). Off: all of them at each step
  bool boxes = true;  // objects are found through a tree of boxes, nearest first. Off: all of them,
                      // everywhere in the region
  bool convex = true;   // steps of objects that are convex follow the secant
  bool beams = true;    // rays beside each other go together as long as they are far from anything
  bool bundles = true;  // off: one ray after the other (object_rays.h), neither relaxed nor pruned,
                        // but for rays that begin inside; so go up to three rays of a union in any
                        // case, faster than in a bundle
};
// Steps as long as the value of the whole field, no more: what all else is held against.
inline constexpr FieldTraceOptions kPlainSphereTracing = {.relax = false,
                                                          .local_bounds = false,
                                                          .prune = false,
                                                          .objects = false,
                                                          .convex = false,
                                                          .beams = false};

class FieldMarch;
class ObjectTree;
struct Bundle;
struct ObjectRules;

// Pixels that lie in the picture.
struct PixelSquare {
  int x, y, width, height;
};

class FieldTracer {
 public:
  // `region` must be finite: what lies beyond is not seen.
  FieldTracer(const Field& field, const Box& region, FieldTraceOptions options = {});
  ~FieldTracer();

  // Of each ray the distance to its first hit, +inf if there is none, and how often the field, or
  // an object of it, was evaluated for it. A hit is where less than `tolerance` times the distance
  // (and what single precision can tell) is known to be free; rays that start inside hit where they
  // leave. Directions have unit length; all rays begin on the same side of the surface, and those
  // beside each other in the list should run beside each other. Safe to call from many threads.
  void trace(std::span<const Ray> rays, double tolerance, std::span<float> depth,
             std::span<std::uint32_t> steps) const;

  // First hits of the rays through the pixel centres, each where less than a fiftieth of a pixel's
  // width is known to be free.
  [[nodiscard]] HitBuffer trace_primary(const Camera& camera, const Job& job) const;

  [[nodiscard]] const Field& field() const { return field_; }
  [[nodiscard]] const Box& region() const { return region_; }

 private:
  [[nodiscard]] float sign_at(const glm::dvec3& p) const;
  [[nodiscard]] ObjectRules object_rules() const;
  [[nodiscard]] bool go_apart(float sign) const;
  [[nodiscard]] bool go_alone(std::size_t rays, float sign) const;
  void trace(Bundle& bundle, const Field* field, double tolerance, float sign,
             FieldMarch& march) const;
  void trace_bundle(std::span<const Ray> rays, double tolerance, float sign, std::span<float> depth,
                    std::span<std::uint32_t> steps) const;
  void trace_alone(std::span<const Ray> rays, double tolerance, std::span<float> depth,
                   std::span<std::uint32_t> steps) const;
  [[nodiscard]] HitBuffer trace_alone(const Camera& camera, const Job& job) const;
  [[nodiscard]] Box seen_through(const RayGenerator& generator, const glm::dvec3& eye,
                                 const PixelSquare& square) const;

  Field field_;
  Box region_;
  FieldTraceOptions options_;
  std::unique_ptr<const LocalBounds> bounds_;  // of the whole; none where they would not help
  std::unique_ptr<const ObjectTree> objects_;  // none if it is not taken apart
  bool crowded_ = false;                       // they are so close that pruning serves better
};

}  // namespace sdfgrid
