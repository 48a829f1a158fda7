// The readings of a field at one point in double: gradient, and whose surface is nearest.
#include "sdfgrid/field/dual.h"
#include "sdfgrid/field/interpret.h"
#include "sdfgrid/field/sampled.h"

namespace sdfgrid {
namespace {

using namespace ops;
using Gradient = Dual<double, 3>;

const std::vector<OpFunctions<Gradient>>& gradient_functions() {
  static const auto functions = make_functions<Gradient>();
  return functions;
}

// Chain rule over central differences of the sampler.
Gradient sampled_gradient(const Sampler& sampler, const Point<Gradient>& p) {
  const glm::dvec3 at(p.x.v, p.y.v, p.z.v);
  const ValueGradient s = sample_gradient(sampler, at);
  return Gradient::make(s.value, [&](int i) {
    return s.gradient.x * p.x.d[i] + s.gradient.y * p.y.d[i] + s.gradient.z * p.z.d[i];
  });
}

}  // namespace

ValueGradient Field::gradient(const glm::dvec3& p) const {
  if (program_->code.empty()) return {kInfinity, glm::dvec3(0)};
  const Point<Gradient> at = {Gradient::variable(p.x, 0), Gradient::variable(p.y, 1),
                              Gradient::variable(p.z, 2)};
  const auto& functions = gradient_functions();
  const auto leaf = [&](const Instruction& i, const Point<Gradient>& q) {
    if (i.step == Step::sample) return sampled_gradient(*program_->samplers[i.sampler], q);
    return functions[i.op].leaf(program_->constants.data() + i.constants, data_of(*program_, i), q);
  };
  const Gradient r = interpret(*program_, functions, at, leaf);
  return {r.v, glm::dvec3(r.d[0], r.d[1], r.d[2])};
}

}  // namespace sdfgrid
