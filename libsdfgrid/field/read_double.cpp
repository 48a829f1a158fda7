// The readings of a field at one point in double: gradient, and whose surface is nearest.
#include "sdfgrid/field/dual.h"
#include "sdfgrid/field/interpret.h"
#include "sdfgrid/field/sampled.h"
#include "sdfgrid/field/union_tree.h"

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

// A value and the leaf that decides it: its mark, and its place among the constants, which is in
// the order of the scene.
struct Marked {
  double value;
  int tag;
  std::uint32_t place;
};

struct MarkedOps {
  std::vector<OpFunctions<double>> functions = make_functions<double>();
  // Combinations: whose surface.
  std::vector<bool (*)(const float*, double, double, const Point<double>&)> first;

  MarkedOps() : first(functions.size()) {
    each_op([&]<class Op>(int number) {
      if constexpr (Combination<Op>) {
        first[number] = [](const float* c, double a, double b, const Point<double>& p) {
          const Op op = load_op<Op>(c);
          if constexpr (requires { op.surface_of_first(a, b, p); }) {
            return op.surface_of_first(a, b, p);
          } else {
            return op.surface_of_first(a, b);
          }
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

// A sampler's own mark comes before the instruction's.
int leaf_tag(const Program& program, const Instruction& at, const Point<double>& p) {
  if (at.step != Step::sample) return at.tag;
  const int own = sampler_of(program, at).tag({p.x, p.y, p.z});
  return own >= 0 ? own : at.tag;
}

// One step of a program that carries marks beside values.
void marked_step(const Program& program, const Instruction& at, std::vector<Marked>& values,
                 std::vector<Point<double>>& points) {
  const OpFunctions<double>& f = marked_ops().functions[at.op];
  const float* c = constants_of(program, at);
  switch (at.step) {
    case Step::leaf:
    case Step::sample: {
      const Point<double> p = leaf_point(at, points.back());
      values.push_back({leaf_value(program, at, p), leaf_tag(program, at, p), at.constants});
      break;
    }
    case Step::combine: {
      const Marked b = values.back();
      values.pop_back();
      Marked& a = values.back();
      // Of a shared surface the first node's is seen, in whatever order a large union joins them.
      const bool tied = has_boxes(at) && a.value == b.value;
      const bool first =
          tied ? a.place <= b.place : marked_ops().first[at.op](c, a.value, b.value, points.back());
      const double value = f.combine(c, a.value, b.value, points.back());
      if (!first) a = b;
      a.value = value;
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

namespace {

// What of the field matters at one point.
Field at_point(const Field& field, const glm::dvec3& p) {
  return field.program().starts.empty() ? field : field.pruned({p, p});
}

}  // namespace

int Field::tag_at(const glm::dvec3& p) const {
  const Field here = at_point(*this, p);
  std::vector<Marked> values;
  std::vector<Point<double>> points = {{p.x, p.y, p.z}};
  for (const Instruction& at : here.program().code) {
    marked_step(here.program(), at, values, points);
  }
  return values.back().tag;
}

ValueGradient Field::gradient(const glm::dvec3& p) const {
  const Field here = at_point(*this, p);
  const Program& program = here.program();
  const Point<Gradient> at = {Gradient::variable(p.x, 0), Gradient::variable(p.y, 1),
                              Gradient::variable(p.z, 2)};
  const auto& functions = gradient_functions();
  const auto leaf = [&](const Instruction& i, const Point<Gradient>& q) {
    if (i.step == Step::sample) return sampled_gradient(sampler_of(program, i), q);
    return functions[i.op].leaf(constants_of(program, i), data_of(program, i), q);
  };
  const Gradient r = interpret(program, functions, at, leaf);
  return {r.v, glm::dvec3(r.d[0], r.d[1], r.d[2])};
}

}  // namespace sdfgrid
