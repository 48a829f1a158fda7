// Primary rays: tiles in parallel, in each packets of 4 x 4 rays, and the few rays of which a
// packet is unsure one by one in double.
#include <algorithm>
#include <cmath>
#include <glm/geometric.hpp>
#include <limits>

#include "sdfgrid/core/parallel.h"
#include "sdfgrid/trace/beam.h"
#include "sdfgrid/trace/packet_kernel.h"
#include "sdfgrid/trace/trace.h"
#include "sdfgrid/trace/walk.h"

namespace sdfgrid {
namespace {

constexpr int kTile = 16;  // pixels a side
constexpr int kPacket = 4;
constexpr double kInfinity = std::numeric_limits<double>::infinity();

// One picture's worth of constants.
class Tracer {
 public:
  Tracer(const Atlas& atlas, const Camera& camera, HitBuffer& hits)
      : atlas_(atlas), rays_(camera), hits_(hits), kernel_(packet_kernel()) {
    scene_ = {atlas.bricks.data(),
              atlas.jumps.data(),
              atlas.hops.data(),
              atlas.samples.data(),
              {atlas.dims.x, atlas.dims.y, atlas.dims.z},
              tolerance()};
    eye_ = atlas.lattice.to_index(camera.eye) - glm::dvec3(atlas.lo * Atlas::kBrick);
    const glm::dvec3 corner = rays_.corner();
    for (int a = 0; a < 3; ++a) {
      camera_.eye[a] = eye_[a];
      camera_.corner[a] = corner[a];
      camera_.right[a] = rays_.right()[a];
      camera_.down[a] = rays_.down()[a];
    }
    const double value = value_at(atlas, eye_);
    inside_ = value < 0;
    // Too close to tell in float, or too many bricks for a lane's 32-bit index.
    in_double_ = !(std::abs(value) > scene_.tolerance) ||
                 atlas.samples.size() > std::size_t(std::numeric_limits<std::int32_t>::max());
  }

  // Pixels of a tile that no ray can hit stay as they are.
  void trace_tile(int left, int top) const {
    const double start = in_double_ ? 0 : march(atlas_, beam(left, top, kTile), 0);
    if (start == kInfinity) return;
    for (int y = top; y < std::min(top + kTile, hits_.height); y += kPacket) {
      for (int x = left; x < std::min(left + kTile, hits_.width); x += kPacket) {
        if (in_double_) {
          trace_singly(x, y, 0xffffU);
          continue;
        }
        const double from = march(atlas_, beam(x, y, kPacket), start);
        if (from < kInfinity) trace_packet(x, y, from);
      }
    }
  }

 private:
  // Twice the error of a computed place, times the slope.
  [[nodiscard]] float tolerance() const { return 0.25F * atlas_.margin(); }

  // Bit i: pixel i of the packet at (x, y) is in the picture.
  [[nodiscard]] std::uint32_t pixels(int x, int y) const {
    std::uint32_t bits = 0;
    for (int i = 0; i < PacketRays::kRays; ++i) {
      if (x + i % kPacket < hits_.width && y + i / kPacket < hits_.height) bits |= 1U << i;
    }
    return bits;
  }

  // The rays of a square of pixels; none differs more from the middle one than one at a corner.
  [[nodiscard]] Beam beam(int x, int y, int size) const {
    const glm::dvec3 axis = rays_.ray(x + 0.5 * size, y + 0.5 * size).direction;
    double spread = 0;
    for (int n = 0; n < 4; ++n) {
      const Ray corner = rays_.ray(x + (n & 1) * size, y + (n >> 1) * size);
      spread = std::max(spread, glm::length(corner.direction - axis));
    }
    return {eye_, axis, spread};
  }

  void trace_packet(int x, int y, double from) const {
    PacketRays rays;
    PacketHits found;
    kernel_.make_rays(camera_, x, y, from, rays);
    rays.active = pixels(x, y);
    rays.inside = inside_ ? 0xffffU : 0U;
    kernel_.trace(scene_, rays, found);
    for (int i = 0; i < PacketRays::kRays; ++i) {
      if (((rays.active >> i) & 1U) == 0) continue;
      const std::size_t pixel = std::size_t(y + i / kPacket) * hits_.width + x + i % kPacket;
      const bool hit = ((found.hit >> i) & 1U) != 0;
      write(pixel, hit ? found.t[i] : kInfinity, found.steps[i]);
    }
    trace_singly(x, y, found.unsure);
  }

  void trace_singly(int x, int y, std::uint32_t which) const {
    which &= pixels(x, y);
    for (int i = 0; i < PacketRays::kRays; ++i) {
      if (((which >> i) & 1U) == 0) continue;
      const int column = x + i % kPacket;
      const int row = y + i / kPacket;
      const Walk walk = walk_ray(atlas_, rays_.ray(column + 0.5, row + 0.5), 0, kInfinity);
      write(std::size_t(row) * hits_.width + column, walk.hit ? walk.t : kInfinity, walk.steps);
    }
  }

  void write(std::size_t pixel, double t, int steps) const {
    hits_.depth[pixel] = static_cast<float>(t * atlas_.lattice.voxel);
    hits_.steps[pixel] = static_cast<std::uint16_t>(std::min(steps, 65535));
  }

  const Atlas& atlas_;
  RayGenerator rays_;
  HitBuffer& hits_;
  const PacketKernel& kernel_;
  glm::dvec3 eye_{0.0};  // in cells, from the first slot
  PacketScene scene_{};
  PacketCamera camera_{};
  bool inside_ = false;
  bool in_double_ = false;
};

}  // namespace

HitBuffer trace_primary(const Atlas& atlas, const Camera& camera, const Job& job) {
  HitBuffer hits;
  hits.width = camera.width;
  hits.height = camera.height;
  const auto pixels = static_cast<std::size_t>(camera.width) * camera.height;
  hits.depth.assign(pixels, std::numeric_limits<float>::infinity());
  hits.steps.assign(pixels, 0);
  const Tracer tracer(atlas, camera, hits);
  if (atlas.bricks.empty()) return hits;
  const auto across = static_cast<std::size_t>((camera.width + kTile - 1) / kTile);
  const auto down = static_cast<std::size_t>((camera.height + kTile - 1) / kTile);
  parallel_for(across * down, 4, job, [&](std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i) {
      tracer.trace_tile(int(i % across) * kTile, int(i / across) * kTile);
    }
  });
  return hits;
}

}  // namespace sdfgrid
