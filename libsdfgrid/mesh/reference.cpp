#include "sdfgrid/mesh/reference.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <glm/geometric.hpp>
#include <limits>
#include <numbers>
#include <numeric>
#include <optional>
#include <tuple>

#include "sdfgrid/core/error.h"

namespace sdfgrid {
namespace {

using glm::dvec3;
using reference::Corners;
using reference::RayFrame;

constexpr double kInfinity = std::numeric_limits<double>::infinity();

std::vector<Corners> checked_corners(const TriangleSoup& soup) {
  if (soup.triangles.empty()) throw Error(ErrorKind::input, "the mesh has no triangles");
  std::vector<Corners> corners;
  corners.reserve(soup.triangles.size());
  for (const glm::uvec3& t : soup.triangles) {
    for (int k = 0; k < 3; ++k) {
      if (t[k] >= soup.points.size()) {
        throw Error(ErrorKind::input, "a triangle names a point that the mesh does not have");
      }
      const dvec3 p = soup.local(t[k]);
      if (!std::isfinite(p.x) || !std::isfinite(p.y) || !std::isfinite(p.z)) {
        throw Error(ErrorKind::input, "the mesh has a coordinate that is not finite");
      }
    }
    corners.push_back({soup.local(t.x), soup.local(t.y), soup.local(t.z)});
  }
  return corners;
}

// For each point the first point (in lexicographic order of index) at the same place.
std::vector<std::uint32_t> weld(const std::vector<glm::vec3>& points) {
  std::vector<std::uint32_t> order(points.size());
  std::iota(order.begin(), order.end(), 0U);
  const auto place = [&](std::uint32_t i) {
    return std::tuple(points[i].x, points[i].y, points[i].z);
  };
  std::sort(order.begin(), order.end(), [&](std::uint32_t l, std::uint32_t r) {
    return std::tuple_cat(place(l), std::tuple(l)) < std::tuple_cat(place(r), std::tuple(r));
  });
  std::vector<std::uint32_t> same(points.size());
  for (std::size_t i = 0; i < order.size(); ++i) {
    const bool repeats = i > 0 && place(order[i]) == place(order[i - 1]);
    same[order[i]] = repeats ? same[order[i - 1]] : order[i];
  }
  return same;
}

// A use of an edge by a triangle, with its ends in order, so that uses of one edge sort together.
struct EdgeUse {
  std::uint32_t low, high;
  bool forward;  // the triangle runs from low to high
};

// The uses that are left when every one has been struck out against one in the other direction.
std::vector<EdgeUse> border_of(const TriangleSoup& soup) {
  const std::vector<std::uint32_t> same = weld(soup.points);
  std::vector<EdgeUse> uses;
  uses.reserve(3 * soup.triangles.size());
  for (const glm::uvec3& t : soup.triangles) {
    for (int k = 0; k < 3; ++k) {
      const std::uint32_t from = same[t[k]];
      const std::uint32_t to = same[t[(k + 1) % 3]];
      if (from != to) uses.push_back({std::min(from, to), std::max(from, to), from < to});
    }
  }
  std::sort(uses.begin(), uses.end(), [](const EdgeUse& l, const EdgeUse& r) {
    return std::tie(l.low, l.high) < std::tie(r.low, r.high);
  });
  std::vector<EdgeUse> border;
  for (std::size_t i = 0; i < uses.size();) {
    EdgeUse edge = uses[i];
    int net = 0;
    for (; i < uses.size() && uses[i].low == edge.low && uses[i].high == edge.high; ++i) {
      net += uses[i].forward ? 1 : -1;
    }
    edge.forward = net > 0;
    border.insert(border.end(), static_cast<std::size_t>(std::abs(net)), edge);
  }
  return border;
}

// A sum of angles in (-pi, pi], kept as a complex number's argument and the turns that it has lost,
// so that a million terms cost multiplications and a single arc tangent.
class AngleSum {
 public:
  // The angle of (cosine, sine), of any length up to 8. A term without direction (the point lies on
  // a corner) has no angle and is left out.
  void add(double cosine, double sine) {
    if (cosine == 0 && sine == 0) return;
    const double x = cosine_ * cosine - sine_ * sine;
    const double y = cosine_ * sine + sine_ * cosine;
    if (positive(cosine_, sine_) && positive(cosine, sine) && !positive(x, y)) ++turns_;
    if (sine_ < 0 && sine < 0 && y >= 0) --turns_;
    cosine_ = x;
    sine_ = y;
    const double length = std::abs(x) + std::abs(y);
    if (length < 1e-100 || length > 1e100) {
      cosine_ /= length;
      sine_ /= length;
    }
  }
  [[nodiscard]] double turns() const {
    return turns_ + std::atan2(sine_, cosine_) / (2 * std::numbers::pi);
  }

 private:
  // Whether the angle is in (0, pi]: two such sum to (0, 2 pi], which is past pi if not positive.
  static bool positive(double cosine, double sine) { return sine > 0 || (sine == 0 && cosine < 0); }

