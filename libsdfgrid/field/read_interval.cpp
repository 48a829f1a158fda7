// The interval reading: bounds of a field's values over a box, and the program that is left of it
// there.
#include "sdfgrid/field/field_reading.h"
#include "sdfgrid/field/interpret.h"
#include "sdfgrid/field/registry.h"
#include "sdfgrid/field/sampled.h"
#include "sdfgrid/field/union_tree.h"

namespace sdfgrid {
namespace {

using namespace ops;

struct IntervalOps {
  std::vector<OpFunctions<Interval>> functions = make_functions<Interval>();
  std::vector<OpFunctions<double>> exact = make_functions<double>();
  // Which operand of a combination is the whole result.
  std::vector<Keep (*)(const float*, const Interval&, const Interval&)> keep;
  // Whether a domain op changes nothing: of its node's values and its own outer points; or null.
  std::vector<bool (*)(const float*, const Interval&, const Point<Interval>&)> idle;

  IntervalOps() : keep(functions.size()), idle(functions.size()) {
    each_op([&]<class Op>(int number) {
      if constexpr (Combination<Op>) {
        keep[number] = [](const float* c, const Interval& a, const Interval& b) {
          return load_op<Op>(c).keep(a, b);
        };
      } else if constexpr (requires(Op op, Interval d, Point<Interval> p) { op.idle(d, p); }) {
        idle[number] = [](const float* c, const Interval& d, const Point<Interval>& p) {
          return load_op<Op>(c).idle(d, p);
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

// Between the points of p and a box, less what single precision may take from it; 0 if they meet.
double distance_between(const Point<Interval>& p, const Box& box) {
  if (box.empty()) return 0;
  const Interval* axes[] = {&p.x, &p.y, &p.z};
  double square = 0;
  double size = 0;
  for (int a = 0; a < 3; ++a) {
    const double away = std::fmax(std::fmax(axes[a]->lo - box.hi[a], box.lo[a] - axes[a]->hi), 0);
    square += away * away;
    size += std::fabs(box.lo[a]) + std::fabs(box.hi[a]) + away;
  }
  return std::fmax(std::sqrt(square) - size * 4 * kFloatSlack, 0);
}

}  // namespace

Interval leaf_interval(const Program& program, const Instruction& at, const Point<Interval>& p) {
  const Ball ball = ball_around(p);
  if (at.step == Step::sample) {
    const Sampler& sampler = sampler_of(program, at);
    const double beyond = distance_between(p, sampler.hull());
    const Interval far(beyond, kInfinity);
    if (!(ball.radius < kInfinity)) return beyond > 0 ? far : everything();
    const Interval near = spread(sample_at(sampler, ball.center), ball);
    return beyond > 0 ? meet(near, far) : near;
  }
  const float* c = constants_of(program, at);
  const Data data = data_of(program, at);
  const Interval direct = interval_ops().functions[at.op].leaf(c, data, p);
  const bool lipschitz = registry()[at.op].entry.info->guarantee < OpGuarantee::computed;
  if (!lipschitz || !(ball.radius < kInfinity)) return direct;
  // As narrow as that the ball would hardly make it narrower.
  if (direct.hi - direct.lo < 2 * ball.radius) return direct;
  const Point<double> center = {ball.center.x, ball.center.y, ball.center.z};
  return meet(direct, spread(interval_ops().exact[at.op].leaf(c, data, center), ball));
}

Point<Interval> intervals(const Box& box) {
  return {Interval(box.lo.x, box.hi.x), Interval(box.lo.y, box.hi.y), Interval(box.lo.z, box.hi.z)};
}

const std::vector<OpFunctions<Interval>>& interval_functions() { return interval_ops().functions; }

namespace {

// Runs the program over a box and writes what is left of it. Where unions know the boxes of their
// operands, nearer ones go first, and what is beyond the largest value that they can have is never
// looked at.
class Pruning {
 public:
  // Gives up when more than `most` instructions were looked at, where unions know boxes.
  Pruning(const Program& program, std::size_t most, bool writes)
      : program_(program), most_(most), writes_(writes) {}

  // False if it gave up. Values of `upper` and more need not be kept.
  bool over(const Box& box, double upper) {
    values_.reserve(program_.values);
    points_.reserve(program_.points + 1);
    points_.push_back(intervals(box));
    if (program_.starts.empty()) {
      if (writes_) code_.reserve(program_.code.size());
      for (const Instruction& at : program_.code) step(at);
    } else {
      tree(static_cast<std::int32_t>(program_.code.size()) - 1, upper);
    }
    return looked_at_ <= most_;
  }

  // Of nothing: nothing was below `upper`.
  [[nodiscard]] bool empty() const { return values_.empty(); }
  [[nodiscard]] Interval range() const { return values_.back().range; }
  [[nodiscard]] std::vector<Instruction>& code() { return code_; }

 private:
  struct Value {
    Interval range;
    std::size_t begin;  // where its code begins
  };

  // The subtree that ends at instruction `last`. False, and no value, if that cannot be below
  // `upper` or there is no time left.
  bool tree(std::int32_t last, double upper) {
    const Instruction& at = program_.code[last];
    if (program_.strewn && ++looked_at_ > most_) return false;
    if (has_boxes(at)) return nearer_first(last, upper);
    if (at.step == Step::combine) {
      if (!tree(program_.starts[last - 1] - 1, kInfinity)) return false;
      if (!tree(last - 1, kInfinity)) return drop();
    } else if (at.step == Step::leave) {
      step(program_.code[program_.starts[last]]);
      if (!tree(last - 1, kInfinity)) return false;
    } else if (at.step == Step::range) {
      if (!tree(last - 1, kInfinity)) return false;
    }
    step(at);
    return true;
  }

  bool nearer_first(std::int32_t last, double upper) {
    const Instruction& at = program_.code[last];
    // Of a smooth union what is farther than the nearer operand by less than its reach matters,
    // and operands may be larger than what it makes of them.
    const float* c = constants_of(program_, at);
    const double reach = registry()[at.op].reach(c);
    double limit = upper + registry()[at.op].child_level(c, 0) + reach;
    const std::int32_t ends[2] = {program_.starts[last - 1] - 1, last - 1};
    double least[2];
    least_of_operands(program_, at, points_.back(), size_of(points_.back()), least);
    const int near = least[1] < least[0] ? 1 : 0;
    int found = 0;
    for (const int i : {near, 1 - near}) {
      if (least[i] > limit || !tree(ends[i], limit)) continue;
      if (values_.back().range.lo > limit) {
        drop();
        continue;
      }
      ++found;
      limit = std::fmin(limit, values_.back().range.hi + reach);
    }
    if (found == 2) {
      Instruction join = at;
      if (near == 1) join.count = kUnionFloats + kUnionSwapped - at.count;
      step(join);
    }
    // What is left out may have made it less, but not than `upper`.
    if (found == 1 && values_.back().range.lo > upper) return drop();
    return found > 0;
  }

  bool drop() {
    if (writes_) code_.resize(values_.back().begin);
    values_.pop_back();
    return false;
  }

  void step(const Instruction& at) {
    const OpFunctions<Interval>& f = ops_.functions[at.op];
    const float* c = constants_of(program_, at);
    const std::size_t begin = code_.size();
    if (writes_) code_.push_back(at);
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
        leave(at, f, c);
        break;
    }
  }

  void leave(const Instruction& at, const OpFunctions<Interval>& f, const float* c) {
    points_.pop_back();
    Value& value = values_.back();
    value.begin = entered_.back();
    entered_.pop_back();
    const auto idle = ops_.idle[at.op];
    if (idle != nullptr && idle(c, value.range, points_.back())) {
      if (!writes_) return;
      code_.pop_back();
      code_.erase(code_.begin() + static_cast<std::ptrdiff_t>(value.begin));
    } else if (f.value != nullptr) {
      value.range = f.value(c, data_of(program_, at), value.range, points_.back());
    }
  }

  void combine(const Instruction& at, const OpFunctions<Interval>& f, const float* c) {
    const Value b = values_.back();
    values_.pop_back();
    Value& a = values_.back();
    const Keep keep = ops_.keep[at.op](c, a.range, b.range);
    if (keep == Keep::both) {
      a.range = f.combine(c, a.range, b.range, points_.back());
      return;
    }
    if (keep == Keep::second) a.range = b.range;
    if (!writes_) return;
    if (keep == Keep::first) {
      code_.resize(b.begin);
    } else {
      code_.pop_back();
      code_.erase(code_.begin() + static_cast<std::ptrdiff_t>(a.begin),
                  code_.begin() + static_cast<std::ptrdiff_t>(b.begin));
    }
  }

  const IntervalOps& ops_ = interval_ops();
  const Program& program_;
  std::size_t most_;
  bool writes_;
  std::size_t looked_at_ = 0;
  std::vector<Instruction> code_;
  std::vector<Value> values_;
  std::vector<std::size_t> entered_;
  std::vector<Point<Interval>> points_;
};

}  // namespace

ValueRange Field::range(const Box& box) const {
  if (!program_->starts.empty()) {
    Pruning reading(*program_, kAnyLength, false);
    reading.over(box, kInfinity);
    return {reading.range().lo, reading.range().hi};
  }
  const auto leaf = [&](const Instruction& at, const Point<Interval>& p) {
    return leaf_interval(*program_, at, p);
  };
  const Interval r = interpret(*program_, interval_ops().functions, intervals(box), leaf);
  return {r.lo, r.hi};
}

namespace {

// What is left of a program. Without unions by place, whose operands may have changed places, it
// needs no more room on the stacks. When little is left it is read through: that takes less than
// looking at the boxes of its operands for each group of points again.
Program part_of(const Program& whole, std::vector<Instruction> code) {
  constexpr std::size_t kLittle = 256;
  if (whole.starts.empty()) {
    return {std::move(code), whole.pool, whole.values, whole.points, whole.nesting, {}};
  }
  Program left = make_program(std::move(code), whole.pool);
  if (left.code.size() <= kLittle) left.starts.clear();
  return left;
}

}  // namespace

std::optional<Restricted> Field::restricted(const Box& box, std::size_t most, double upper) const {
  Pruning pruning(*program_, most, true);
  if (!pruning.over(box, upper)) return {};
  if (pruning.empty()) return Restricted{Field(), {upper, kInfinity}};
  const Interval range = pruning.range();
  return Restricted{
      Field(std::make_shared<const Program>(part_of(*program_, std::move(pruning.code())))),
      {range.lo, range.hi}};
}

Field Field::pruned(const Box& box) const { return restricted(box)->field; }

namespace {

// Where the value of the subtree that ends at instruction `last` is below `level`.
Box bounds_below(const Program& program, const std::vector<std::int32_t>& starts, int last,
                 double level) {
  const Instruction& at = program.code[last];
  const Box all{glm::dvec3(-kInfinity), glm::dvec3(kInfinity)};
  if (at.step == Step::sample) return sampler_of(program, at).bounds(level);
  const RegisteredOp& op = registry()[at.op];
  const float* c = constants_of(program, at);
  const Data data = data_of(program, at);
  if (has_boxes(at)) {
    const double grow = std::fmax(op.child_level(c, level), 0);
    const Box box = both_boxes(operand_box(program, at, 0), operand_box(program, at, 1));
    // Smooth unions have infinite boxes for what they do not know, too.
    if (at.op == kUnionOp || box.finite()) return {box.lo - grow, box.hi + grow};
  }
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
  const auto& known = program_->starts;
  return bounds_below(*program_, known.empty() ? subtree_starts(program_->code) : known,
                      static_cast<int>(program_->code.size()) - 1, level);
}

}  // namespace sdfgrid
