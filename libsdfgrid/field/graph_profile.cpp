// Pairs of arcs with common tangents (biarcs) from node to node, bisected until each is near enough
// the function. That is proved by the second derivative of their difference: it is bounded by
// intervals, and at the nodes the difference is known, so that between two of them, h apart, it is
// at most that at the nodes and h^2 / 8 times the second derivative. Where the function has none,
// intervals are bisected to nearly nothing and crossed by segments.
#include "sdfgrid/field/graph_profile.h"

#include <algorithm>
#include <cmath>

#include "sdfgrid/field/dual.h"
#include "sdfgrid/field/formula_code.h"
#include "sdfgrid/field/profile.h"
#include "sdfgrid/field/smooth_interval.h"

namespace sdfgrid {
namespace {

using namespace ops;
using Arc = ProfileArc<double>;
using Jet = Dual<Dual<Interval, 1>, 1>;  // value, derivative and second derivative over an interval

constexpr double kTolerance = 1e-6;
constexpr std::size_t kMostArcs = 32768;

// f(u) with any number type.
template <class T>
[[gnu::noinline]] T run(Data code, const T& u) {
  return run_formula(code, Point<T>{u, T(0.0), T(0.0)});
}

double cross(double ax, double ay, double bx, double by) { return ax * by - ay * bx; }

// The arc from a in the unit direction `along` to b.
Arc arc_to(double ax, double ay, double tx, double ty, double bx, double by) {
  Arc arc{};
  const double x = bx - ax;
  const double y = by - ay;
  const double square = x * x + y * y;
  arc.a[0] = ax;
  arc.a[1] = ay;
  arc.along[0] = tx;
  arc.along[1] = ty;
  arc.b[0] = bx;
  arc.b[1] = by;
  arc.bend = square > 0 ? 2 * cross(tx, ty, x, y) / square : 0;
  arc.leaving[0] = tx - arc.bend * y;
  arc.leaving[1] = ty + arc.bend * x;
  return arc;
}

// Of no length it points up.
Arc segment(double ax, double ay, double bx, double by) {
  const double l = std::hypot(bx - ax, by - ay);
  if (!(l > 0)) return arc_to(ax, ay, 0, 1, bx, by);
  Arc arc = arc_to(ax, ay, (bx - ax) / l, (by - ay) / l, bx, by);
  arc.bend = 0;
  return arc;
}

double rounded(double v) { return static_cast<float>(v); }

// Between points that floats hold, so that one arc ends where the next begins.
Arc rounded(const Arc& arc) {
  const double a[2] = {rounded(arc.a[0]), rounded(arc.a[1])};
  const double b[2] = {rounded(arc.b[0]), rounded(arc.b[1])};
  const double l = std::hypot(b[0] - a[0], b[1] - a[1]);
  const double far =
      std::fmax(std::fabs(a[0]) + std::fabs(a[1]), std::fabs(b[0]) + std::fabs(b[1]));
  if (arc.bend == 0 || l < 3e-6 * far) return segment(a[0], a[1], b[0], b[1]);
  return arc_to(a[0], a[1], rounded(arc.along[0]), rounded(arc.along[1]), b[0], b[1]);
}

// An arc as a function of u.
struct Height {
  double value, slope;
};
Height height(const Arc& arc, double u) {
  const double x = u - arc.a[0];
  const double w = arc.bend * x * x + 2 * arc.along[1] * x;
  const double root = arc.along[0] * arc.along[0] - arc.bend * w;
  const double y = w / (arc.along[0] + std::sqrt(std::fmax(root, 0)));
  return {arc.a[1] + y, (arc.along[1] + arc.bend * x) / (arc.along[0] - arc.bend * y)};
}

class GraphFitter {
 public:
  GraphFitter(Data code, const GraphRange& range) : code_(code), range_(range) {
    // From within: a jump at the very end is none.
    const double far = std::fmax(std::fabs(range.from), std::fabs(range.to));
    range_.from += 4e-15 * far;
    range_.to -= 4e-15 * far;
    point_ = 1e-15 * far;
    tolerance_ = kTolerance * std::fmin(range.to - range.from, range.largest - range.low);
  }

