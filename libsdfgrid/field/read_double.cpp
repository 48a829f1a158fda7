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

// A value and the mark of the leaf that decides it.
struct Marked {
  double value;
  int tag;
};

struct MarkedOps {
  std::vector<OpFunctions<double>> functions = make_functions<double>();
  std::vector<bool (*)(const float*, double, double)> first;  // combinations: whose surface

  MarkedOps() : first(functions.size()) {
    each_op([&]<class Op>(int number) {
      if constexpr (Combination<Op>) {
        first[number] = [](const float* c, double a, double b) {
          return load_op<Op>(c).surface_of_first(a, b);
        };
      }
    });
  }
};

const MarkedOps& marked_ops() {
  static const MarkedOps all;
  return all;
}

double leaf_value(const Program& program, const Instruction& at, const Point<double>& p) {
  if (at.step == Step::sample) {
    return sample_at(sampler_of(program, at), glm::dvec3(p.x, p.y, p.z));
  }
  return marked_ops().functions[at.op].leaf(constants_of(program, at), data_of(program, at), p);
}

// One step of a program that carries marks beside values.
void marked_step(const Program& program, const Instruction& at, std::vector<Marked>& values,
                 std::vector<Point<double>>& points) {
  const OpFunctions<double>& f = marked_ops().functions[at.op];
  const float* c = constants_of(program, at);
  switch (at.step) {
    case Step::leaf:
    case Step::sample:
      values.push_back({leaf_value(program, at, leaf_point(at, points.back())), at.tag});
      break;
    case Step::combine: {
      const Marked b = values.back();
      values.pop_back();
      Marked& a = values.back();
      if (!marked_ops().first[at.op](c, a.value, b.value)) a.tag = b.tag;
      a.value = f.combine(c, a.value, b.value, points.back());
      break;
    }
    case Step::range:
      values.back().value = f.value(c, data_of(program, at), values.back().value, points.back());
      break;
    case Step::enter:
      points.push_back(f.inside(c, points.back()));
      break;
    case Step::leave:
      points.pop_back();
      if (f.value)
        values.back().value = f.value(c, data_of(program, at), values.back().value, points.back());
      break;
  }
}

}  // namespace

int Field::tag_at(const glm::dvec3& p) const {
  std::vector<Marked> values;
  std::vector<Point<double>> points = {{p.x, p.y, p.z}};
  for (const Instruction& at : program_->code) marked_step(*program_, at, values, points);
  return values.back().tag;
}

ValueGradient Field::gradient(const glm::dvec3& p) const {
  const Point<Gradient> at = {Gradient::variable(p.x, 0), Gradient::variable(p.y, 1),
                              Gradient::variable(p.z, 2)};
  const auto& functions = gradient_functions();
  const auto leaf = [&](const Instruction& i, const Point<Gradient>& q) {
    if (i.step == Step::sample) return sampled_gradient(sampler_of(*program_, i), q);
    return functions[i.op].leaf(constants_of(*program_, i), data_of(*program_, i), q);
  };
  const Gradient r = interpret(*program_, functions, at, leaf);
  return {r.v, glm::dvec3(r.d[0], r.d[1], r.d[2])};
}

}  // namespace sdfgrid
