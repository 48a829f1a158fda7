// The Lipschitz reading of a program: of each value its interval over the box and a bound on its
// gradient, of each point how far the maps above it stretch a vector. What an op contributes is
// known by proof (1-Lipschitz leaves, convex combinations), in closed form (stretch, slope), or
// comes from its formula over intervals with derivatives.
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

struct Steep {
  Interval value;
  double slope;  // bound on |grad value| in world space
};
struct Place {
  Point<Interval> p;
  double stretch;  // bound on |dp/dworld|
};

// How one op changes slopes.
struct SlopeOps {
  double (*leaf)(const float* c, Data data, const Point<Interval>& p) = nullptr;
  double (*combine)(const float* c, const Steep& a, const Steep& b, const Place& at) = nullptr;
  double (*value)(const float* c, Data data, const Steep& d, const Place& at) = nullptr;
  double (*stretch)(const float* c, const Point<Interval>& p) = nullptr;
};

template <int N>
Point<Dual<Interval, N>> variables(const Point<Interval>& p, int first) {
  using D = Dual<Interval, N>;
  return {D::variable(p.x, first), D::variable(p.y, first + 1), D::variable(p.z, first + 2)};
}

// 0 * infinity is 0 here: what is not used may be as steep as it likes.
double times(double a, double b) { return product(a, b); }

template <class Op>
double leaf_slope(const float* c, Data data, const Point<Interval>& p) {
  if constexpr (Op::info.guarantee != OpGuarantee::computed) {
    return 1;
  } else {
    return leaf_value(load_op<Op>(c), variables<3>(p, 0), data).steepness.most;
  }
}

template <class Op>
double combined_slope(const float* c, const Steep& a, const Steep& b, const Place& at) {
  const Op op = load_op<Op>(c);
  if constexpr (requires { Op::kConvex; }) {
    const Keep keep = op.keep(a.value, b.value);
    if (keep != Keep::both) return keep == Keep::first ? a.slope : b.slope;
    return std::fmax(a.slope, b.slope);
  } else if constexpr (requires { op.slope(a.value, 1.0, b.value, 1.0, at.p, 1.0); }) {
    return op.slope(a.value, a.slope, b.value, b.slope, at.p, at.stretch);
  } else {
    using D = Dual<Interval, 5>;
    const D r = op.combine(D::variable(a.value, 3), D::variable(b.value, 4), variables<5>(at.p, 0));
    return times(magnitude(r.d[3]), a.slope) + times(magnitude(r.d[4]), b.slope) +
           times(norm(r.d.data(), 3), at.stretch);
  }
}

template <class Op>
double value_slope(const float* c, Data data, const Steep& d, const Place& at) {
  const Op op = load_op<Op>(c);
  if constexpr (requires { Op::kConvex; }) {
    return d.slope;
  } else if constexpr (requires { op.slope(d.value, d.slope, at.p); }) {
    return op.slope(d.value, d.slope, at.p);
  } else if constexpr (requires { op.slope(d.value, d.slope, at.p, at.stretch); }) {
    return op.slope(d.value, d.slope, at.p, at.stretch);
  } else {
    using D = Dual<Interval, 4>;
    const D r = changed_value(op, D::variable(d.value, 3), variables<4>(at.p, 0), data);
    return times(magnitude(r.d[3]), d.slope) + times(norm(r.d.data(), 3), at.stretch);
  }
}

template <class Op>
double map_stretch(const float* c, const Point<Interval>& p) {
  const Op op = load_op<Op>(c);
  if constexpr (requires { op.stretch(p); }) {
    return op.stretch(p);
  } else {
    const auto q = op.inside(variables<3>(p, 0));
    return Dual<Interval, 3>::joint(q.x, q.y, q.z).most;
  }
}

std::vector<SlopeOps> make_slope_ops() {
  std::vector<SlopeOps> all(std::tuple_size_v<Families> * kFamilySize);
  each_op([&]<class Op>(int number) {
    SlopeOps& f = all[number];
    if constexpr (Leaf<Op>) f.leaf = leaf_slope<Op>;
    if constexpr (Combination<Op>) f.combine = combined_slope<Op>;
    if constexpr (Range<Op> || Leaves<Op>) f.value = value_slope<Op>;
    if constexpr (Domain<Op>) f.stretch = map_stretch<Op>;
  });
  return all;
}

class SlopeReading {
 public:
  explicit SlopeReading(const Program& program) : program_(program) {}

  double over(const Box& box) {
    places_.push_back({intervals(box), 1});
    for (const Instruction& at : program_.code) step(at);
    return values_.back().slope;
  }

 private:
  void step(const Instruction& at) {
    static const std::vector<SlopeOps> slope_ops = make_slope_ops();
    const SlopeOps& s = slope_ops[at.op];
    const OpFunctions<Interval>& f = interval_functions()[at.op];
    const float* c = constants_of(program_, at);
    const Place here = places_.back();
    switch (at.step) {
      case Step::leaf: {
        const Point<Interval> p = leaf_point(at, here.p);
        values_.push_back({leaf_interval(program_, at, p),
                           times(s.leaf(c, data_of(program_, at), p), here.stretch)});
      } break;
      case Step::sample:
        values_.push_back({leaf_interval(program_, at, here.p), here.stretch});
        break;
      case Step::combine: {
        const Steep b = values_.back();
        values_.pop_back();
        Steep& a = values_.back();
        a = {f.combine(c, a.value, b.value, here.p), s.combine(c, a, b, here)};
        break;
      }
      case Step::enter:
        places_.push_back({f.inside(c, here.p), times(here.stretch, s.stretch(c, here.p))});
        break;
      case Step::leave:
        places_.pop_back();
        if (f.value != nullptr) change(at, f, s, c);
        break;
      case Step::range:
        change(at, f, s, c);
        break;
    }
  }
  void change(const Instruction& at, const OpFunctions<Interval>& f, const SlopeOps& s,
              const float* c) {
    Steep& d = values_.back();
    const Data data = data_of(program_, at);
    d = {f.value(c, data, d.value, places_.back().p), s.value(c, data, d, places_.back())};
  }

  const Program& program_;
  std::vector<Steep> values_;
  std::vector<Place> places_;
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
