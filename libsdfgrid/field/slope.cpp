// The Lipschitz reading of a program: of each value its interval over the box, its derivatives by
// the point that it is a function of, and a bound on their norm. What an op contributes is known by
// proof (1-Lipschitz leaves, convex combinations), in closed form (stretch, slope, pulled_back), or
// comes from its formula over intervals with derivatives; where there are several, all hold.
#include "sdfgrid/field/slope.h"

#include <algorithm>
#include <queue>

#include "sdfgrid/field/dual.h"
#include "sdfgrid/field/field_reading.h"
#include "sdfgrid/field/interpret.h"
#include "sdfgrid/field/registry.h"

namespace sdfgrid {
namespace {

using namespace ops;

// A value over a box, its derivatives, and what is known of their norm.
using Steep = Dual<Interval, 3>;

// How one op changes slopes; those that its role lacks are null.
struct SlopeOps {
  Steep (*leaf)(const float* c, Data data, const Point<Interval>& p) = nullptr;
  Steep (*combine)(const float* c, const Steep& a, const Steep& b,
                   const Point<Interval>& p) = nullptr;
  Steep (*value)(const float* c, Data data, const Steep& d, const Point<Interval>& p) = nullptr;
  Point<Steep> (*inside)(const float* c, const Point<Interval>& p) = nullptr;
  // The node's value `d` at `inside`, as one of the point p outside.
  Steep (*pull_back)(const float* c, const Steep& d, const Point<Steep>& inside,
                     const Point<Interval>& p) = nullptr;
};

template <int N>
Point<Dual<Interval, N>> variables(const Point<Interval>& p) {
  using D = Dual<Interval, N>;
  return {D::variable(p.x, 0), D::variable(p.y, 1), D::variable(p.z, 2)};
}

// 0 * infinity is 0 here: what is not used may be as steep as it likes.
double times(double a, double b) { return product(a, b); }

// These derivatives, none of which is more than the norm may be.
template <class F>
Steep steep(const F& derivative, double most) {
  return Steep::make(Interval(0), [&](int i) { return meet(derivative(i), Interval(-most, most)); },
                     {most});
}
// Of which no more is known.
Steep no_steeper(double most) {
  return steep([&](int) { return Interval(-most, most); }, most);
}
double most_of(const Steep& d) { return d.steepness.most; }

template <class Op>
Steep leaf_slope(const float* c, Data data, const Point<Interval>& p) {
  constexpr bool bounded = Op::info.guarantee != OpGuarantee::computed;
  // Formulas of other leaves are long, and nothing is gained.
  constexpr bool simple = !bounded || requires { Op::kConvexSolid; };
  const double most = bounded ? 1 : kInfinity;
  if constexpr (simple) {
    const Steep r = leaf_value(load_op<Op>(c), variables<3>(p), data);
    return steep([&](int i) { return r.d[i]; }, lesser(most, most_of(r)));
  } else {
    return no_steeper(most);
  }
}

// No larger than the larger of two, weighted by numbers that are positive and sum to at most 1.
Steep weighted(const Steep& a, const Steep& b) {
  const double most = greater(most_of(a), most_of(b));
  return steep([&](int i) { return hull(Interval(0), hull(a.d[i], b.d[i])); }, most);
}

template <class Op>
Steep combined_slope(const float* c, const Steep& a, const Steep& b, const Point<Interval>& p) {
  const Op op = load_op<Op>(c);
  if constexpr (requires { Op::kConvex; }) {
    const Keep keep = op.keep(a.v, b.v);
    if (keep != Keep::both) return keep == Keep::first ? a : b;
    return weighted(
        a, requires { Op::kTurnsLast; } ? -b : b);
  } else if constexpr (requires { op.slope(a.v, 1.0, b.v, 1.0, p); }) {
    return no_steeper(op.slope(a.v, most_of(a), b.v, most_of(b), p));
  } else {
    static_assert(
        requires { Op::kConvex; }, "say kConvex or slope()");
  }
}

template <class Op>
Steep value_slope(const float* c, Data data, const Steep& d, const Point<Interval>& p) {
  const Op op = load_op<Op>(c);
  if constexpr (
      requires { op.slope(d.v, 1.0, p); } && !requires { Op::kDerivatives; }) {
    return no_steeper(op.slope(d.v, most_of(d), p));
  } else {
    // Of the point and of the value: the chain rule with its derivatives, and with its norm.
    using D = Dual<Interval, 4>;
    const D r = changed_value(op, D::variable(d.v, 3), variables<4>(p), data);
    double most = times(magnitude(r.d[3]), most_of(d)) + norm(r.d.data(), 3);
    if constexpr (requires { Op::kConvex; }) most = lesser(most, most_of(d));
    if constexpr (requires { Op::kDerivatives; }) most = lesser(most, op.slope(d.v, most_of(d), p));
    return steep([&](int i) { return r.d[i] + r.d[3] * d.d[i]; }, most);
  }
}

template <class Op>
Steep pulled_back(const float* c, const Steep& d, const Point<Steep>& q, const Point<Interval>& p) {
  const Op op = load_op<Op>(c);
  double stretch = 0;
  if constexpr (requires { op.stretch(p); }) {
    stretch = op.stretch(p);
  } else {
    stretch = Steep::joint(q.x, q.y, q.z).most;
  }
  double most = times(most_of(d), stretch);
  const Point<Interval> inside = {q.x.v, q.y.v, q.z.v};
  if constexpr (requires { op.pulled_back(d.d, 1.0, inside, p); }) {
    most = lesser(most, op.pulled_back(d.d, most_of(d), inside, p));
  }
  return steep([&](int i) { return d.d[0] * q.x.d[i] + d.d[1] * q.y.d[i] + d.d[2] * q.z.d[i]; },
               most);
}

std::vector<SlopeOps> make_slope_ops() {
  std::vector<SlopeOps> all(std::tuple_size_v<Families> * kFamilySize);
  each_op([&]<class Op>(int number) {
    SlopeOps& f = all[number];
    if constexpr (Leaf<Op>) f.leaf = leaf_slope<Op>;
    if constexpr (Combination<Op>) f.combine = combined_slope<Op>;
    if constexpr (Range<Op> || Leaves<Op>) f.value = value_slope<Op>;
    if constexpr (Domain<Op>) {
      f.inside = [](const float* c, const Point<Interval>& p) {
        return load_op<Op>(c).inside(variables<3>(p));
      };
      f.pull_back = pulled_back<Op>;
    }
  });
  return all;
}

class SlopeReading {
 public:
  explicit SlopeReading(const Program& program) : program_(program) {}

