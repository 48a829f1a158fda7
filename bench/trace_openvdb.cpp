#include <openvdb/openvdb.h>
#include <openvdb/tools/RayIntersector.h>

#include <limits>

#include "sdfgrid/core/parallel.h"
#include "sdfgrid/grid/vdb.h"
#include "trace_peers.h"

namespace sdfgrid::bench {
namespace {

using Intersector = openvdb::tools::LevelSetRayIntersector<openvdb::FloatGrid>;

class OpenVdb : public Peer {
 public:
  OpenVdb(const Grid& grid, const Camera& camera) : vdb_(vdb(grid)), intersector_(*vdb_) {
    const RayGenerator generator(camera);
    for (int y = 0; y < camera.height; ++y) {
      for (int x = 0; x < camera.width; ++x) {
        const Ray ray = generator.ray(x + 0.5, y + 0.5);
        rays_.emplace_back(openvdb::Vec3d(ray.origin.x, ray.origin.y, ray.origin.z),
                           openvdb::Vec3d(ray.direction.x, ray.direction.y, ray.direction.z));
      }
    }
  }

  [[nodiscard]] std::string name() const override { return "OpenVDB LevelSetRayIntersector"; }

  void trace(std::vector<float>& depth) const override {
    depth.assign(rays_.size(), std::numeric_limits<float>::infinity());
    parallel_for(rays_.size(), 1024, Job(), [&](std::size_t begin, std::size_t end) {
      const Intersector own(intersector_);  // its accessor is not for sharing
      for (std::size_t i = begin; i < end; ++i) {
        openvdb::Vec3d point;
        if (own.intersectsWS(rays_[i], point)) {
          depth[i] = static_cast<float>((point - rays_[i].eye()).length());
        }
      }
    });
  }

 private:
  openvdb::FloatGrid::Ptr vdb_;
  Intersector intersector_;
  std::vector<Intersector::RayType> rays_;
};

}  // namespace

std::unique_ptr<Peer> openvdb_peer(const Grid& grid, const Camera& camera) {
  return std::make_unique<OpenVdb>(grid, camera);
}

}  // namespace sdfgrid::bench
