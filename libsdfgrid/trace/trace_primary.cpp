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

constexpr int kPacket = 4;                // pixels a side
constexpr int kTile = kPacket * kPacket;  // the same
constexpr std::size_t kTask = 32;         // tiles at a time on a thread
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
              tolerance(),
              false};
    eye_ = atlas.lattice.to_index(camera.eye) - glm::dvec3(atlas.lo * Atlas::kBrick);
    const glm::dvec3 corner = rays_.corner();
    for (int a = 0; a < 3; ++a) {
      camera_.eye[a] = eye_[a];
      camera_.corner[a] = corner[a];
      camera_.right[a] = rays_.right()[a];
      camera_.down[a] = rays_.down()[a];
    }
    const double value = value_at(atlas, eye_);
    scene_.inside = value < 0;
    // Too close to tell in float, or too many bricks for a lane's 32-bit index.
    in_double_ = !(std::abs(value) > scene_.tolerance) ||
                 atlas.samples.size() > std::size_t(std::numeric_limits<std::int32_t>::max());
  }

  [[nodiscard]] std::size_t tiles() const {
    return static_cast<std::size_t>((hits_.width + kTile - 1) / kTile) *
           static_cast<std::size_t>((hits_.height + kTile - 1) / kTile);
  }

  // Pixels that no ray can hit stay as they are.
  void trace_tiles(std::size_t begin, std::size_t end) const {
    const auto across = static_cast<std::size_t>((hits_.width + kTile - 1) / kTile);
    Batch batch;
    for (std::size_t i = begin; i < end; ++i) {
      const int x = static_cast<int>(i % across) * kTile;
      const int y = static_cast<int>(i / across) * kTile;
      in_double_ ? trace_singly(x, y) : gather(x, y, batch);
    }
    trace(batch);
  }

 private:
  struct Batch {
    PacketRays rays;
    std::size_t pixels[PacketRays::kPackets];  // the first of each packet
  };

  // Twice the error of a computed place, times the slope.
  [[nodiscard]] float tolerance() const { return 0.25F * atlas_.margin(); }

  // Bit i: pixel i of the packet at (x, y) is in the picture.
  [[nodiscard]] std::uint32_t in_picture(int x, int y) const {
    if (x + kPacket <= hits_.width && y + kPacket <= hits_.height) return 0xffffU;
    std::uint32_t bits = 0;
    for (int i = 0; i < PacketRays::kLanes; ++i) {
      if (x + i % kPacket < hits_.width && y + i / kPacket < hits_.height) bits |= 1U << i;
    }
    return bits;
  }

  // What unit directions in a square of pixels differ by from the middle one, at most: no more than
  // their places in a plane at distance 1 from the eye.
  [[nodiscard]] double spread(int size) const {
    return 0.5 * size * std::hypot(glm::length(rays_.right()), glm::length(rays_.down()));
  }

  // Adds the packets of a tile that may hit; traces the batch when it is full.
  void gather(int left, int top, Batch& batch) const {
    const glm::dvec3 axis = rays_.ray(left + 0.5 * kTile, top + 0.5 * kTile).direction;
    const double start = march(atlas_, {eye_, axis, spread(kTile)}, 0);
    if (start == kInfinity) return;
    double starts[PacketRays::kLanes];
    kernel_.march_packets(scene_, camera_, left, top, spread(kPacket), start, starts);
    for (int i = 0; i < PacketRays::kLanes; ++i) {
      const int x = left + i % kPacket * kPacket;
      const int y = top + i / kPacket * kPacket;
      if (starts[i] == kInfinity || x >= hits_.width || y >= hits_.height) continue;
      if (batch.rays.packets == PacketRays::kPackets) trace(batch);
      batch.pixels[batch.rays.packets] = row(y) + x;
      kernel_.add_rays(camera_, x, y, starts[i], batch.rays);
      batch.rays.active[batch.rays.packets - 1] = in_picture(x, y);
    }
  }

  // Traces the batch and empties it.
  void trace(Batch& batch) const {
    PacketRays& rays = batch.rays;
    std::uint32_t wanted[PacketRays::kPackets];
    std::copy_n(rays.active, rays.packets, wanted);
    PacketHits found;
    kernel_.trace(scene_, rays, found);
    for (int packet = 0; packet < rays.packets; ++packet) {
      write(batch, found, packet, wanted[packet]);
    }
    rays.packets = 0;
  }

  void write(const Batch& batch, const PacketHits& found, int packet, std::uint32_t wanted) const {
    const int first = packet * PacketRays::kLanes;
    float depth[PacketRays::kLanes];
    std::uint16_t steps[PacketRays::kLanes];
    for (int i = 0; i < PacketRays::kLanes; ++i) {
      const double t = batch.rays.from[first + i] + double(found.t[first + i]);
      depth[i] = static_cast<float>(found.outcome[first + i] == kHit ? t * voxel_ : kInfinity);
      steps[i] = static_cast<std::uint16_t>(std::min(found.steps[first + i], 65535));
    }
    for (int i = 0; i < PacketRays::kLanes; ++i) {
      if (((wanted >> i) & 1U) == 0) continue;
      const std::size_t pixel = batch.pixels[packet] + row(i / kPacket) + i % kPacket;
      hits_.depth[pixel] = depth[i];
      hits_.steps[pixel] = steps[i];
      if (found.outcome[first + i] == kUnsure) trace_singly(pixel);
    }
  }

  void trace_singly(int left, int top) const {
    for (int y = top; y < std::min(top + kTile, hits_.height); ++y) {
      for (int x = left; x < std::min(left + kTile, hits_.width); ++x) trace_singly(row(y) + x);
    }
  }

  void trace_singly(std::size_t pixel) const {
    const std::size_t width = row(1);
    const Ray ray = rays_.ray(double(pixel % width) + 0.5, double(pixel / width) + 0.5);
    const Walk walk = walk_ray(atlas_, ray, 0, kInfinity);
    hits_.depth[pixel] = static_cast<float>(walk.hit ? walk.t * voxel_ : kInfinity);
    hits_.steps[pixel] = static_cast<std::uint16_t>(std::min(walk.steps, 65535));
  }

  // Where a row of pixels begins.
  [[nodiscard]] std::size_t row(int y) const { return std::size_t(y) * std::size_t(hits_.width); }

  const Atlas& atlas_;
  RayGenerator rays_;
  HitBuffer& hits_;
  const PacketKernel& kernel_;
  double voxel_ = atlas_.lattice.voxel;
  glm::dvec3 eye_{0.0};  // in cells, from the first slot
  PacketScene scene_{};
  PacketCamera camera_{};
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
  parallel_for("trace", tracer.tiles(), kTask, job,
               [&](std::size_t begin, std::size_t end) { tracer.trace_tiles(begin, end); });
  return hits;
}

}  // namespace sdfgrid