  // False where it cannot be done.
  bool run() {
    double at = value(range_.from);
    // Parts, so that no period of the function falls on all the nodes.
    constexpr int kParts = 7;
    for (int i = 0; i < kParts; ++i) {
      const double a = i == 0 ? range_.from : node(i, kParts);
      const double b = i + 1 == kParts ? range_.to : node(i + 1, kParts);
      const double next = value(b);
      if (!fit(a, at, b, next)) return false;
      at = next;
    }
    end_figure();
    return true;
  }
  std::vector<Arc>& arcs() { return arcs_; }

 private:
  [[nodiscard]] double node(int i, int parts) const {
    return range_.from + (range_.to - range_.from) * i / parts;
  }
  [[nodiscard]] double value(double u) const { return sdfgrid::run(code_, u); }
  [[nodiscard]] double slope(double u) const {
    return sdfgrid::run(code_, Dual<double, 1>::variable(u, 0)).d[0];
  }
  [[nodiscard]] Jet jet(double a, double b) const {
    using D = Dual<Interval, 1>;
    return sdfgrid::run(code_, Jet::variable(D::variable(Interval(a, b), 0), 0));
  }

  // Between two nodes; ya and yb are f there.
  bool fit(double a, double ya, double b, double yb) {
    const SmoothInterval f = sdfgrid::run(code_, SmoothInterval(Interval(a, b)));
    if (f.v.hi <= range_.low) return end_figure();
    const bool finite = std::isfinite(ya) && std::isfinite(yb);
    if (f.is.smooth && finite) {
      const Jet j = jet(a, b);
      if (ya <= range_.low && magnitude(j.v.d[0]) < 1e-30) return end_figure();  // constant
      const double bulge = 0.125 * (b - a) * (b - a) * magnitude(j.d[0].d[0]);
      if (std::fmax(f.v.lo, std::fmin(ya, yb) - bulge) > range_.low && add_biarc(a, ya, b, yb)) {
        return true;
      }
    }
    const double width = b - a;
    // Down there only a point is left: of a jump, or of what an interval takes for one.
    const bool point = width <= point_;
    if ((point && std::isfinite(f.v.lo + f.v.hi)) || width <= 0.5 * tolerance_) {
      if (crosses(point ? hull(ya, yb) : f.v, a, ya, b, yb)) return arcs_.size() < kMostArcs;
    }
    if (point || arcs_.size() > kMostArcs || ++tried_ > 16 * kMostArcs) return false;
    const double middle = 0.5 * (a + b);
    const double ym = value(middle);
    return fit(a, ya, middle, ym) && fit(middle, ym, b, yb);
  }

  // A narrow interval, as a segment: all values between those at the ends are taken.
  bool crosses(const Interval& f, double a, double ya, double b, double yb) {
    const double low = range_.low;
    ya = std::fmax(ya, low);
    yb = std::fmax(yb, low);
    const double slack = std::fmax(0.5 * tolerance_, 4e-6 * magnitude(Interval(ya, yb)));
    const bool between =
        std::fmax(f.lo, low) >= std::fmin(ya, yb) - slack && f.hi <= std::fmax(ya, yb) + slack;
    if (!between || !std::isfinite(ya + yb)) return false;
    if (ya == low && yb == low) return end_figure();
    add(segment(a, ya, b, yb));
    return true;
  }

  bool add_biarc(double a, double ya, double b, double yb) {
    // A little inside, where a kink at the end has this side's slope.
    const double inside = 1e-7 * (b - a);
    const double sa = slope(a + inside);
    const double sb = slope(b - inside);
    if (!std::isfinite(sa + sb)) return false;
    const double la = std::hypot(1, sa);
    const double lb = std::hypot(1, sb);
    const double ta[2] = {1 / la, sa / la};
    const double tb[2] = {1 / lb, sb / lb};
    // Both arcs' tangents of the same length d up to where they meet.
    const double v[2] = {b - a, yb - ya};
    const double along = v[0] * (ta[0] + tb[0]) + v[1] * (ta[1] + tb[1]);
    const double turn = 2 * (1 - ta[0] * tb[0] - ta[1] * tb[1]);
    const double square = v[0] * v[0] + v[1] * v[1];
    const double d = square / (along + std::sqrt(along * along + turn * square));
    if (!(along > 0) || !std::isfinite(d)) return false;
    const double joint[2] = {0.5 * (a + b + d * (ta[0] - tb[0])),
                             0.5 * (ya + yb + d * (ta[1] - tb[1]))};
    if (!(joint[0] > a && joint[0] < b)) return false;
    const Arc first = arc_to(a, ya, ta[0], ta[1], joint[0], joint[1]);
    const Arc second = arc_to(joint[0], joint[1], first.leaving[0], first.leaving[1], b, yb);
    if (!near_graph(first) || !near_graph(second)) return false;
    add(first);
    add(second);
    return true;
  }

