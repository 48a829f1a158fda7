#include "field/pairs.h"

#include <cmath>
#include <limits>

Points random_points(std::size_t n, const sdfgrid::Box& box, std::mt19937& random) {
  Points p(n);
  std::uniform_real_distribution<double> unit(0, 1);
  for (std::size_t i = 0; i < n; ++i) {
    p.x[i] = static_cast<float>(box.lo.x + unit(random) * box.size().x);
    p.y[i] = static_cast<float>(box.lo.y + unit(random) * box.size().y);
    p.z[i] = static_cast<float>(box.lo.z + unit(random) * box.size().z);
  }
  return p;
}

double pair_excess(const std::function<void(Points&)>& f, const sdfgrid::Box& box, double constant,
                   std::size_t pairs) {
  std::mt19937 random(7);
  Points p = random_points(pairs, box, random);
  Points q = random_points(pairs, box, random);
  std::uniform_real_distribution<float> exponent(-7, 0);
  for (std::size_t i = 0; i < q.x.size(); ++i) {
    const float t = std::pow(10.0F, exponent(random));
    q.x[i] = p.x[i] + t * (q.x[i] - p.x[i]);
    q.y[i] = p.y[i] + t * (q.y[i] - p.y[i]);
    q.z[i] = p.z[i] + t * (q.z[i] - p.z[i]);
  }
  f(p);
  f(q);
  double worst = 0;
  for (std::size_t i = 0; i < q.x.size(); ++i) {
    const glm::dvec3 d = p.at(i) - q.at(i);
    const double apart = std::sqrt(d.x * d.x + d.y * d.y + d.z * d.z);
    const double rise = std::fabs(static_cast<double>(p.value[i]) - q.value[i]);
    if (std::isnan(rise)) return std::numeric_limits<double>::infinity();
    worst = std::fmax(worst, rise - constant * apart);
  }
  return worst;
}

double pair_excess(const sdfgrid::Field& f, const sdfgrid::Box& box) {
  return pair_excess([&](Points& p) { p.evaluate(f); }, box);
}