  double over(const Box& box) {
    values_.reserve(static_cast<std::size_t>(program_.values));
    places_.reserve(static_cast<std::size_t>(program_.points) + 1);
    places_.push_back(variables<3>(intervals(box)));
    for (const Instruction& at : program_.code) step(at);
    return most_of(values_.back());
  }

 private:
  void step(const Instruction& at) {
    static const std::vector<SlopeOps> slope_ops = make_slope_ops();
    const SlopeOps& s = slope_ops[at.op];
    const OpFunctions<Interval>& f = interval_functions()[at.op];
    const float* c = constants_of(program_, at);
    const Point<Interval> here = values_of(places_.back());
    switch (at.step) {
      case Step::leaf: {
        const Point<Interval> p = leaf_point(at, here);
        push(leaf_interval(program_, at, p), s.leaf(c, data_of(program_, at), p));
        break;
      }
      case Step::sample:
        push(leaf_interval(program_, at, here), no_steeper(1));
        break;
      case Step::combine: {
        const Steep b = values_.back();
        values_.pop_back();
        const Steep a = values_.back();
        values_.pop_back();
        push(f.combine(c, a.v, b.v, here), s.combine(c, a, b, here));
        break;
      }
      case Step::enter:
        places_.push_back(s.inside(c, here));
        break;
      case Step::leave: {
        const Point<Steep> inside = places_.back();
        places_.pop_back();
        const Interval value = values_.back().v;
        const Point<Interval> outside = values_of(places_.back());
        const Steep d = s.pull_back(c, values_.back(), inside, outside);
        values_.pop_back();
        push(value, d);
        if (f.value != nullptr) change(at, f, s, c);
        break;
      }
      case Step::range:
        change(at, f, s, c);
        break;
    }
  }
  void change(const Instruction& at, const OpFunctions<Interval>& f, const SlopeOps& s,
              const float* c) {
    const Steep d = values_.back();
    values_.pop_back();
    const Data data = data_of(program_, at);
    const Point<Interval> here = values_of(places_.back());
    push(f.value(c, data, d.v, here), s.value(c, data, d, here));
  }
  void push(const Interval& value, const Steep& derivatives) {
    values_.push_back(derivatives);
    values_.back().v = value;
  }
  static Point<Interval> values_of(const Point<Steep>& p) { return {p.x.v, p.y.v, p.z.v}; }

  const Program& program_;
  std::vector<Steep> values_;
  std::vector<Point<Steep>> places_;
};

struct Cell {
  double slope;
  Box box;
  bool operator<(const Cell& other) const { return slope < other.slope; }
};

Box child(const Box& box, int octant) {
  Box r = box;
  const glm::dvec3 middle = box.center();
  for (int a = 0; a < 3; ++a) ((octant >> a & 1) != 0 ? r.lo : r.hi)[a] = middle[a];
  return r;
}

}  // namespace

double slope_over(const Program& program, const Box& box) {
  return SlopeReading(program).over(box);
}

Steepest refined_slope(const Program& program, const Box& box) {
  constexpr int kSplits = 400;
  constexpr double kGain = 1.02;  // within this of a point's own slope nothing is left to gain
  std::priority_queue<Cell> cells;
  cells.push({slope_over(program, box), box});
  double attained = 0;  // the bound over some single point
  for (int i = 0; i < kSplits; ++i) {
    const Cell worst = cells.top();
    const glm::dvec3 middle = worst.box.center();
    attained = std::fmax(attained, slope_over(program, {middle, middle}));
    if (worst.slope <= attained * kGain) break;
    cells.pop();
    for (int octant = 0; octant < 8; ++octant) {
      const Box part = child(worst.box, octant);
      cells.push({std::fmin(worst.slope, slope_over(program, part)), part});
    }
  }
  return {cells.top().slope, cells.top().box};
}

}  // namespace sdfgrid