  // Whether the arc is within the tolerance of f, proved.
  [[nodiscard]] bool near_graph(const Arc& arc) const {
    if (!(arc.leaving[0] > 0)) return false;
    constexpr int kParts = 4;
    const double from = arc.a[0];
    const double h = (arc.b[0] - from) / kParts;
    double gap[kParts + 1];
    double steep[kParts + 1];
    for (int i = 0; i <= kParts; ++i) {
      const double u = i == kParts ? arc.b[0] : from + i * h;
      const Height at = height(arc, u);
      gap[i] = std::fabs(value(u) - at.value);
      steep[i] = at.slope;
      if (!(gap[i] < 0.9 * tolerance_)) return false;
    }
    for (int i = 0; i < kParts; ++i) {
      const Interval second = jet(from + i * h, from + (i + 1) * h).d[0].d[0];
      // The slope changes in one direction.
      const Interval s = hull(Interval(steep[i]), Interval(steep[i + 1]));
      const Interval one = square(s) + Interval(1);
      const Interval bent = one * sqrt(one) * Interval(arc.bend);
      const double most = std::fmax(gap[i], gap[i + 1]) + 0.125 * h * h * magnitude(second - bent);
      if (!(most <= tolerance_)) return false;
    }
    return true;
  }

  void add(const Arc& arc) {
    if (!open_) {
      open_ = true;
      first_ = arcs_.size();
      const double low = range_.mirrored ? -arc.a[1] : range_.low;
      arcs_.push_back(segment(arc.a[0], low, arc.a[0], arc.a[1]));
    }
    if (!goes_on_straight(arc)) return arcs_.push_back(arc);
    Arc& last = arcs_.back();
    last = segment(last.a[0], last.a[1], arc.b[0], arc.b[1]);
  }

  // Straight pieces become one: bisection makes many on the way to a kink.
  [[nodiscard]] bool goes_on_straight(const Arc& arc) const {
    const Arc& last = arcs_.back();
    const auto sagitta = [](const Arc& a) {
      const double x = a.b[0] - a.a[0];
      const double y = a.b[1] - a.a[1];
      return std::fabs(a.bend) * (x * x + y * y);
    };
    const double l = std::hypot(arc.b[0] - last.a[0], arc.b[1] - last.a[1]);
    const double turn = cross(last.along[0], last.along[1], arc.leaving[0], arc.leaving[1]);
    const bool forwards = last.along[0] * arc.along[0] + last.along[1] * arc.along[1] > 0;
    return forwards && sagitta(last) + sagitta(arc) + l * std::fabs(turn) < 1e-6 * tolerance_;
  }

