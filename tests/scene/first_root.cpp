#include "scene/first_root.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <vector>

#include "sdfgrid/trace/field_march.h"

namespace sdfgrid::test {
namespace {

constexpr double kInfinity = std::numeric_limits<double>::infinity();
// Of a coordinate: over shorter stretches intervals, which hold what floats may be off, get no
// narrower.
constexpr double kShortest = 5e-7;
// Intervals stay wide at the walls of a repetition's cells and where pictures displace a surface.
// The slope of a field is at most 1, which the tests of ops hold against pairs of points: over
// stretches shorter than this part of a coordinate there is no root beside a value so many times
// their length.
constexpr double kShort = 1e-3;
constexpr double kSteep = 4;
// A ray beside a surface leaves many stretches open: after so many they are twice as long.
constexpr int kMany = 1000;

glm::dvec3 at(const Ray& ray, double t) { return ray.origin + t * ray.direction; }

double value_at(const Field& field, const Ray& ray, double t) {
  return field.gradient(at(ray, t)).value;
}

class Search {
 public:
  // `far` is the largest coordinate.
  Search(const Field& whole, const Ray& ray, double far)
      : whole_(whole), ray_(ray), short_(kShort * far), shortest_(kShortest * far) {}

  // Whether there is a root for certain; nothing is known of what lies beyond it.
  bool over(const Field& field, double from, double to) {
    Box box;
    box.add(at(ray_, from));
    box.add(at(ray_, to));
    const Restricted here = *field.restricted(box);
    if (here.range.lo > 0) return false;
    const double length = to - from;
    if (length <= short_) {
      const double value = value_at(whole_, ray_, to);
      if (value > kSteep * length) return false;
      if (length <= shortest_) return ends_inside(from, to, value);
    }
    const double middle = 0.5 * (from + to);
    return over(here.field, from, middle) || over(here.field, middle, to);
  }
  [[nodiscard]] const FirstRoot& root() const { return root_; }

 private:
  // Of a stretch that is left open.
  bool ends_inside(double from, double to, double value) {
    root_.possible = std::min(root_.possible, from);
    if (++open_ % kMany == 0) shortest_ *= 2;
    if (!(value < 0)) return false;
    root_.certain = to;
    return true;
  }

  const Field& whole_;
  Ray ray_;
  double short_, shortest_;
  int open_ = 0;
  FirstRoot root_{kInfinity, kInfinity};
};

}  // namespace

FirstRoot first_root(const Field& field, const Ray& ray, double from, double to) {
  if (!(from < to)) return {kInfinity, kInfinity};
  const double far =
      std::max(reach({at(ray, from), at(ray, from)}), reach({at(ray, to), at(ray, to)}));
  Search search(field, ray, far);
  search.over(field, from, to);
  return search.root();
}

FirstRoot first_root(const Field& field, const Ray& ray, const Box& box) {
  const Span in = clip(ray, box);
  return first_root(field, ray, in.from, in.to);
}

double first_sample_inside(const Field& field, const Ray& ray, double from, double to,
                           int samples) {
  const auto n = static_cast<std::size_t>(samples);
  std::vector<float> x(n), y(n), z(n), value(n);
  const auto place = [&](std::size_t i) { return from + (to - from) * double(i) / double(n - 1); };
  for (std::size_t i = 0; i < n; ++i) {
    const glm::vec3 p(at(ray, place(i)));
    x[i] = p.x;
    y[i] = p.y;
    z[i] = p.z;
  }
  field.evaluate(n, x.data(), y.data(), z.data(), value.data());
  for (std::size_t i = 0; i < n; ++i) {
    // What floats may be off decides nothing.
    const double error = 2 * kFieldSlack * reach({at(ray, place(i)), at(ray, place(i))});
    if (double(value[i]) < error && value_at(field, ray, place(i)) < 0) return place(i);
  }
  return kInfinity;
}

namespace {

// What is known to be free at a hit, and what single precision may be off, a place along the ray
// included, which is a float.
double allowed(const Ray& ray, double depth, double tolerance) {
  const glm::dvec3 p = at(ray, depth);
  return tolerance * depth + 4 * kFieldSlack * reach({p, p}) + 1.2e-7 * depth;
}

}  // namespace

Verdict judge(const Field& field, const Ray& ray, const FirstRoot& root, double depth,
              double tolerance) {
  const double most = allowed(ray, std::min(depth, root.certain), tolerance);
  if (depth > root.certain + most) return Verdict::missed;
  if (!std::isfinite(depth) || depth > root.possible - most) return Verdict::right;
  // Where less than the tolerance was free the hit is taken to be as far ahead again.
  return std::fabs(value_at(field, ray, depth)) > 2 * most ? Verdict::invented : Verdict::right;
}

}  // namespace sdfgrid::test
