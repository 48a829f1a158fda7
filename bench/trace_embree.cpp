#include "trace_peers.h"

#ifdef SDFGRID_BENCH_WITH_EMBREE

#include <embree3/rtcore.h>

#include <algorithm>
#include <cstring>
#include <limits>

#include "sdfgrid/core/parallel.h"

namespace sdfgrid::bench {
namespace {

constexpr float kInfinity = std::numeric_limits<float>::infinity();
constexpr int kTileX = 4;  // a packet of eight is 4 x 2 pixels
constexpr int kTileY = 2;

class Embree : public Peer {
 public:
  Embree(const TriangleSoup& soup, const Camera& camera, int width)
      : packet_(width), camera_(camera), device_(rtcNewDevice("threads=1")) {
    scene_ = rtcNewScene(device_);
    RTCGeometry geometry = rtcNewGeometry(device_, RTC_GEOMETRY_TYPE_TRIANGLE);
    auto* points = static_cast<float*>(rtcSetNewGeometryBuffer(geometry, RTC_BUFFER_TYPE_VERTEX, 0,
                                                               RTC_FORMAT_FLOAT3, 3 * sizeof(float),
                                                               soup.points.size()));
    std::memcpy(points, soup.points.data(), soup.points.size() * 3 * sizeof(float));
    auto* triangles = static_cast<unsigned*>(
        rtcSetNewGeometryBuffer(geometry, RTC_BUFFER_TYPE_INDEX, 0, RTC_FORMAT_UINT3,
                                3 * sizeof(unsigned), soup.triangles.size()));
    std::memcpy(triangles, soup.triangles.data(), soup.triangles.size() * 3 * sizeof(unsigned));
    rtcSetGeometryBuildQuality(geometry, RTC_BUILD_QUALITY_HIGH);
    rtcSetSceneBuildQuality(scene_, RTC_BUILD_QUALITY_HIGH);
    rtcCommitGeometry(geometry);
    rtcAttachGeometry(scene_, geometry);
    rtcReleaseGeometry(geometry);
    rtcCommitScene(scene_);
    make_rays(soup.origin);
  }
  ~Embree() override {
    rtcReleaseScene(scene_);
    rtcReleaseDevice(device_);
  }
  Embree(const Embree&) = delete;
  Embree& operator=(const Embree&) = delete;

  [[nodiscard]] std::string name() const override {
    return packet_ == 1 ? "Embree rtcIntersect1" : "Embree rtcIntersect8";
  }

  void trace(std::vector<float>& depth) const override {
    depth.assign(rays_.size() * 8, kInfinity);
    parallel_for(rays_.size(), 128, Job(), [&](std::size_t begin, std::size_t end) {
      RTCIntersectContext context;
      rtcInitIntersectContext(&context);
      context.flags = RTC_INTERSECT_CONTEXT_FLAG_COHERENT;
      for (std::size_t i = begin; i < end; ++i) {
        float found[8];
        packet_ == 1 ? intersect_single(rays_[i], context, found)
                     : intersect_packet(rays_[i], context, found);
        for (int lane = 0; lane < 8; ++lane) depth[pixel(i, lane)] = found[lane];
      }
    });
  }

 private:
  // The camera's rays in packets of eight, in the order of the tiles.
  void make_rays(const glm::dvec3& origin) {
    const RayGenerator generator(camera_);
    rays_.resize(static_cast<std::size_t>(camera_.width) * camera_.height / 8);
    for (std::size_t i = 0; i < rays_.size(); ++i) {
      RTCRay8& r = rays_[i];
      for (int lane = 0; lane < 8; ++lane) {
        const std::size_t p = pixel(i, lane);
        const auto x = static_cast<double>(p % camera_.width);
        const auto y = static_cast<double>(p / camera_.width);
        const Ray ray = generator.ray(x + 0.5, y + 0.5);
        r.org_x[lane] = static_cast<float>(ray.origin.x - origin.x);
        r.org_y[lane] = static_cast<float>(ray.origin.y - origin.y);
        r.org_z[lane] = static_cast<float>(ray.origin.z - origin.z);
        r.dir_x[lane] = static_cast<float>(ray.direction.x);
        r.dir_y[lane] = static_cast<float>(ray.direction.y);
        r.dir_z[lane] = static_cast<float>(ray.direction.z);
        r.tnear[lane] = 0;
        r.tfar[lane] = kInfinity;
        r.time[lane] = 0;
        r.mask[lane] = ~0U;
        r.id[lane] = 0;
        r.flags[lane] = 0;
      }
    }
  }

  [[nodiscard]] std::size_t pixel(std::size_t packet, int lane) const {
    const std::size_t across = static_cast<std::size_t>(camera_.width) / kTileX;
    const std::size_t x = packet % across * kTileX + lane % kTileX;
    const std::size_t y = packet / across * kTileY + lane / kTileX;
    return y * camera_.width + x;
  }

  void intersect_packet(const RTCRay8& rays, RTCIntersectContext& context, float* found) const {
    alignas(32) static const int kValid[8] = {-1, -1, -1, -1, -1, -1, -1, -1};
    RTCRayHit8 query;
    query.ray = rays;
    std::fill_n(query.hit.geomID, 8, RTC_INVALID_GEOMETRY_ID);
    std::fill_n(query.hit.instID[0], 8, RTC_INVALID_GEOMETRY_ID);
    rtcIntersect8(kValid, scene_, &context, &query);
    std::copy_n(query.ray.tfar, 8, found);
  }

  void intersect_single(const RTCRay8& rays, RTCIntersectContext& context, float* found) const {
    for (int lane = 0; lane < 8; ++lane) {
      RTCRayHit query;
      query.ray = rtcGetRayFromRayN(reinterpret_cast<RTCRayN*>(const_cast<RTCRay8*>(&rays)), 8,
                                    static_cast<unsigned>(lane));
      query.hit.geomID = RTC_INVALID_GEOMETRY_ID;
      query.hit.instID[0] = RTC_INVALID_GEOMETRY_ID;
      rtcIntersect1(scene_, &context, &query);
      found[lane] = query.ray.tfar;
    }
  }

  int packet_;
  Camera camera_;
  RTCDevice device_;
  RTCScene scene_;
  std::vector<RTCRay8> rays_;
};

}  // namespace

std::unique_ptr<Peer> embree_peer(const TriangleSoup& soup, const Camera& camera, int width) {
  return std::make_unique<Embree>(soup, camera, width);
}

}  // namespace sdfgrid::bench

#else

namespace sdfgrid::bench {

std::unique_ptr<Peer> embree_peer(const TriangleSoup&, const Camera&, int) { return nullptr; }

}  // namespace sdfgrid::bench

#endif
