#include "sdfgrid/field/sampled.h"

#include <cmath>

namespace sdfgrid {

Box Sampler::bounds(double level) const {
  const Box box = hull();
  const double grow = box.empty() ? 0 : std::fmax(level, 0);
  return {box.lo - grow, box.hi + grow};
}

float sample_at(const Sampler& sampler, const glm::dvec3& p) {
  const glm::vec3 f(p);
  float out = 0;
  sampler.evaluate(1, &f.x, &f.y, &f.z, &out);
  return out;
}

ValueGradient sample_gradient(const Sampler& sampler, const glm::dvec3& p) {
  const double step = sampler.step();
  ValueGradient r{sample_at(sampler, p), glm::dvec3(0)};
  for (int a = 0; a < 3; ++a) {
    glm::dvec3 lo = p;
    glm::dvec3 hi = p;
    lo[a] -= step;
    hi[a] += step;
    r.gradient[a] = (sampler.value(hi) - sampler.value(lo)) / (2 * step);
  }
  const double length = std::sqrt(r.gradient.x * r.gradient.x + r.gradient.y * r.gradient.y +
                                  r.gradient.z * r.gradient.z);
  if (length > 1) r.gradient /= length;
  return r;
}

}  // namespace sdfgrid
