#include "sdfgrid/grid/peers.h"

#include <openvdb/tools/FastSweeping.h>
#include <openvdb/tools/MeshToVolume.h>

#include <algorithm>
#include <cmath>
#include <vector>

#include "sdfgrid/grid/vdb.h"

namespace sdfgrid {

Conversion convert_by_openvdb(const TriangleSoup& soup, const ConvertOptions& options,
                              const Job& job) {
  openvdb::initialize();
  job.checkpoint();
  const Lattice lattice = choose_lattice(soup, options);
  const auto transform = openvdb::math::Transform::createLinearTransform(lattice.voxel);
  transform->postTranslate({lattice.origin.x, lattice.origin.y, lattice.origin.z});
  std::vector<openvdb::Vec3s> points;
  points.reserve(soup.points.size());
  for (std::uint32_t i = 0; i < soup.points.size(); ++i) {
    const glm::dvec3 p = lattice.to_index(soup.origin + soup.local(i));
    points.emplace_back(static_cast<float>(p.x), static_cast<float>(p.y), static_cast<float>(p.z));
  }
  std::vector<openvdb::Vec3I> triangles;
  triangles.reserve(soup.triangles.size());
  for (const glm::uvec3& t : soup.triangles) triangles.emplace_back(t.x, t.y, t.z);
  const openvdb::tools::QuadAndTriangleDataAdapter<openvdb::Vec3s, openvdb::Vec3I> mesh(points,
                                                                                        triangles);
  const auto grid = openvdb::tools::meshToVolume<openvdb::FloatGrid>(
      mesh, *transform, static_cast<float>(options.band.exwidth),
      static_cast<float>(options.band.inwidth));
  grid->setName("surface");
  job.checkpoint();
  Conversion result;
  result.grid = from_vdb(grid);
  result.sign = SignMethod::automatic;
  result.sign_reason = "OpenVDB's flood";
  return result;
}

Conversion convert_by_sweeping(const TriangleSoup& soup, const ConvertOptions& options,
                               const Job& job) {
  ConvertOptions seeds = options;
  constexpr double kSeeds = 1;
  seeds.band = {kSeeds, kSeeds};
  Conversion result = convert_mesh(soup, seeds, job);
  const double width = std::max(options.band.exwidth, options.band.inwidth);
  const auto swept =
      openvdb::tools::dilateSdf(*vdb(result.grid), static_cast<int>(std::ceil(width - kSeeds)));
  swept->setName("surface");
  job.checkpoint();
  result.grid = from_vdb(swept);
  return result;
}

}  // namespace sdfgrid
