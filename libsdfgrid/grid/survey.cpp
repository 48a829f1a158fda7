#include "sdfgrid/grid/survey.h"

#include <algorithm>
#include <cmath>
#include <glm/geometric.hpp>
#include <map>
#include <optional>
#include <utility>
#include <vector>

#include "sdfgrid/core/parallel.h"
#include "sdfgrid/grid/compare_claims.h"
#include "sdfgrid/grid/compare_summary.h"
#include "sdfgrid/grid/compare_truth.h"
#include "sdfgrid/mesh/diagnose.h"
#include "sdfgrid/mesh/orient.h"
#include "sdfgrid/mesh/reference.h"

namespace sdfgrid {
namespace {

constexpr double kEdgeReach = 1;   // voxels
constexpr double kMedialJump = 3;  // voxels
constexpr std::size_t kRun = 512;  // samples that share what they learn of the surface

glm::dvec3 normal_of(const TriangleSoup& soup, const glm::uvec3& t) {
  const glm::dvec3 a = soup.local(t.x);
  const glm::dvec3 n = glm::cross(soup.local(t.y) - a, soup.local(t.z) - a);
  const double length = glm::length(n);
  return length > 0 ? n / length : glm::dvec3(0.0);
}

// The edges whose faces meet at 30 degrees or more, and those of one or of many faces, as a mesh of
// triangles that are segments.
TriangleSoup edges_of(const TriangleSoup& soup) {
  struct Edge {
    std::uint32_t a, b, triangle;
  };
  std::vector<Edge> edges;
  edges.reserve(3 * soup.triangles.size());
  for (std::uint32_t n = 0; n < soup.triangles.size(); ++n) {
    const glm::uvec3& t = soup.triangles[n];
    for (int k = 0; k < 3; ++k) {
      const auto [a, b] = std::minmax(t[k], t[(k + 1) % 3]);
      edges.push_back({a, b, n});
    }
  }
  const auto key = [](const Edge& e) { return std::pair(e.a, e.b); };
  std::sort(edges.begin(), edges.end(), [&](const Edge& x, const Edge& y) {
    return std::tuple(x.a, x.b, x.triangle) < std::tuple(y.a, y.b, y.triangle);
  });
  TriangleSoup result;
  result.points = soup.points;
  result.origin = soup.origin;
  const double kFlat = std::cos(std::acos(-1.0) / 6);
  for (std::size_t first = 0; first < edges.size();) {
    std::size_t last = first;
    while (last < edges.size() && key(edges[last]) == key(edges[first])) ++last;
    const bool flat = last - first == 2 &&
                      glm::dot(normal_of(soup, soup.triangles[edges[first].triangle]),
                               normal_of(soup, soup.triangles[edges[first + 1].triangle])) > kFlat;
    if (!flat) result.triangles.emplace_back(edges[first].a, edges[first].b, edges[first].b);
    first = last;
  }
  return result;
}

}  // namespace

struct SurfaceTruth::Data {
  ReferenceDistance surface;
  std::optional<ReferenceDistance> edges;
};

SurfaceTruth::SurfaceTruth(const TriangleSoup& mesh, const Job& job) {
  TriangleSoup turned = mesh;
  (void)orient_mesh(turned);  // `convert` says what was turned
  job.checkpoint();
  const TriangleSoup edges = edges_of(turned);
  auto data = std::make_shared<Data>(Data{ReferenceDistance(turned), std::nullopt});
  if (!edges.triangles.empty()) data->edges.emplace(edges);
  data_ = std::move(data);
}

namespace {

FieldPart part_of(const SurfaceTruth::Data& truth, const glm::dvec3& world,
                  const glm::dvec3& nearest, double voxel) {
  if (truth.edges && truth.edges->distance(nearest) <= kEdgeReach * voxel) return FieldPart::edge;
  for (int a = 0; a < 3; ++a) {
    for (const double side : {-voxel, voxel}) {
      glm::dvec3 beside = world;
      beside[a] += side;
      const glm::dvec3 other = truth.surface.closest(beside, nearest);
      if (glm::distance(other, nearest) > kMedialJump * voxel) return FieldPart::medial;
    }
  }
  return FieldPart::smooth;
}

struct VoxelErrors {
  std::vector<SampleError> errors;
  std::vector<FieldPart> parts;
};

VoxelErrors measure_voxels(const GridClaims& grid, const SurfaceTruth::Data& truth,
                           const CompareOptions& options, const Job& job) {
  const std::size_t count = std::min(options.samples, grid.active_voxels());
  VoxelErrors result{std::vector<SampleError>(count), std::vector<FieldPart>(count)};
  parallel_for(count, kRun, job, [&](std::size_t begin, std::size_t end) {
    MeshTruth mesh(truth.surface, grid.is_signed());
    for (std::size_t i = begin; i < end; ++i) {
      const Claim claim = grid.at_voxel(i, count, options.seed);
      result.errors[i] = judge(claim, mesh.at(claim.world, kVoxelDoubt * grid.voxel()));
      result.parts[i] = part_of(truth, claim.world, mesh.nearest(), grid.voxel());
    }
    job.report("measure voxels", static_cast<double>(end) / static_cast<double>(count));
  });
  return result;
}

std::vector<SampleError> measure_between(const GridClaims& grid, const SurfaceTruth::Data& truth,
                                         const CompareOptions& options, const Job& job) {
  std::vector<SampleError> errors(options.samples);
  parallel_for(errors.size(), kRun, job, [&](std::size_t begin, std::size_t end) {
    MeshTruth mesh(truth.surface, grid.is_signed());
    for (std::size_t i = begin; i < end; ++i) {
      const auto claim = grid.in_cell(i, errors.size(), options.seed + 1);
      if (!claim) continue;
      errors[i] = judge(*claim, mesh.at(claim->world, kInterpolatedDoubt * grid.voxel()));
    }
    job.report("measure cells", static_cast<double>(end) / static_cast<double>(errors.size()));
  });
  return errors;
}

}  // namespace

Survey survey(const Grid& grid, const SurfaceTruth& truth, const CompareOptions& options,
              const Job& job) {
  const GridClaims claims(grid);
  Survey result;
  result.voxel = claims.voxel();
  result.between = summarize(measure_between(claims, truth.data(), options, job));
  const VoxelErrors voxels = measure_voxels(claims, truth.data(), options, job);
  result.voxels = summarize(voxels.errors);
  for (std::size_t part = 0; part < result.parts.size(); ++part) {
    std::vector<SampleError> of_part;
    for (std::size_t i = 0; i < voxels.errors.size(); ++i) {
      if (static_cast<std::size_t>(voxels.parts[i]) == part) of_part.push_back(voxels.errors[i]);
    }
    result.parts[part] = summarize(of_part);
  }
  return result;
}

}  // namespace sdfgrid
