#include "sdfgrid/volume/isosurface_cell.h"

#include <cmath>
#include <glm/common.hpp>
#include <glm/geometric.hpp>

namespace sdfgrid::cell {
namespace {

struct Jet {
  double value;
  glm::dvec3 gradient;
};

Jet trilinear(const Values& v, const glm::dvec3& p) {
  const auto along_x = [&](int c) { return v[c] + p.x * (double(v[c + 1]) - v[c]); };
  const auto slope_x = [&](int c) { return double(v[c + 1]) - v[c]; };
  const double y0 = along_x(0) + p.y * (along_x(2) - along_x(0));
  const double y1 = along_x(4) + p.y * (along_x(6) - along_x(4));
  const double dx0 = slope_x(0) + p.y * (slope_x(2) - slope_x(0));
  const double dx1 = slope_x(4) + p.y * (slope_x(6) - slope_x(4));
  const double dy0 = along_x(2) - along_x(0);
  const double dy1 = along_x(6) - along_x(4);
  return {y0 + p.z * (y1 - y0), {dx0 + p.z * (dx1 - dx0), dy0 + p.z * (dy1 - dy0), y1 - y0}};
}

}  // namespace

glm::dvec3 pull_to_surface(const Values& values, const glm::dvec3& p) {
  constexpr int kSteps = 8;
  constexpr double kBeyond = -1e29;  // the border around the volume
  for (const float value : values) {
    if (value < kBeyond) return p;
  }
  glm::dvec3 q = p;
  for (int step = 0; step < kSteps; ++step) {
    const Jet jet = trilinear(values, q);
    const double slope = glm::dot(jet.gradient, jet.gradient);
    if (!(slope > 0)) return p;
    const glm::dvec3 move = jet.value / slope * jet.gradient;
    q -= move;
    if (glm::any(glm::lessThan(q, glm::dvec3(0))) || glm::any(glm::greaterThan(q, glm::dvec3(1)))) {
      return p;
    }
    if (glm::dot(move, move) < 1e-16) return q;
  }
  return q;
}

}  // namespace sdfgrid::cell
