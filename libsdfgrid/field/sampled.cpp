#include "sdfgrid/field/sampled.h"

#include <algorithm>
#include <cmath>

namespace sdfgrid {

float sample_at(const Sampler& sampler, const glm::dvec3& p) {
  const glm::vec3 f(p);
  float out = 0;
  sampler.evaluate(1, &f.x, &f.y, &f.z, &out);
  return out;
}

ValueGradient sample_gradient(const Sampler& sampler, const glm::dvec3& p) {
  const double largest = std::max({std::fabs(p.x), std::fabs(p.y), std::fabs(p.z), 1e-3});
  const double step = largest * 1e-3;
  ValueGradient r{sample_at(sampler, p), glm::dvec3(0)};
  for (int a = 0; a < 3; ++a) {
    glm::dvec3 lo = p;
    glm::dvec3 hi = p;
    lo[a] -= step;
    hi[a] += step;
    r.gradient[a] =
        (static_cast<double>(sample_at(sampler, hi)) - sample_at(sampler, lo)) / (2 * step);
  }
  const double length = std::sqrt(r.gradient.x * r.gradient.x + r.gradient.y * r.gradient.y +
                                  r.gradient.z * r.gradient.z);
  if (length > 1) r.gradient /= length;
  return r;
}

}  // namespace sdfgrid
