#include "sdfgrid/trace/field_trace.h"

#include <algorithm>
#include <cmath>
#include <glm/common.hpp>
#include <glm/geometric.hpp>
#include <limits>

#include "sdfgrid/core/error.h"
#include "sdfgrid/core/parallel.h"
#include "sdfgrid/field/parts.h"
#include "sdfgrid/trace/field_march.h"
#include "sdfgrid/trace/object_tree.h"

namespace sdfgrid {
namespace {

constexpr double kInfinity = std::numeric_limits<double>::infinity();
constexpr int kTile = 32;          // pixels a side of a bundle
constexpr int kBlock = 4 * kTile;  // of a square for which the program is pruned first

double largest(const glm::dvec3& v) {
  return std::max({std::fabs(v.x), std::fabs(v.y), std::fabs(v.z)});
}

}  // namespace

FieldTracer::FieldTracer(const Field& field, const Box& region, FieldTraceOptions options)
    : field_(field), region_(region), options_(options) {
  if (region.empty() || !std::isfinite(largest(region.lo)) || !std::isfinite(largest(region.hi))) {
    throw Error(ErrorKind::usage, "rays need a region with an end to be traced in");
  }
  if (options.objects) {
    std::vector<FieldPart> parts = parts_of(field);
    if (parts.size() > 1) {
      objects_ = std::make_unique<ObjectTree>(std::move(parts), region, options.local_bounds);
    }
  }
  constexpr int kLevels = 5;
  if (options.local_bounds && !objects_) bounds_ = useful_bounds(field_, region_, kLevels);
}

FieldTracer::~FieldTracer() = default;

// `field` is what is left of the whole for these rays.
void FieldTracer::trace(Bundle& bundle, const Field& field, double tolerance) const {
  MarchRules rules{options_.relax, options_.prune, false, bounds_.get(), tolerance, 1};
  if (field_(glm::vec3(bundle.rays[0].origin)) < 0) rules.sign = -1;
  if (objects_ && rules.sign > 0) return objects_->trace(bundle, rules, options_.convex);
  std::vector<Stretch> stretches;
  for (std::size_t i = 0; i < bundle.rays.size(); ++i) {
    const Span s = clip(bundle.rays[i], region_);
    if (s.from < s.to) stretches.push_back({static_cast<std::uint32_t>(i), s.from, s.to});
  }
  FieldMarch(bundle).run(field, rules, stretches);
}

namespace {

void write_results(const Bundle& bundle, std::size_t first, std::size_t count, float* depth,
                   std::uint16_t* steps) {
  for (std::size_t i = 0; i < count; ++i) {
    depth[i] = static_cast<float>(bundle.depth[first + i]);
    if (steps == nullptr) continue;
    steps[i] = static_cast<std::uint16_t>(std::min(bundle.steps[first + i], 65535U));
  }
}

}  // namespace

void FieldTracer::trace(std::span<const Ray> rays, double tolerance, std::span<float> depth,
                        std::span<std::uint16_t> steps) const {
  constexpr std::size_t kBundle = std::size_t{kTile} * kTile;
  for (std::size_t i = 0; i < rays.size(); i += kBundle) {
    const std::size_t n = std::min(kBundle, rays.size() - i);
    Bundle bundle(rays.subspan(i, n));
    trace(bundle, field_, tolerance);
    write_results(bundle, 0, n, depth.data() + i, steps.empty() ? nullptr : steps.data() + i);
  }
}

namespace {

std::vector<Ray> rays_of(const RayGenerator& generator, const PixelSquare& square) {
  std::vector<Ray> rays;
  for (int y = 0; y < square.height; ++y) {
    for (int x = 0; x < square.width; ++x) {
      rays.push_back(generator.ray(square.x + x + 0.5, square.y + y + 0.5));
    }
  }
  return rays;
}

}  // namespace

// A box around all of the region that is seen through a square of pixels.
Box FieldTracer::seen_through(const RayGenerator& generator, const glm::dvec3& eye,
                              const PixelSquare& square) const {
  const glm::dvec3 farthest = glm::max(glm::abs(region_.lo - eye), glm::abs(region_.hi - eye));
  Box box;
  box.add(eye);
  for (const int x : {square.x, square.x + square.width}) {
    for (const int y : {square.y, square.y + square.height}) {
      // These are one unit deep, so that all points between them are in the box.
      const glm::dvec3 through =
          generator.corner() + double(x) * generator.right() + double(y) * generator.down();
      box.add(eye + 1.01 * glm::length(farthest) * through);
    }
  }
  const double slack = kFieldSlack * (largest(region_.lo) + largest(region_.hi));
  box.lo = glm::max(box.lo, region_.lo) - slack;
  box.hi = glm::min(box.hi, region_.hi) + slack;
  return box;
}

HitBuffer FieldTracer::trace_primary(const Camera& camera, const Job& job) const {
  HitBuffer hits;
  hits.width = camera.width;
  hits.height = camera.height;
  const auto pixels = static_cast<std::size_t>(camera.width) * camera.height;
  hits.depth.assign(pixels, std::numeric_limits<float>::infinity());
  hits.steps.assign(pixels, 0);
  const RayGenerator generator(camera);
  const double tolerance = 0.02 * glm::length(generator.right());
  const auto tile = [&](const Field& field, const PixelSquare& square) {
    const std::vector<Ray> rays = rays_of(generator, square);
    Bundle bundle(rays);
    trace(bundle, field, tolerance);
    for (int y = 0; y < square.height; ++y) {
      const std::size_t row = std::size_t(square.y + y) * camera.width + square.x;
      write_results(bundle, std::size_t(y) * square.width, square.width, &hits.depth[row],
                    &hits.steps[row]);
    }
  };
  const int across = (camera.width + kBlock - 1) / kBlock;
  const int down = (camera.height + kBlock - 1) / kBlock;
  parallel_for(std::size_t(across) * down, 1, job, [&](std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i) {
      const int left = static_cast<int>(i % across) * kBlock;
      const int top = static_cast<int>(i / across) * kBlock;
      const int right = std::min(left + kBlock, camera.width);
      const int bottom = std::min(top + kBlock, camera.height);
      const Box box = seen_through(generator, camera.eye, {left, top, right - left, bottom - top});
      const Field here = options_.prune && !objects_ ? field_.pruned(box) : field_;
      for (int y = top; y < bottom; y += kTile) {
        job.checkpoint();
        for (int x = left; x < right; x += kTile) {
          tile(here, {x, y, std::min(kTile, right - x), std::min(kTile, bottom - y)});
        }
      }
    }
  });
  return hits;
}

}  // namespace sdfgrid
