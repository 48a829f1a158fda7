#include "sdfgrid/trace/field_trace.h"

#include <algorithm>
#include <cmath>
#include <glm/common.hpp>
#include <glm/geometric.hpp>
#include <glm/vec2.hpp>
#include <limits>

#include "sdfgrid/core/error.h"
#include "sdfgrid/core/parallel.h"
#include "sdfgrid/field/parts.h"
#include "sdfgrid/trace/field_march.h"
#include "sdfgrid/trace/object_rays.h"

namespace sdfgrid {
namespace {

constexpr double kInfinity = std::numeric_limits<double>::infinity();
constexpr int kTile = 64;          // pixels a side of a bundle
constexpr int kBlock = 2 * kTile;  // of a square for which the program is pruned first
// Objects are pruned together where a ray meets more than so many of their boxes, and the picture
// has so many pixels for each instruction.
constexpr double kCrowd = 2;
constexpr std::size_t kPixels = 1024;

double half_surface(const Box& box) {
  const glm::dvec3 s = box.size();
  return s.x * s.y + s.y * s.z + s.z * s.x;
}

// Of lines through a box so many meet one in it as its surface is of the box's (Cauchy): whether
// those through the region meet many objects' boxes. Local bounds are of each object.
bool is_crowd(const ObjectTree& tree, const Box& region) {
  double surface = 0;
  for (const ObjectTree::Object& object : tree.objects()) {
    if (object.bounds) return false;
    surface += half_surface(object.box);
  }
  return surface > kCrowd * half_surface(region);
}

}  // namespace

FieldTracer::FieldTracer(const Field& field, const Box& region, FieldTraceOptions options)
    : field_(field), region_(region), options_(options) {
  if (region.empty() || !std::isfinite(reach(region))) {
    throw Error(ErrorKind::usage, "rays need a region with an end to be traced in");
  }
  if (options.objects || !options.bundles) {
    std::vector<FieldPart> parts = parts_of(field);
    if (parts.size() > 1 || !options.bundles) {
      objects_ = std::make_unique<ObjectTree>(std::move(parts), region, options.local_bounds);
      crowded_ = options.prune && is_crowd(*objects_, region);
    }
  }
  if (options.local_bounds && !objects_) {
    bounds_ = useful_bounds(field_, region_, LocalBounds::kLevels);
  }
}

FieldTracer::~FieldTracer() = default;

float FieldTracer::sign_at(const glm::dvec3& p) const { return field_(glm::vec3(p)) < 0 ? -1 : 1; }

ObjectRules FieldTracer::object_rules() const {
  return {options_.boxes, options_.objects, options_.convex};
}

// Those that begin outside may meet each object by itself.
bool FieldTracer::go_apart(float sign) const { return options_.objects && objects_ && sign > 0; }

// Up to three rays are faster one by one. Those that begin inside look for where they leave the
// whole.
bool FieldTracer::go_alone(std::size_t rays, float sign) const {
  constexpr std::size_t kFew = 3;
  return objects_ && sign > 0 && (!options_.bundles || (options_.objects && rays <= kFew));
}

// `field` is what is left of the whole for these rays, or null where objects are traced each by
// itself; `sign` is its sign where they begin.
void FieldTracer::trace(Bundle& bundle, const Field* field, double tolerance, float sign,
                        FieldMarch& march) const {
  MarchRules rules;
  rules.relax = options_.relax;
  rules.prune = options_.prune;
  rules.beams = options_.beams;
  rules.bounds = bounds_.get();
  rules.tolerance = tolerance;
  rules.sign = sign;
  if (field == nullptr) return objects_->trace(bundle, rules, object_rules(), march);
  march.run(bundle, *field, rules, region_);
}

namespace {

// Kept from one call to the next by each thread: single rays are traced too.
struct Workspace {
  Bundle bundle;
  FieldMarch march;
  ObjectRays alone;
};
Workspace& workspace() {
  thread_local Workspace space;
  return space;
}

std::uint16_t counted(std::uint32_t steps) {
  return static_cast<std::uint16_t>(std::min(steps, 65535U));
}

}  // namespace

void FieldTracer::trace(std::span<const Ray> rays, double tolerance, std::span<float> depth,
                        std::span<std::uint32_t> steps) const {
  constexpr std::size_t kBundle = 1024;
  for (std::size_t i = 0; i < rays.size(); i += kBundle) {
    const std::size_t n = std::min(kBundle, rays.size() - i);
    const float sign = sign_at(rays[i].origin);
    const std::span<std::uint32_t> counts = steps.empty() ? steps : steps.subspan(i, n);
    if (go_alone(rays.size(), sign)) {
      trace_alone(rays.subspan(i, n), tolerance, depth.subspan(i, n), counts);
    } else {
      trace_bundle(rays.subspan(i, n), tolerance, sign, depth.subspan(i, n), counts);
    }
  }
}

void FieldTracer::trace_bundle(std::span<const Ray> rays, double tolerance, float sign,
                               std::span<float> depth, std::span<std::uint32_t> steps) const {
  Workspace& space = workspace();
  Bundle& bundle = space.bundle;
  bundle.set(rays);
  trace(bundle, go_apart(sign) ? nullptr : &field_, tolerance, sign, space.march);
  for (std::size_t k = 0; k < rays.size(); ++k) {
    depth[k] = static_cast<float>(bundle.depth[k]);
    if (!steps.empty()) steps[k] = bundle.steps[k];
  }
}

void FieldTracer::trace_alone(std::span<const Ray> rays, double tolerance, std::span<float> depth,
                              std::span<std::uint32_t> steps) const {
  ObjectRays& alone = workspace().alone;
  for (std::size_t k = 0; k < rays.size(); ++k) {
    const ObjectRays::Result hit = alone.trace(*objects_, object_rules(), tolerance, rays[k]);
    depth[k] = static_cast<float>(hit.depth);
    if (!steps.empty()) steps[k] = hit.evaluations;
  }
}

namespace {

PacketCamera packet_camera(const RayGenerator& generator, const glm::dvec3& eye) {
  PacketCamera c{};
  for (int a = 0; a < 3; ++a) {
    c.eye[a] = eye[a];
    c.corner[a] = generator.corner()[a];
    c.right[a] = generator.right()[a];
    c.down[a] = generator.down()[a];
  }
  return c;
}

constexpr int kSide = 4;  // pixels of a block

// The blocks of 4 x 4 pixels that cover a square, in the order of a Z: halves of the list, and
// halves of those, are beside each other.
std::vector<glm::ivec2> blocks_of(const PixelSquare& square) {
  const auto every_second_bit = [](int z) {
    int r = 0;
    for (int bit = 0; bit < 8; ++bit) r |= (z >> 2 * bit & 1) << bit;
    return r;
  };
  std::vector<glm::ivec2> blocks;
  constexpr int kMost = kTile / kSide * (kTile / kSide);
  for (int z = 0; z < kMost; ++z) {
    const glm::ivec2 at = kSide * glm::ivec2(every_second_bit(z), every_second_bit(z >> 1));
    if (at.x < square.width && at.y < square.height) {
      blocks.emplace_back(square.x + at.x, square.y + at.y);
    }
  }
  return blocks;
}

void look(const PacketCamera& camera, std::span<const glm::ivec2> blocks, Bundle& bundle) {
  const StepKernel& kernel = step_kernel();
  bundle.reset(blocks.size() * RayLanes::kLanes);
  for (std::size_t i = 0; i < blocks.size(); ++i) {
    kernel.look(camera, blocks[i].x, blocks[i].y, bundle.rays[i]);
  }
}

// Blocks may lie partly beyond the picture.
void write_results(const Bundle& bundle, std::span<const glm::ivec2> blocks, HitBuffer& hits) {
  const StepKernel& kernel = step_kernel();
  const double* depth = bundle.depth.data();
  const std::uint32_t* steps = bundle.steps.data();
  for (const glm::ivec2& block : blocks) {
    const int rows = std::min(kSide, hits.height - block.y);
    const int columns = std::min(kSide, hits.width - block.x);
    const std::size_t first = std::size_t(block.y) * hits.width + block.x;
    if (rows == kSide && columns == kSide) {
      kernel.write(depth, steps, &hits.depth[first], &hits.steps[first], hits.width);
    } else {
      for (int i = 0; i < rows * kSide; ++i) {
        if (i % kSide >= columns) continue;
        const std::size_t pixel = first + std::size_t(i / kSide) * hits.width + i % kSide;
        hits.depth[pixel] = static_cast<float>(depth[i]);
        hits.steps[pixel] = counted(steps[i]);
      }
    }
    depth += RayLanes::kLanes;
    steps += RayLanes::kLanes;
  }
}

}  // namespace

// A box around all of the region that is seen through a square of pixels, and around the beams of
// its blocks: those at the picture's border reach beyond it, and the axis of a beam may run beside
// what its rays see.
Box FieldTracer::seen_through(const RayGenerator& generator, const glm::dvec3& eye,
                              const PixelSquare& square) const {
  const glm::dvec3 farthest = glm::max(glm::abs(region_.lo - eye), glm::abs(region_.hi - eye));
  const auto whole_blocks = [](int pixels) { return (pixels + kSide - 1) / kSide * kSide; };
  Box box;
  box.add(eye);
  for (const int x : {square.x, square.x + whole_blocks(square.width)}) {
    for (const int y : {square.y, square.y + whole_blocks(square.height)}) {
      // These are one unit deep, so that all points between them are in the box.
      const glm::dvec3 through =
          generator.corner() + double(x) * generator.right() + double(y) * generator.down();
      box.add(eye + 1.01 * glm::length(farthest) * through);
    }
  }
  const double beam = kSide * glm::length(generator.right()) * glm::length(farthest);
  const double slack = 2 * kFieldSlack * reach(region_) + beam;
  box.lo = glm::max(box.lo, region_.lo) - slack;
  box.hi = glm::min(box.hi, region_.hi) + slack;
  return box;
}

namespace {

HitBuffer without_hits(const Camera& camera) {
  const auto pixels = static_cast<std::size_t>(camera.width) * camera.height;
  HitBuffer hits{camera.width, camera.height, {}, {}};
  hits.depth.assign(pixels, std::numeric_limits<float>::infinity());
  hits.steps.assign(pixels, 0);
  return hits;
}

// A fiftieth of a pixel's width.
double tolerance_of(const RayGenerator& generator) { return 0.02 * glm::length(generator.right()); }

}  // namespace

HitBuffer FieldTracer::trace_alone(const Camera& camera, const Job& job) const {
  HitBuffer hits = without_hits(camera);
  const RayGenerator generator(camera);
  const auto width = static_cast<std::size_t>(camera.width);
  parallel_for(
      static_cast<std::size_t>(camera.height), 1, job, [&](std::size_t begin, std::size_t end) {
        std::vector<Ray> rays(width);
        std::vector<std::uint32_t> steps(width);
        for (std::size_t y = begin; y < end; ++y) {
          for (std::size_t x = 0; x < width; ++x) {
            rays[x] = generator.ray(double(x) + 0.5, double(y) + 0.5);
          }
          trace_alone(rays, tolerance_of(generator),
                      std::span(hits.depth).subspan(y * width, width), steps);
          std::transform(steps.begin(), steps.end(), hits.steps.begin() + y * width, counted);
        }
      });
  return hits;
}

HitBuffer FieldTracer::trace_primary(const Camera& camera, const Job& job) const {
  HitBuffer hits = without_hits(camera);
  const float sign = sign_at(camera.eye);
  if (go_alone(hits.size(), sign)) return trace_alone(camera, job);
  const RayGenerator generator(camera);
  const double tolerance = tolerance_of(generator);
  const bool together = !go_apart(sign) || (crowded_ && field_.size() * kPixels <= hits.size());
  const PacketCamera packets = packet_camera(generator, camera.eye);
  const int across = (camera.width + kBlock - 1) / kBlock;
  const int down = (camera.height + kBlock - 1) / kBlock;
  parallel_for(std::size_t(across) * down, 1, job, [&](std::size_t begin, std::size_t end) {
    Workspace& space = workspace();
    Bundle& bundle = space.bundle;
    for (std::size_t i = begin; i < end; ++i) {
      const int left = static_cast<int>(i % across) * kBlock;
      const int top = static_cast<int>(i / across) * kBlock;
      const int right = std::min(left + kBlock, camera.width);
      const int bottom = std::min(top + kBlock, camera.height);
      const Box box = seen_through(generator, camera.eye, {left, top, right - left, bottom - top});
      const Field here = options_.prune && together ? field_.pruned(box) : field_;
      for (int y = top; y < bottom; y += kTile) {
        job.checkpoint();
        for (int x = left; x < right; x += kTile) {
          const PixelSquare square{x, y, std::min(kTile, right - x), std::min(kTile, bottom - y)};
          const std::vector<glm::ivec2> blocks = blocks_of(square);
          look(packets, blocks, bundle);
          trace(bundle, together ? &here : nullptr, tolerance, sign, space.march);
          write_results(bundle, blocks, hits);
        }
      }
    }
  });
  return hits;
}

}  // namespace sdfgrid
