#include "sdfgrid/mesh/piercing.h"

#include <algorithm>
#include <cmath>
#include <glm/geometric.hpp>

namespace sdfgrid {
namespace {

struct Flat {
  double y, z;
};

// Whether (y, z) lies on the +y side of the edge a-b where the edge spans z; both triangles of an
// edge compute this from the same end, so they agree whatever is rounded.
bool beyond(Flat a, Flat b, double y, double z) {
  if (b.z < a.z || (b.z == a.z && b.y < a.y)) std::swap(a, b);
  return (b.y - a.y) * (z - a.z) < (y - a.y) * (b.z - a.z);
}

bool spans(const Flat& a, const Flat& b, double z) { return (a.z > z) != (b.z > z); }

}  // namespace

Piercing::Piercing(const TriangleSoup& soup) : soup_(soup) {
  const Box box = bounds(soup);
  if (!box.empty()) {
    lo_ = {box.lo.y - soup.origin.y, box.lo.z - soup.origin.z};
    size_ = {box.size().y, box.size().z};
  }
  // A bin a triangle, fewer if triangles are so long that each would be in many.
  const std::size_t most = 16 * soup.triangles.size() + 16;
  int cells = static_cast<int>(std::sqrt(static_cast<double>(soup.triangles.size()))) + 1;
  set_resolution(std::min(cells, 2048));
  while (cells_ > 1 && count_entries() > most) set_resolution(cells_ / 2);

  first_.assign(static_cast<std::size_t>(cells_) * cells_ + 1, 0);
  const auto for_each = [&](auto visit) {
    for (std::uint32_t t = 0; t < soup.triangles.size(); ++t) {
      const Span s = span(soup.triangles[t]);
      for (int j = s.lo.y; j <= s.hi.y; ++j) {
        for (int i = s.lo.x; i <= s.hi.x; ++i) {
          visit(static_cast<std::size_t>(j) * cells_ + i, t);
        }
      }
    }
  };
  for_each([&](std::size_t bin, std::uint32_t) { ++first_[bin + 1]; });
  for (std::size_t b = 1; b < first_.size(); ++b) first_[b] += first_[b - 1];
  triangles_.resize(first_.back());
  std::vector<std::size_t> next(first_.begin(), first_.end() - 1);
  for_each([&](std::size_t bin, std::uint32_t t) { triangles_[next[bin]++] = t; });
}

void Piercing::set_resolution(int cells) {
  cells_ = cells;
  for (int a = 0; a < 2; ++a) scale_[a] = size_[a] > 0.0 ? cells / size_[a] : 0.0;
}

Piercing::Span Piercing::span(const glm::uvec3& t) const {
  glm::dvec2 lo(1e300);
  glm::dvec2 hi(-1e300);
  for (int k = 0; k < 3; ++k) {
    const glm::dvec3 p = soup_.local(t[k]);
    lo = {std::min(lo.x, p.y), std::min(lo.y, p.z)};
    hi = {std::max(hi.x, p.y), std::max(hi.y, p.z)};
  }
  Span s;
  for (int a = 0; a < 2; ++a) {
    s.lo[a] = std::clamp(static_cast<int>((lo[a] - lo_[a]) * scale_[a]), 0, cells_ - 1);
    s.hi[a] = std::clamp(static_cast<int>((hi[a] - lo_[a]) * scale_[a]), 0, cells_ - 1);
  }
  return s;
}

std::size_t Piercing::count_entries() const {
  std::size_t entries = 0;
  for (const glm::uvec3& t : soup_.triangles) {
    const Span s = span(t);
    entries += static_cast<std::size_t>(s.hi.x - s.lo.x + 1) * (s.hi.y - s.lo.y + 1);
  }
  return entries;
}

std::size_t Piercing::bin_of(double y, double z) const {
  const glm::dvec2 at = (glm::dvec2(y, z) - lo_) * scale_;
  if (!(at.x >= 0.0 && at.y >= 0.0 && at.x <= cells_ && at.y <= cells_)) return kNowhere;
  const int i = std::min(static_cast<int>(at.x), cells_ - 1);
  const int j = std::min(static_cast<int>(at.y), cells_ - 1);
  return static_cast<std::size_t>(j) * cells_ + i;
}

int Piercing::pierce(std::uint32_t t, double y, double z, double& x) const {
  const glm::uvec3& corner = soup_.triangles[t];
  const glm::dvec3 p[3] = {soup_.local(corner.x), soup_.local(corner.y), soup_.local(corner.z)};
  // The point is in the flattened triangle if an odd number of edges lie beyond it along y; the
  // edge that lies there also tells which way the triangle runs round the point.
  int winding = 0;
  for (int k = 0; k < 3; ++k) {
    const Flat a{p[k].y, p[k].z};
    const Flat b{p[(k + 1) % 3].y, p[(k + 1) % 3].z};
    if (spans(a, b, z) && !beyond(a, b, y, z)) winding += b.z > a.z ? 1 : -1;
  }
  if (winding == 0) return 0;
  const glm::dvec3 normal = glm::cross(p[1] - p[0], p[2] - p[0]);
  x = normal.x != 0.0 ? p[0].x - (normal.y * (y - p[0].y) + normal.z * (z - p[0].z)) / normal.x
                      : p[0].x;
  return -winding;
}

}  // namespace sdfgrid
