// Ops of other nodes by their definitions: sets of points, sums of the nodes' distances, points
// mapped back.
#include <algorithm>
#include <cmath>
#include <glm/mat3x3.hpp>
#include <glm/matrix.hpp>
#include <map>

#include "field/solids.h"
#include "sdfgrid/field/formula.h"
#include "sdfgrid/field/formula_code.h"

namespace {

using Value = std::function<double(const Vec&)>;

// The p-norm minimum as Krayer has it, of positive distances only.
double pnorm_least(double a, double b, double p) {
  if (std::fmin(a, b) <= 0) return std::fmin(a, b);
  return std::pow(std::pow(a, -p) + std::pow(b, -p), -1 / p);
}

// The distance of a node as it gives it, in double: what blends, offsets and displacements are
// defined by.
Value value_of(const ExampleNode& node) {
  // The signs of the nodes, and of what becomes of them, by De Morgan's laws.
  struct Signs {
    double first, second, all;
  };
  static const std::map<std::string, Signs> pnorms = {{"pnorm_union", {1, 1, 1}},
                                                      {"pnorm_intersection", {-1, -1, -1}},
                                                      {"pnorm_difference", {-1, 1, -1}}};
  const auto pnorm = pnorms.find(node.word);
  if (pnorm != pnorms.end()) {
    return [a = value_of(node.of.at(0)), b = value_of(node.of.at(1)), p = Given(node)("p"),
            s = pnorm->second](const Vec& at) {
      return s.all * pnorm_least(s.first * a(at), s.second * b(at), p);
    };
  }
  return [field = make_field(node)](const Vec& p) { return field.gradient(p).value; };
}

struct Nodes {
  Given given;
  std::vector<ExampleNode> of;

