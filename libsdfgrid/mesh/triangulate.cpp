#include "sdfgrid/mesh/triangulate.h"

#include <cmath>
#include <glm/geometric.hpp>
#include <glm/vec2.hpp>
#include <vector>

namespace sdfgrid {
namespace {

double cross(const glm::dvec2& a, const glm::dvec2& b) { return a.x * b.y - a.y * b.x; }

double turn(const glm::dvec2& a, const glm::dvec2& b, const glm::dvec2& c) {
  return cross(b - a, c - b);
}

// The corners in the plane of the polygon's area vector, counter-clockwise, relative to the first.
std::vector<glm::dvec2> flatten(std::span<const glm::dvec3> points,
                                std::span<const std::uint32_t> polygon) {
  const glm::dvec3 base = points[polygon[0]];
  glm::dvec3 area(0.0);
  for (std::size_t i = 1; i + 1 < polygon.size(); ++i) {
    area += glm::cross(points[polygon[i]] - base, points[polygon[i + 1]] - base);
  }
  const double length = glm::length(area);
  if (!(length > 0.0)) return {};
  const glm::dvec3 normal = area / length;
  const glm::dvec3 away =
      std::abs(normal.x) < 0.6 ? glm::dvec3(1.0, 0.0, 0.0) : glm::dvec3(0.0, 1.0, 0.0);
  const glm::dvec3 u = glm::normalize(glm::cross(away, normal));
  const glm::dvec3 v = glm::cross(normal, u);
  std::vector<glm::dvec2> flat;
  flat.reserve(polygon.size());
  for (const std::uint32_t corner : polygon) {
    const glm::dvec3 p = points[corner] - base;
    flat.emplace_back(glm::dot(p, u), glm::dot(p, v));
  }
  return flat;
}

// Every turn to the left, and one turn in all: no star.
bool is_convex(const std::vector<glm::dvec2>& p) {
  const std::size_t n = p.size();
  int rises = 0;  // changes of direction in v from down to up
  double before = p[n - 1].y - p[n - 2].y;
  for (std::size_t i = 0; i < n; ++i) {
    const glm::dvec2& a = p[i];
    const glm::dvec2& b = p[(i + 1) % n];
    if (turn(a, b, p[(i + 2) % n]) < 0.0) return false;
    const double rise = a.y - p[(i + n - 1) % n].y;
    if (rise != 0.0) {
      if (before < 0.0 && rise > 0.0) ++rises;
      before = rise;
    }
  }
  return rises <= 1;
}

class EarCutter {
 public:
  explicit EarCutter(std::vector<glm::dvec2> flat) : p_(std::move(flat)) {
    const std::size_t n = p_.size();
    next_.resize(n);
    previous_.resize(n);
    for (std::size_t i = 0; i < n; ++i) {
      next_[i] = (i + 1) % n;
      previous_[i] = (i + n - 1) % n;
    }
  }

  // Calls emit with positions in the polygon. A corner is looked at again whenever one beside it
  // goes; if none of those that are left is an ear, the polygon crosses itself.
  template <class Emit>
  Cut cut(Emit emit) {
    Cut result = Cut::clean;
    std::size_t at = 0;
    std::size_t failures = 0;
    for (std::size_t left = p_.size(); left > 2;) {
      const bool stuck = failures >= left;
      if (!stuck && !is_ear(at)) {
        ++failures;
        at = next_[at];
        continue;
      }
      if (stuck) result = Cut::crossing;
      emit(previous_[at], at, next_[at]);
      next_[previous_[at]] = next_[at];
      previous_[next_[at]] = previous_[at];
      at = next_[next_[at]];  // not the neighbour, so that ears come from all round
      --left;
      failures = 0;
    }
    return result;
  }

 private:
  [[nodiscard]] bool is_ear(std::size_t i) const {
    const glm::dvec2& a = p_[previous_[i]];
    const glm::dvec2& b = p_[i];
    const glm::dvec2& c = p_[next_[i]];
    const double area = turn(a, b, c);
    if (area < 0.0) return false;
    for (std::size_t k = next_[next_[i]]; k != previous_[i]; k = next_[k]) {
      const glm::dvec2& q = p_[k];
      if (q == a || q == b || q == c) continue;
      // Only a corner that turns right can poke into an ear first.
      if (turn(p_[previous_[k]], q, p_[next_[k]]) > 0.0) continue;
      if (cross(b - a, q - a) >= 0.0 && cross(c - b, q - b) >= 0.0 && cross(a - c, q - c) >= 0.0) {
        return false;
      }
    }
    return true;
  }

  std::vector<glm::dvec2> p_;
  std::vector<std::size_t> next_, previous_;
};

}  // namespace

Cut triangulate(std::span<const glm::dvec3> points, std::span<const std::uint32_t> polygon,
                const std::function<void(std::uint32_t, std::uint32_t, std::uint32_t)>& emit) {
  if (polygon.size() == 3) {
    emit(polygon[0], polygon[1], polygon[2]);
    return Cut::clean;
  }
  std::vector<glm::dvec2> flat = flatten(points, polygon);
  if (flat.empty() || is_convex(flat)) {
    for (std::size_t i = 1; i + 1 < polygon.size(); ++i) {
      emit(polygon[0], polygon[i], polygon[i + 1]);
    }
    return flat.empty() ? Cut::crossing : Cut::clean;
  }
  return EarCutter(std::move(flat)).cut([&](std::size_t a, std::size_t b, std::size_t c) {
    emit(polygon[a], polygon[b], polygon[c]);
  });
}

}  // namespace sdfgrid
