// The interval reading: bounds of a field's values over a box, and the program that is left of it
// there.
#include "sdfgrid/field/field_reading.h"
#include "sdfgrid/field/interpret.h"
#include "sdfgrid/field/registry.h"
#include "sdfgrid/field/sampled.h"

namespace sdfgrid {
namespace {

using namespace ops;

struct IntervalOps {
  std::vector<OpFunctions<Interval>> functions = make_functions<Interval>();
  std::vector<OpFunctions<double>> exact = make_functions<double>();
  // Which operand of a combination is the whole result.
  std::vector<Keep (*)(const float*, const Interval&, const Interval&)> keep;

  IntervalOps() : keep(functions.size()) {
    each_op([&]<class Op>(int number) {
      if constexpr (Combination<Op>) {
        keep[number] = [](const float* c, const Interval& a, const Interval& b) {
          return load_op<Op>(c).keep(a, b);
        };
      }
    });
  }
};

const IntervalOps& interval_ops() {
  static const IntervalOps all;
  return all;
}

struct Ball {
  glm::dvec3 center;
  double radius;
};
Ball ball_around(const Point<Interval>& p) {
  const glm::dvec3 lo(p.x.lo, p.y.lo, p.z.lo);
  const glm::dvec3 hi(p.x.hi, p.y.hi, p.z.hi);
  const glm::dvec3 half = 0.5 * (hi - lo);
  return {0.5 * (lo + hi), std::sqrt(half.x * half.x + half.y * half.y + half.z * half.z)};
}
// All that a distance can be in a ball around whose centre it is `value`, as floats give it.
Interval spread(double value, const Ball& ball) {
  const double far = std::fabs(ball.center.x) + std::fabs(ball.center.y) + std::fabs(ball.center.z);
  const double slack = (far + ball.radius + std::fabs(value)) * 4 * kFloatSlack;
  const double r = ball.radius + slack;
  return r < kInfinity ? Interval(value - r, value + r) : everything();
}

}  // namespace

Interval leaf_interval(const Program& program, const Instruction& at, const Point<Interval>& p) {
  const Ball ball = ball_around(p);
  if (at.step == Step::sample) {
    if (!(ball.radius < kInfinity)) return everything();
    return spread(sample_at(sampler_of(program, at), ball.center), ball);
  }
  const float* c = constants_of(program, at);
  const Data data = data_of(program, at);
  const Interval direct = interval_ops().functions[at.op].leaf(c, data, p);
  const bool lipschitz = registry()[at.op].entry.info->guarantee < OpGuarantee::computed;
  if (!lipschitz || !(ball.radius < kInfinity)) return direct;
  const Point<double> center = {ball.center.x, ball.center.y, ball.center.z};
  return meet(direct, spread(interval_ops().exact[at.op].leaf(c, data, center), ball));
}

Point<Interval> intervals(const Box& box) {
  return {Interval(box.lo.x, box.hi.x), Interval(box.lo.y, box.hi.y), Interval(box.lo.z, box.hi.z)};
}

const std::vector<OpFunctions<Interval>>& interval_functions() { return interval_ops().functions; }

namespace {

// Runs the program over a box and writes what is left of it.
class Pruning {
 public:
  explicit Pruning(const Program& program) : program_(program) {}

  std::vector<Instruction> over(const Box& box) {
    code_.reserve(program_.code.size());
    values_.reserve(program_.values);
    points_.reserve(program_.points + 1);
    points_.push_back(intervals(box));
    for (const Instruction& at : program_.code) step(at);
    return std::move(code_);
  }

 private:
  struct Value {
    Interval range;
    std::size_t begin;  // where its code begins
  };

  void step(const Instruction& at) {
    const OpFunctions<Interval>& f = interval_ops().functions[at.op];
    const float* c = constants_of(program_, at);
    const std::size_t begin = code_.size();
    code_.push_back(at);
    switch (at.step) {
      case Step::leaf:
      case Step::sample:
        values_.push_back({leaf_interval(program_, at, leaf_point(at, points_.back())), begin});
        break;
      case Step::combine:
        combine(at, f, c);
        break;
      case Step::range:
        values_.back().range =
            f.value(c, data_of(program_, at), values_.back().range, points_.back());
        break;
      case Step::enter:
        points_.push_back(f.inside(c, points_.back()));
        entered_.push_back(begin);
        break;
      case Step::leave:
        points_.pop_back();
        values_.back().begin = entered_.back();
        entered_.pop_back();
        if (f.value)
          values_.back().range =
              f.value(c, data_of(program_, at), values_.back().range, points_.back());
        break;
    }
  }

  void combine(const Instruction& at, const OpFunctions<Interval>& f, const float* c) {
    const Value b = values_.back();
    values_.pop_back();
    Value& a = values_.back();
    const Keep keep = interval_ops().keep[at.op](c, a.range, b.range);
    if (keep == Keep::both) {
      a.range = f.combine(c, a.range, b.range, points_.back());
    } else if (keep == Keep::first) {
      code_.resize(b.begin);
    } else {
      code_.pop_back();
      code_.erase(code_.begin() + static_cast<std::ptrdiff_t>(a.begin),
                  code_.begin() + static_cast<std::ptrdiff_t>(b.begin));
      a.range = b.range;
    }
  }

  const Program& program_;
  std::vector<Instruction> code_;
  std::vector<Value> values_;
  std::vector<std::size_t> entered_;
  std::vector<Point<Interval>> points_;
};

}  // namespace

ValueRange Field::range(const Box& box) const {
  const auto leaf = [&](const Instruction& at, const Point<Interval>& p) {
    return leaf_interval(*program_, at, p);
  };
  const Interval r = interpret(*program_, interval_ops().functions, intervals(box), leaf);
  return {r.lo, r.hi};
}

Field Field::pruned(const Box& box) const {
  return Field(
      std::make_shared<const Program>(make_program(Pruning(*program_).over(box), program_->pool)));
}

namespace {

// Where the value of the subtree that ends at instruction `last` is below `level`.
Box bounds_below(const Program& program, const std::vector<std::int32_t>& starts, int last,
                 double level) {
  const Instruction& at = program.code[last];
  const Box all{glm::dvec3(-kInfinity), glm::dvec3(kInfinity)};
  if (at.step == Step::sample) {
    // A bound may be small far from its surface.
    return level <= 0 ? sampler_of(program, at).bounds() : all;
  }
  const RegisteredOp& op = registry()[at.op];
  const float* c = constants_of(program, at);
  const Data data = data_of(program, at);
  if (at.step == Step::leaf) {
    const Box box = op.bounds(c, data, all, all, level);
    const glm::dvec3 offset(at.offset[0], at.offset[1], at.offset[2]);
    return box.empty() ? box : Box{box.lo + offset, box.hi + offset};
  }
  const double below = op.child_level(c, level);
  const Box second = bounds_below(program, starts, last - 1, below);
  if (at.step != Step::combine) return op.bounds(c, data, second, all, level);
  const Box first = bounds_below(program, starts, starts[last - 1] - 1, below);
  return op.bounds(c, data, first, second, level);
}

}  // namespace

Box Field::bounds(double level) const {
  return bounds_below(*program_, subtree_starts(program_->code),
                      static_cast<int>(program_->code.size()) - 1, level);
}

}  // namespace sdfgrid