  // Closes a figure that was begun: down, and where it has a floor back along that.
  bool end_figure() {
    if (!open_) return true;
    open_ = false;
    const double u = arcs_.back().b[0];
    const double r = arcs_.back().b[1];
    const double low = range_.mirrored ? -r : range_.low;
    arcs_.push_back(segment(u, r, u, low));
    if (!range_.mirrored) arcs_.push_back(segment(u, low, arcs_[first_].a[0], low));
    const auto begin = arcs_.begin() + static_cast<std::ptrdiff_t>(first_);
    std::transform(begin, arcs_.end(), begin, [](const Arc& arc) { return rounded(arc); });
    // On the axis the first arc of no length is the point where the figure begins.
    const auto nothing = [](const Arc& arc) {
      return arc.a[0] == arc.b[0] && arc.a[1] == arc.b[1];
    };
    arcs_.erase(std::remove_if(begin + (range_.mirrored ? 1 : 0), arcs_.end(), nothing),
                arcs_.end());
    for (std::size_t i = first_; i < arcs_.size(); ++i) {
      const bool last = i + 1 == arcs_.size();
      Arc& arc = arcs_[i];
      const double* along = !last             ? arcs_[i + 1].along
                            : range_.mirrored ? arc.leaving
                                              : arcs_[first_].along;
      const double x = -arc.leaving[1] - along[1];
      const double y = arc.leaving[0] + along[0];
      const double l = std::hypot(x, y);
      arc.outward[0] = l > 0 ? x / l : 0;
      arc.outward[1] = l > 0 ? y / l : 1;
    }
    return true;
  }

  Data code_;
  GraphRange range_;
  double tolerance_;
  double point_;  // the least width that doubles know
  std::vector<Arc> arcs_;
  std::size_t tried_ = 0;
  std::size_t first_ = 0;  // arc of the figure that is open
  bool open_ = false;
};

struct Rectangle {
  double lo[2] = {1e30, 1e30};
  double hi[2] = {-1e30, -1e30};
  void add(double u, double r) {
    lo[0] = std::fmin(lo[0], u);
    lo[1] = std::fmin(lo[1], r);
    hi[0] = std::fmax(hi[0], u);
    hi[1] = std::fmax(hi[1], r);
  }
};

Rectangle around(const Arc& arc) {
  Rectangle box;
  box.add(arc.a[0], arc.a[1]);
  box.add(arc.b[0], arc.b[1]);
  // Where it is level, if it is so between its ends.
  if (arc.bend != 0 && arc.along[1] * arc.leaving[1] < 0) {
    box.add(arc.b[0], arc.a[1] + (arc.along[0] - 1) / arc.bend);
  }
  return box;
}

// Larger by more than what floats round of the distances to what is in it.
void append_box(std::vector<float>& list, const Rectangle& box, double slack) {
  for (const double v : box.lo) list.push_back(static_cast<float>(v - slack));
  for (const double v : box.hi) list.push_back(static_cast<float>(v + slack));
}

}  // namespace

std::optional<GraphProfile> make_graph_profile(Data code, const GraphRange& range) {
  GraphFitter fitter(code, range);
  GraphProfile made;
  if (range.largest <= range.low) return made;
  if (!fitter.run()) return {};
  const std::vector<Arc>& arcs = fitter.arcs();
  made.count = static_cast<int>(arcs.size());
  if (arcs.empty()) return made;
  while (made.leaves * kProfileLeaf < made.count) made.leaves *= 2;
  std::vector<Rectangle> boxes(static_cast<std::size_t>(2 * made.leaves));
  for (int i = 0; i < made.count; ++i) {
    const Rectangle box = around(arcs[i]);
    Rectangle& leaf = boxes[made.leaves + i / kProfileLeaf];
    leaf.add(box.lo[0], box.lo[1]);
    leaf.add(box.hi[0], box.hi[1]);
  }
  for (int node = made.leaves - 1; node > 0; --node) {
    for (const Rectangle& half : {boxes[2 * node], boxes[2 * node + 1]}) {
      if (half.lo[0] > half.hi[0]) continue;
      boxes[node].add(half.lo[0], half.lo[1]);
      boxes[node].add(half.hi[0], half.hi[1]);
    }
  }
  const Rectangle& all = boxes[1];
  made.from = all.lo[0];
  made.to = all.hi[0];
  made.largest = all.hi[1];
  const double far = std::max(
      {std::fabs(all.lo[0]), std::fabs(all.lo[1]), std::fabs(all.hi[0]), std::fabs(all.hi[1])});
  for (const Rectangle& box : boxes) append_box(made.list, box, 1e-6 * far);
  for (const Arc& arc : arcs) {
    const auto* v = reinterpret_cast<const double*>(&arc);
    made.list.insert(made.list.end(), v, v + Arc::kFloats);
  }
  return made;
}

}  // namespace sdfgrid
