// Mesh against mesh; declared in compare.h.
#include <algorithm>
#include <cmath>
#include <glm/geometric.hpp>
#include <optional>

#include "sdfgrid/core/parallel.h"
#include "sdfgrid/grid/compare.h"
#include "sdfgrid/grid/compare_claims.h"
#include "sdfgrid/grid/compare_summary.h"
#include "sdfgrid/mesh/reference.h"

namespace sdfgrid {
namespace {

// Points spread evenly over a surface's area, in the order of its triangles.
class SurfacePoints {
 public:
  explicit SurfacePoints(const TriangleSoup& soup) : soup_(soup) {
    double sum = 0;
    for (const glm::uvec3& t : soup.triangles) {
      const glm::dvec3 a = soup.local(t.x);
      sum += glm::length(glm::cross(soup.local(t.y) - a, soup.local(t.z) - a));
      area_up_to_.push_back(sum);
    }
  }

  // Point i of `count`, world units.
  [[nodiscard]] glm::dvec3 at(std::size_t i, std::size_t count, std::uint64_t seed) const {
    CounterRandom random(seed, i);
    const double area =
        area_up_to_.back() * (static_cast<double>(i) + random.unit()) / static_cast<double>(count);
    const auto above = std::upper_bound(area_up_to_.begin(), area_up_to_.end() - 1, area);
    const glm::uvec3& t = soup_.triangles[static_cast<std::size_t>(above - area_up_to_.begin())];
    const double root = std::sqrt(random.unit());
    const double along = random.unit();
    const glm::dvec3 local = (1 - root) * soup_.local(t.x) +
                             root * ((1 - along) * soup_.local(t.y) + along * soup_.local(t.z));
    return soup_.origin + local;
  }

 private:
  const TriangleSoup& soup_;
  std::vector<double> area_up_to_;
};

ErrorSummary one_way(const TriangleSoup& from, const ReferenceDistance& to,
                     const CompareOptions& options, const Job& job) {
  const SurfacePoints points(from);
  std::vector<SampleError> errors(std::max<std::size_t>(options.samples, 1));
  parallel_for("compare", errors.size(), 512, job, [&](std::size_t begin, std::size_t end) {
    std::optional<glm::dvec3> known;
    for (std::size_t i = begin; i < end; ++i) {
      const glm::dvec3 p = points.at(i, errors.size(), options.seed);
      known = known ? to.closest(p, *known) : to.closest(p);
      errors[i] = {true, false, glm::length(*known - p), p};
    }
  });
  return summarize(errors);
}

}  // namespace

SurfaceComparison compare(const TriangleSoup& a, const TriangleSoup& b,
                          const CompareOptions& options, const Job& job) {
  // Built first: they refuse what is no mesh.
  const ReferenceDistance to_a(a);
  const ReferenceDistance to_b(b);
  return {one_way(a, to_b, options, job), one_way(b, to_a, options, job)};
}

}  // namespace sdfgrid