  [[nodiscard]] Inside inside(std::size_t i = 0) const { return solid_of(of.at(i)); }
  [[nodiscard]] Value value(std::size_t i = 0) const { return value_of(of.at(i)); }
  [[nodiscard]] std::vector<Inside> all() const {
    std::vector<Inside> each;
    for (const ExampleNode& node : of) each.push_back(solid_of(node));
    return each;
  }
};

// Of points that are moved back to where the node has them.
Inside moved(const Nodes& n, const std::function<Vec(const Vec&)>& back) {
  return [inside = n.inside(), back](const Vec& p) { return inside(back(p)); };
}
Vec turned(const Vec& p, int axis, double angle) {
  const int u = (axis + 1) % 3;
  const int v = (axis + 2) % 3;
  Vec q = p;
  q[u] = std::cos(angle) * p[u] - std::sin(angle) * p[v];
  q[v] = std::sin(angle) * p[u] + std::cos(angle) * p[v];
  return q;
}
constexpr double kDegree = M_PI / 180;

Inside join(const Nodes& n) {
  return [all = n.all()](const Vec& p) {
    return std::any_of(all.begin(), all.end(), [&](const Inside& in) { return in(p); });
  };
}
Inside intersection(const Nodes& n) {
  return [all = n.all()](const Vec& p) {
    return std::all_of(all.begin(), all.end(), [&](const Inside& in) { return in(p); });
  };
}
Inside difference(const Nodes& n) {
  return [all = n.all()](const Vec& p) {
    return all[0](p) &&
           std::none_of(all.begin() + 1, all.end(), [&](const Inside& in) { return in(p); });
  };
}
// The smooth minimum as a mixture, less k h (1 - h).
double smooth_least(double a, double b, double k) {
  const double h = std::clamp(0.5 + 0.5 * (b - a) / k, 0.0, 1.0);
  return b + (a - b) * h - k * h * (1 - h);
}
Inside smooth_union(const Nodes& n) {
  return [a = n.value(0), b = n.value(1), k = n.given("k")](const Vec& p) {
    return smooth_least(a(p), b(p), k) < 0;
  };
}
Inside smooth_intersection(const Nodes& n) {
  return [a = n.value(0), b = n.value(1), k = n.given("k")](const Vec& p) {
    return smooth_least(-a(p), -b(p), k) > 0;
  };
}
Inside smooth_difference(const Nodes& n) {
  return [a = n.value(0), b = n.value(1), k = n.given("k")](const Vec& p) {
    return smooth_least(-a(p), b(p), k) > 0;
  };
}
Inside exponential_union(const Nodes& n) {
  return [a = n.value(0), b = n.value(1), k = n.given("k")](const Vec& p) {
    return std::exp(-a(p) / k) + std::exp(-b(p) / k) > 1;
  };
}
// By De Morgan's laws, with distances to complements.
Inside exponential_intersection(const Nodes& n) {
  return [a = n.value(0), b = n.value(1), k = n.given("k")](const Vec& p) {
    return std::exp(a(p) / k) + std::exp(b(p) / k) < 1;
  };
}
Inside exponential_difference(const Nodes& n) {
  return [a = n.value(0), b = n.value(1), k = n.given("k")](const Vec& p) {
    return std::exp(a(p) / k) + std::exp(-b(p) / k) < 1;
  };
}
Inside blend(const Nodes& n) {
  const std::vector<double> r = n.given.numbers("radii");
  return [a = n.value(0), b = n.value(1), first = r.front(), second = r.back(),
          power = n.given("power")](const Vec& p) {
    return std::pow(std::fmax(1 - a(p) / first, 0), power) +
               std::pow(std::fmax(1 - b(p) / second, 0), power) >
           1;
  };
}
Inside morph(const Nodes& n) {
  return [a = n.value(0), b = n.value(1), w = n.given("weight")](const Vec& p) {
    return (1 - w) * a(p) + w * b(p) < 0;
  };
}
Inside spatial_morph(const Nodes& n) {
  const Vec from = n.given.vector("from");
  const Vec way = n.given.vector("to") - from;
  return [a = n.value(0), b = n.value(1), from, way](const Vec& p) {
    const Vec q = p - from;
    const double along = (q.x * way.x + q.y * way.y + q.z * way.z) / (norm(way) * norm(way));
    const double w = std::clamp(along, 0.0, 1.0);
    return (1 - w) * a(p) + w * b(p) < 0;
  };
}
Inside partition(const Nodes& n) {
  const Vec normal = n.given.vector("normal");
  return [a = n.inside(0), b = n.inside(1), normal,
          d = n.given("distance") * norm(normal)](const Vec& p) {
    return normal.x * p.x + normal.y * p.y + normal.z * p.z <= d ? a(p) : b(p);
  };
}
Inside complement(const Nodes& n) {
  return [inside = n.inside()](const Vec& p) { return !inside(p); };
}
Inside offset(const Nodes& n) {
  return [d = n.value(), by = n.given("by")](const Vec& p) { return d(p) < by; };
}
Inside shell(const Nodes& n) {
  return [d = n.value(), half = n.given("thickness") / 2](const Vec& p) {
    return std::fabs(d(p)) < half;
  };
}
Inside noise_displace(const Nodes& n) {
  const NoiseSum noise = {n.given("frequency"), n.given("amplitude"), n.given("beta"),
                          static_cast<int>(n.given("octaves")), static_cast<int>(n.given("seed"))};
  return [d = n.value(), noise](const Vec& p) { return d(p) < noise(p); };
}
Inside formula_displace(const Nodes& n) {
  const std::vector<float> code = sdfgrid::parse_formula(n.given.text("f", ""), n.given("t"));
  return [d = n.value(), code, most = n.given("largest")](const Vec& p) {
    const double f = sdfgrid::ops::run_formula({code.data(), static_cast<int>(code.size())},
                                               sdfgrid::ops::Point<double>{p.x, p.y, p.z});
    return d(p) < std::clamp(f, -most, most);
  };
}

// The quadratic B-spline over samples that repeat, each at the middle of its square.
struct Heights {
  std::vector<double> samples;
  int columns, rows;

