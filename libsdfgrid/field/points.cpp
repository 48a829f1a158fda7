// Distances to a set of points by a kd-tree; declared in leaves_sampled.h.
#include <algorithm>
#include <cmath>
#include <glm/geometric.hpp>

#include "sdfgrid/field/build.h"
#include "sdfgrid/field/leaves_sampled.h"

namespace sdfgrid {
namespace {

using Position = glm::dvec3;

// Ranges of points, halved at the median along their longest side; a node's halves lie beside each
// other, so that indices are all there is to the tree.
class PointSet : public Sampler {
 public:
  PointSet(std::vector<Position> points, double radius)
      : points_(std::move(points)), radius_(radius) {
    for (const Position& p : points_) bounds_.add(p);
    axes_.resize(points_.size());
    split(0, points_.size());
  }

  void evaluate(int n, const float* x, const float* y, const float* z, float* out) const override {
    for (int i = 0; i < n; ++i) out[i] = static_cast<float>(value({x[i], y[i], z[i]}));
  }
  [[nodiscard]] double value(const Position& p) const override {
    double nearest = 1e300;
    search(0, points_.size(), p, nearest);
    return std::sqrt(nearest) - radius_;
  }
  // Well within the ball of a point.
  [[nodiscard]] double step() const override {
    return 1e-6 * std::fmax(radius_, 1e-3 * glm::length(bounds_.size()));
  }

  [[nodiscard]] Box hull() const override { return {bounds_.lo - radius_, bounds_.hi + radius_}; }

 private:
  static constexpr std::size_t kLeaf = 8;

  void split(std::size_t begin, std::size_t end) {
    if (end - begin <= kLeaf) return;
    Box box;
    for (std::size_t i = begin; i < end; ++i) box.add(points_[i]);
    const Position size = box.size();
    const int axis = size.x >= size.y && size.x >= size.z ? 0 : (size.y >= size.z ? 1 : 2);
    const std::size_t middle = begin + (end - begin) / 2;
    const auto at = [&](std::size_t i) { return points_.begin() + static_cast<std::ptrdiff_t>(i); };
    std::nth_element(at(begin), at(middle), at(end),
                     [axis](const Position& a, const Position& b) { return a[axis] < b[axis]; });
    axes_[middle] = static_cast<signed char>(axis);
    split(begin, middle);
    split(middle + 1, end);
  }

  void search(std::size_t begin, std::size_t end, const Position& p, double& nearest) const {
    const auto take = [&](const Position& q) {
      const Position d = q - p;
      nearest = std::min(nearest, d.x * d.x + d.y * d.y + d.z * d.z);
    };
    if (end - begin <= kLeaf) {
      for (std::size_t i = begin; i < end; ++i) take(points_[i]);
      return;
    }
    const std::size_t middle = begin + (end - begin) / 2;
    take(points_[middle]);
    const int axis = axes_[middle];
    const double beyond = p[axis] - points_[middle][axis];
    const bool low_first = beyond < 0;
    if (low_first) {
      search(begin, middle, p, nearest);
    } else {
      search(middle + 1, end, p, nearest);
    }
    if (beyond * beyond >= nearest) return;
    if (low_first) {
      search(middle + 1, end, p, nearest);
    } else {
      search(begin, middle, p, nearest);
    }
  }

  std::vector<Position> points_;
  std::vector<signed char> axes_;
  double radius_;
  Box bounds_;
};

}  // namespace

namespace ops {

Field Points::make(const std::vector<Argument>& given) {
  const CheckedArguments arguments({&info, parameters}, given);
  const std::vector<double> v = arguments.numbers("points");
  if (v.empty()) throw arguments.refused("give it `points`, or a `file` that has some");
  std::vector<Position> points;
  for (std::size_t i = 0; i < v.size(); i += 3) points.emplace_back(v[i], v[i + 1], v[i + 2]);
  return make_field(std::make_shared<PointSet>(std::move(points), arguments.number("radius")));
}

}  // namespace ops
}  // namespace sdfgrid