  double cosine_ = 1;
  double sine_ = 0;
  int turns_ = 0;
};

// Adds half of the solid angle of the triangle that directions a, b, c (unit vectors) span: van
// Oosterom and Strackee 1983, The solid angle of a plane triangle. Positive where they run
// counter-clockwise seen from outside the sphere.
void add_half_solid_angle(const dvec3& a, const dvec3& b, const dvec3& c, AngleSum& sum) {
  sum.add(1 + glm::dot(a, b) + glm::dot(b, c) + glm::dot(c, a), glm::dot(a, glm::cross(b, c)));
}

dvec3 unit(const dvec3& v) {
  const double length = glm::length(v);
  return length > 0 ? v / length : v;
}

RayFrame make_frame(const dvec3& direction) {
  RayFrame frame;
  frame.along = glm::normalize(direction);
  frame.across = glm::normalize(glm::cross(frame.along, dvec3(frame.along.z, frame.along.x, 1.5)));
  frame.aside = glm::cross(frame.along, frame.across);
  return frame;
}

// Directions near the axes, for short ways out, but along no plane that a modeller would choose.
std::array<RayFrame, 12> make_frames() {
  std::array<RayFrame, 12> frames;
  const std::array<dvec3, 2> tilted{dvec3(1, 0.0917231, 0.1412473),
                                    dvec3(1, -0.1873151, 0.0639287)};
  for (int k = 0; k < 12; ++k) {
    const dvec3& t = tilted[k / 6];
    const dvec3 turned = k % 3 == 0 ? t : k % 3 == 1 ? dvec3(t.z, t.x, t.y) : dvec3(t.y, t.z, t.x);
    frames[k] = make_frame(k / 3 % 2 == 0 ? turned : -turned);
  }
  return frames;
}

// The first of the frames whose ray is soonest out of the box.
std::size_t shortest_way_out(const Box& box, const dvec3& p,
                             const std::array<RayFrame, 12>& frames) {
  std::size_t best = 0;
  double shortest = kInfinity;
  for (std::size_t k = 0; k < frames.size(); ++k) {
    const dvec3& along = frames[k].along;
    double way = kInfinity;
    for (int a = 0; a < 3; ++a) {
      way = std::min(way, ((along[a] > 0 ? box.hi[a] : box.lo[a]) - p[a]) / along[a]);
    }
    if (way < shortest) {
      shortest = way;
      best = k;
    }
  }
  return best;
}

}  // namespace

ReferenceDistance::ReferenceDistance(const TriangleSoup& soup)
    : origin_(soup.origin), tree_(checked_corners(soup)) {
  constexpr std::uint32_t kUnused = 0xffffffffU;
  std::vector<std::uint32_t> number(soup.points.size(), kUnused);
  const auto renumber = [&](std::uint32_t i) {
    if (number[i] == kUnused) {
      number[i] = static_cast<std::uint32_t>(border_points_.size());
      border_points_.push_back(soup.local(i));
    }
    return number[i];
  };
  for (const EdgeUse& edge : border_of(soup)) {
    const std::uint32_t low = renumber(edge.low);
    const std::uint32_t high = renumber(edge.high);
    border_.push_back(edge.forward ? Edge{low, high} : Edge{high, low});
  }
}

glm::dvec3 ReferenceDistance::closest(const glm::dvec3& world) const {
  return origin_ + tree_.nearest(world - origin_, kInfinity).point;
}

glm::dvec3 ReferenceDistance::closest(const glm::dvec3& world, const glm::dvec3& known) const {
  const dvec3 way = known - world;
  constexpr double kRoom = 1 + 1e-9;  // `known` is rounded to world coordinates
  const auto nearest = tree_.nearest(world - origin_, kRoom * glm::dot(way, way));
  return std::isfinite(nearest.squared) ? origin_ + nearest.point : closest(world);
}

double ReferenceDistance::distance(const glm::dvec3& world) const {
  return std::sqrt(tree_.nearest(world - origin_, kInfinity).squared);
}

double ReferenceDistance::signed_distance(const glm::dvec3& world) const {
  const double d = distance(world);
  return d > 0 && winding_number(world) > 0.5 ? -d : d;
}

double ReferenceDistance::cone_winding(const glm::dvec3& p, const glm::dvec3& apex) const {
  std::vector<dvec3> seen(border_points_.size());
  for (std::size_t i = 0; i < seen.size(); ++i) seen[i] = unit(border_points_[i] - p);
  AngleSum sum;
  for (const Edge& edge : border_) add_half_solid_angle(seen[edge.from], seen[edge.to], apex, sum);
  return sum.turns();
}

double ReferenceDistance::winding_number(const glm::dvec3& world) const {
  static const std::array<RayFrame, 12> frames = make_frames();
  // A border as long as that, and the sum over the triangles is the shorter one.
  if (border_.size() > tree_.triangles().size()) return winding_number_by_sum(world);
  const dvec3 p = world - origin_;
  const std::size_t first = shortest_way_out(tree_.bounds(), p, frames);
  for (std::size_t k = 0; k < frames.size(); ++k) {
    const RayFrame& frame = frames[(first + k) % frames.size()];
    const std::optional<int> crossings = tree_.crossings(p, frame);
    if (!crossings) continue;
    return border_.empty() ? *crossings : *crossings + cone_winding(p, -frame.along);
  }
  return winding_number_by_sum(world);  // on the surface, or all but
}

double ReferenceDistance::winding_number_by_sum(const glm::dvec3& world) const {
  const dvec3 p = world - origin_;
  AngleSum sum;
  for (const Corners& t : tree_.triangles()) {
    add_half_solid_angle(unit(t.a - p), unit(t.b - p), unit(t.c - p), sum);
  }
  return sum.turns();
}

}  // namespace sdfgrid
