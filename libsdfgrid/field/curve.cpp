#include "sdfgrid/field/curve.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <glm/geometric.hpp>

namespace sdfgrid {
namespace {

using Quintic = std::array<double, 6>;  // Bernstein coefficients over an interval

int sign_changes(const Quintic& q) {
  int changes = 0;
  double last = 0;
  for (const double c : q) {
    if (c == 0) continue;
    if (last * c < 0) ++changes;
    last = c;
  }
  return changes;
}

// The coefficients over both halves of the interval (de Casteljau).
void halves(const Quintic& q, Quintic& left, Quintic& right) {
  Quintic row = q;
  for (int n = 5; n >= 0; --n) {
    left[5 - n] = row[0];
    right[n] = row[n];
    for (int i = 0; i < n; ++i) row[i] = 0.5 * (row[i] + row[i + 1]);
  }
}

class CubicCurve : public Sampler {
 public:
  CubicCurve(const std::vector<double>& v, double radius) : radius_(radius) {
    for (int i = 0; i < 4; ++i) control_[i] = {v[3 * i], v[3 * i + 1], v[3 * i + 2]};
  }

  void evaluate(int n, const float* x, const float* y, const float* z, float* out) const override {
    for (int i = 0; i < n; ++i) {
      out[i] = static_cast<float>(value({x[i], y[i], z[i]}));
    }
  }
  [[nodiscard]] double value(const glm::dvec3& p) const override { return distance(p) - radius_; }

  [[nodiscard]] Box hull() const override {
    Box box;
    for (const double t : {0.0, 1.0}) box.add(at(t));
    for (int a = 0; a < 3; ++a) add_extremes(a, box);
    return {box.lo - radius_, box.hi + radius_};
  }
  [[nodiscard]] double step() const override { return 1e-6 * glm::length(hull().size()); }

 private:
  static double dot(const glm::dvec3& a, const glm::dvec3& b) {
    return a.x * b.x + a.y * b.y + a.z * b.z;
  }

  [[nodiscard]] glm::dvec3 at(double t) const {
    const double s = 1 - t;
    return s * s * s * control_[0] + 3 * s * s * t * control_[1] + 3 * s * t * t * control_[2] +
           t * t * t * control_[3];
  }

  [[nodiscard]] double squared(const glm::dvec3& p, double t) const {
    const glm::dvec3 d = at(t) - p;
    return dot(d, d);
  }

  // Where the coordinate's derivative, a t^2 + b t + c but for a factor, is zero.
  void add_extremes(int axis, Box& box) const {
    const auto v = [&](int i) { return control_[i][axis]; };
    const double a = v(3) - 3 * v(2) + 3 * v(1) - v(0);
    const double b = 2 * (v(2) - 2 * v(1) + v(0));
    const double c = v(1) - v(0);
    const double root = b * b - 4 * a * c;
    if (root < 0) return;
    const double q = -0.5 * (b + std::copysign(std::sqrt(root), b));
    for (const double t : {q / a, c / q}) {  // not finite where there is none
      if (t > 0 && t < 1) box.add(at(t));
    }
  }

  [[nodiscard]] double distance(const glm::dvec3& p) const {
    // (c - p) . c' in the Bernstein basis: the product of degrees 3 and 2.
    constexpr double kThree[] = {1, 3, 3, 1};
    constexpr double kTwo[] = {1, 2, 1};
    constexpr double kFive[] = {1, 5, 10, 10, 5, 1};
    Quintic q{};
    for (int i = 0; i < 4; ++i) {
      for (int j = 0; j < 3; ++j) {
        q[i + j] += kThree[i] * kTwo[j] / kFive[i + j] *
                    dot(control_[i] - p, control_[j + 1] - control_[j]);
      }
    }
    double nearest = std::min(squared(p, 0), squared(p, 1));
    search(q, 0, 1, p, nearest);
    return std::sqrt(nearest);
  }

  // Tries every root in [t, t + width].
  void search(const Quintic& q, double t, double width, const glm::dvec3& p,
              double& nearest) const {
    if (sign_changes(q) == 0) return;
    if (width < 1e-8) {
      nearest = std::min(nearest, squared(p, t + 0.5 * width));
      return;
    }
    Quintic left;
    Quintic right;
    halves(q, left, right);
    // A root here is at the end of both halves, where no change of sign tells of it.
    if (right[0] == 0) nearest = std::min(nearest, squared(p, t + 0.5 * width));
    search(left, t, 0.5 * width, p, nearest);
    search(right, t + 0.5 * width, 0.5 * width, p, nearest);
  }

  std::array<glm::dvec3, 4> control_{};
  double radius_;
};

}  // namespace

std::shared_ptr<const Sampler> make_cubic_curve(const std::vector<double>& control, double radius) {
  return std::make_shared<CubicCurve>(control, radius);
}

}  // namespace sdfgrid
