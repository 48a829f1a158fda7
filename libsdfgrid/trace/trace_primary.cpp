#include <algorithm>
#include <limits>

#include "sdfgrid/core/parallel.h"
#include "sdfgrid/trace/trace.h"
#include "sdfgrid/trace/walk.h"

namespace sdfgrid {

HitBuffer trace_primary(const Atlas& atlas, const Camera& camera, const Job& job) {
  const RayGenerator rays(camera);
  HitBuffer hits;
  hits.width = camera.width;
  hits.height = camera.height;
  const auto pixels = static_cast<std::size_t>(camera.width) * camera.height;
  hits.depth.assign(pixels, std::numeric_limits<float>::infinity());
  hits.steps.assign(pixels, 0);
  const auto width = static_cast<std::size_t>(camera.width);
  parallel_for(pixels, 1024, job, [&](std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i) {
      const Ray ray = rays.ray(double(i % width) + 0.5, double(i / width) + 0.5);
      const Walk walk = walk_ray(atlas, ray, 0, std::numeric_limits<double>::infinity());
      if (walk.hit) hits.depth[i] = static_cast<float>(walk.t * atlas.lattice.voxel);
      hits.steps[i] = static_cast<std::uint16_t>(std::min(walk.steps, 65535));
    }
  });
  return hits;
}

}  // namespace sdfgrid