  double operator()(double u, double v) const {
    const auto weight = [](double t) {
      const double a = std::fabs(t);
      return a < 0.5 ? 0.75 - a * a : (a < 1.5 ? 0.5 * (1.5 - a) * (1.5 - a) : 0.0);
    };
    const int left = static_cast<int>(std::floor(u));
    const int top = static_cast<int>(std::floor(v));
    double sum = 0;
    for (int j = top - 2; j <= top + 2; ++j) {
      for (int i = left - 2; i <= left + 2; ++i) {
        const int at = (j % rows + rows) % rows * columns + (i % columns + columns) % columns;
        sum += samples[at] * weight(u - i - 0.5) * weight(v - j - 0.5);
      }
    }
    return sum;
  }
};
Inside texture_displace(const Nodes& n) {
  Heights heights = {n.given.numbers("samples"), static_cast<int>(n.given("width")), 0};
  heights.rows = static_cast<int>(heights.samples.size()) / heights.columns;
  const std::vector<double> size = n.given.numbers("size");
  return [d = n.value(), heights, width = size.front(), height = size.back(),
          amplitude = n.given("amplitude"), around = n.given("around")](const Vec& p) {
    const double turn = std::atan2(p.y, p.x) / (2 * M_PI);
    const double u = 0.5 + (around > 0 ? turn : p.x / width);
    const double v = 0.5 - (around > 0 ? p.z : p.y) / height;
    const double fade = around > 0 ? std::fmin(std::hypot(p.x, p.y) / around, 1) : 1;
    return d(p) < amplitude * fade * heights(u * heights.columns, v * heights.rows);
  };
}

Inside translate(const Nodes& n) {
  return moved(n, [by = n.given.vector("by")](const Vec& p) { return p - by; });
}
Inside rotate(const Nodes& n) {
  return moved(n, [by = n.given.vector("by")](const Vec& p) {
    Vec q = p;
    for (const int axis : {2, 1, 0}) q = turned(q, axis, -by[axis] * kDegree);
    return q;
  });
}
Inside scale(const Nodes& n) {
  return moved(n, [by = n.given.vector("by")](const Vec& p) { return p / by; });
}
Inside mirror(const Nodes& n) {
  return moved(n, [planes = n.given.vector("planes")](const Vec& p) {
    Vec q = p;
    for (int a = 0; a < 3; ++a) q[a] = planes[a] > 0.5 ? std::fabs(p[a]) : p[a];
    return q;
  });
}
Inside linear(const Nodes& n) {
  const std::vector<double> m = n.given.numbers("matrix");
  glm::dmat3 columns;
  for (int i = 0; i < 9; ++i) columns[i % 3][i / 3] = m[i];
  return moved(n, [back = glm::inverse(columns)](const Vec& p) { return back * p; });
}
Inside repeat(const Nodes& n) {
  return moved(n, [cell = n.given.vector("cell")](const Vec& p) {
    Vec q = p;
    for (int a = 0; a < 3; ++a) q[a] = cell[a] > 0 ? std::remainder(p[a], cell[a]) : p[a];
    return q;
  });
}
Inside twist(const Nodes& n) {
  return moved(n, [turns = n.given("turns")](const Vec& p) {
    return turned(p, 2, -2 * M_PI * turns * p.z);
  });
}
Inside bend(const Nodes& n) {
  return moved(
      n, [angle = n.given("angle")](const Vec& p) { return turned(p, 2, -angle * kDegree * p.x); });
}
Inside taper(const Nodes& n) {
  const sdfgrid::Box content = make_field(n.of.at(0)).bounds();
  return moved(n, [content, from = n.given("from"), to = n.given("to")](const Vec& p) {
    const double t = std::clamp((p.z - content.lo.z) / content.size().z, 0.0, 1.0);
    const double s = from + (to - from) * t;
    return Vec(p.x / s, p.y / s, p.z);
  });
}
Inside hyperize(const Nodes& n) {
  return moved(n, [e = n.given.vector("exponents"), unit = n.given("unit")](const Vec& p) {
    Vec q;
    for (int a = 0; a < 3; ++a) {
      q[a] = std::copysign(std::pow(std::fabs(p[a]) / unit, e[a]) * unit, p[a]);
    }
    return q;
  });
}

const std::map<std::string, Inside (*)(const Nodes&)>& makers() {
  static const std::map<std::string, Inside (*)(const Nodes&)> all = {
      {"union", join},
      {"intersection", intersection},
      {"difference", difference},
      {"smooth_union", smooth_union},
      {"smooth_intersection", smooth_intersection},
      {"smooth_difference", smooth_difference},
      {"exponential_union", exponential_union},
      {"exponential_intersection", exponential_intersection},
      {"exponential_difference", exponential_difference},
      {"pnorm_union", join},
      {"pnorm_intersection", intersection},
      {"pnorm_difference", difference},
      {"blend", blend},
      {"morph", morph},
      {"spatial_morph", spatial_morph},
      {"partition", partition},
      {"complement", complement},
      {"offset", offset},
      {"shell", shell},
      {"noise_displace", noise_displace},
      {"formula_displace", formula_displace},
      {"texture_displace", texture_displace},
      {"translate", translate},
      {"rotate", rotate},
      {"scale", scale},
      {"mirror", mirror},
      {"linear", linear},
      {"repeat", repeat},
      {"twist", twist},
      {"bend", bend},
      {"taper", taper},
      {"hyperize", hyperize},
  };
  return all;
}

}  // namespace

Inside combined_solid(const ExampleNode& node) {
  const auto found = makers().find(node.word);
  return found == makers().end() ? nullptr : found->second(Nodes{Given(node), node.of});
}
