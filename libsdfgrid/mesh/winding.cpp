#include "sdfgrid/mesh/winding.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <stdexcept>

#include "sdfgrid/core/isa.h"
#include "sdfgrid/mesh/winding_boundary.h"
#include "sdfgrid/mesh/winding_tree.h"

namespace sdfgrid {
namespace {

// What one expansion keeps to. Bounds are pessimistic and errors of neighbours cancel: with these,
// the sum over a query's expansions was at most 0.0015 on meshes of one surface. More relative
// accuracy costs more leaves: 0.05 instead of 0.1 opens a third more.
constexpr winding::Accuracy kAccuracy = {1e-3, 0.1};

// How finely the boundary is taken apart at most: more makes the gradient's bound hardly lower.
constexpr double kFinestOpening = 0.4;

}  // namespace

struct WindingNumber::Parts {
  winding::Tree tree;
  winding::Boundary boundary;
  winding::Evaluate evaluate;
  winding::EvaluateCube evaluate_cube;
};

WindingNumber::WindingNumber(const TriangleSoup& soup, const Job& job)
    : parts_(std::make_unique<Parts>(Parts{winding::build_tree(soup, kAccuracy, job),
                                           winding::Boundary(winding::boundary_edges(soup)),
                                           SDFGRID_SELECT_ISA(evaluate_winding),
                                           SDFGRID_SELECT_ISA(evaluate_winding_cube)})) {}

WindingNumber::~WindingNumber() = default;
WindingNumber::WindingNumber(WindingNumber&&) noexcept = default;
WindingNumber& WindingNumber::operator=(WindingNumber&&) noexcept = default;

double WindingNumber::at(const glm::dvec3& local) const {
  double w = 0.0;
  at({&local, 1}, {&w, 1});
  return w;
}

void WindingNumber::at(std::span<const glm::dvec3> locals, std::span<double> out) const {
  if (locals.size() != out.size()) throw std::invalid_argument("WindingNumber::at: sizes differ");
  static_assert(sizeof(glm::dvec3) == 3 * sizeof(double));
  if (parts_->tree.nodes.empty()) {
    for (double& w : out) w = 0.0;
  } else if (!locals.empty()) {
    parts_->evaluate(parts_->tree.view(), &locals.front().x, locals.size(), out.data());
  }
}

void WindingNumber::at_cube(const glm::dvec3& corner, double step,
                            std::span<double, kCubePoints> out) const {
  static_assert(kCubePoints == winding::kCubePoints);
  const double reach =
      std::max({std::abs(corner.x), std::abs(corner.y), std::abs(corner.z)}) + 7 * std::abs(step);
  if (parts_->tree.nodes.empty() || !(reach * parts_->tree.scale < winding::kFarthest)) {
    std::fill(out.begin(), out.end(), 0.0);
    return;
  }
  const double from[3] = {corner.x, corner.y, corner.z};
  parts_->evaluate_cube(parts_->tree.view(), from, step, out.data());
}

double WindingNumber::gradient_bound(const glm::dvec3& center, double radius) const {
  constexpr double kNoLimit = std::numeric_limits<double>::infinity();
  return parts_->boundary.gradient_bound(center, radius, kFinestOpening, kNoLimit);
}

bool WindingNumber::gradient_below(const glm::dvec3& center, double radius, double limit) const {
  for (const double opening : {4.0, 1.0, kFinestOpening}) {
    if (parts_->boundary.gradient_bound(center, radius, opening, limit) <= limit) return true;
  }
  return false;
}

bool WindingNumber::closed() const { return parts_->boundary.empty(); }

}  // namespace sdfgrid
