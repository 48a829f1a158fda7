// Leaves by their definitions.
#include <algorithm>
#include <cmath>
#include <map>
#include <random>

#include "field/solids.h"
#include "sdfgrid/field/formula.h"
#include "sdfgrid/field/formula_code.h"

namespace {

double sq(double v) { return v * v; }

// A Bezier curve of up to four points, by de Casteljau, with places along it.
class Curve {
 public:
  explicit Curve(std::vector<Vec> control) : control_(std::move(control)) {
    const int many = control_.size() == 2 ? 1 : 48;
    for (int i = 0; i <= many; ++i) places_.push_back(at(static_cast<double>(i) / many));
  }

  // The least in the valleys between the places.
  [[nodiscard]] double distance(const Vec& p) const {
    const auto many = static_cast<int>(places_.size()) - 1;
    double least = 1e300;
    for (int i = 0; i <= many; ++i) {
      const int before = std::max(i - 1, 0);
      const int after = std::min(i + 1, many);
      const double d = norm(places_[i] - p);
      if (d > norm(places_[before] - p) || d > norm(places_[after] - p)) continue;
      least = std::fmin(least, valley(1.0 * before / many, 1.0 * after / many, p));
    }
    return least;
  }

 private:
  [[nodiscard]] Vec at(double t) const {
    Vec c[4];
    std::copy(control_.begin(), control_.end(), c);
    for (std::size_t left = control_.size() - 1; left > 0; --left) {
      for (std::size_t i = 0; i < left; ++i) c[i] += (c[i + 1] - c[i]) * t;
    }
    return c[0];
  }
  [[nodiscard]] double valley(double a, double b, const Vec& p) const {
    for (int i = 0; i < 30; ++i) {
      const double u = a + (b - a) / 3;
      const double v = b - (b - a) / 3;
      const bool left = norm(at(u) - p) < norm(at(v) - p);
      (left ? b : a) = left ? v : u;
    }
    return norm(at(0.5 * (a + b)) - p);
  }

  std::vector<Vec> control_;
  std::vector<Vec> places_;
};

// Where the foot of p is within the triangle the height above it, else the nearest of its edges.
double distance_to_triangle(const Vec& a, const Vec& b, const Vec& c, const Vec& p) {
  const auto dot = [](const Vec& u, const Vec& v) { return u.x * v.x + u.y * v.y + u.z * v.z; };
  const Vec u = b - a;
  const Vec v = c - a;
  const double uu = dot(u, u);
  const double uv = dot(u, v);
  const double vv = dot(v, v);
  const double det = uu * vv - uv * uv;
  const double s = (dot(p - a, u) * vv - dot(p - a, v) * uv) / det;
  const double t = (dot(p - a, v) * uu - dot(p - a, u) * uv) / det;
  if (s >= 0 && t >= 0 && s + t <= 1) return norm(p - a - u * s - v * t);
  return std::min(
      {Curve({a, b}).distance(p), Curve({b, c}).distance(p), Curve({c, a}).distance(p)});
}

Inside sphere(const Given& given) {
  return [r = given("radius")](const Vec& p) { return norm(p) < r; };
}
Inside box(const Given& given) {
  return [size = given.vector("size")](const Vec& p) {
    return std::fabs(p.x) < size.x / 2 && std::fabs(p.y) < size.y / 2 &&
           std::fabs(p.z) < size.z / 2;
  };
}
Inside plane(const Given& given) {
  const Vec n = given.vector("normal");
  return [n, d = given("distance") * norm(n)](const Vec& p) {
    return n.x * p.x + n.y * p.y + n.z * p.z < d;
  };
}
Inside torus(const Given& given) {
  return [a = given("major"), b = given("minor")](const Vec& p) {
    return sq(std::hypot(p.x, p.y) - a) + sq(p.z) < sq(b);
  };
}
Inside cylinder(const Given& given) {
  return [r = given("radius"), h = given("height")](const Vec& p) {
    return std::hypot(p.x, p.y) < r && std::fabs(p.z) < h / 2;
  };
}
Inside infinite_cylinder(const Given& given) {
  return [r = given("radius")](const Vec& p) { return std::hypot(p.x, p.y) < r; };
}
Inside cone(const Given& given) {
  return [r = given("radius"), h = given("height")](const Vec& p) {
    return p.z > -h / 2 && std::hypot(p.x, p.y) < r * (h / 2 - p.z) / h;
  };
}
Inside infinite_cone(const Given& given) {
  return [k = std::tan(given("angle") * M_PI / 180)](const Vec& p) {
    return std::hypot(p.x, p.y) < -p.z * k;
  };
}
Inside capsule(const Given& given) {
  return [axis = Curve({given.vector("from"), given.vector("to")}),
          r = given("radius")](const Vec& p) { return axis.distance(p) < r; };
}
Inside lozenge(const Given& given) {
  return [w = given("width"), d = given("depth"), r = given("radius")](const Vec& p) {
    const double x = std::fmax(std::fabs(p.x) - w / 2, 0);
    const double y = std::fmax(std::fabs(p.y) - d / 2, 0);
    return sq(x) + sq(y) + sq(p.z) < sq(r);
  };
}
Inside ellipsoid(const Given& given) {
  return [r = given.vector("radii")](const Vec& p) {
    return sq(p.x / r.x) + sq(p.y / r.y) + sq(p.z / r.z) < 1;
  };
}
Inside superellipsoid(const Given& given) {
  return [r = given.vector("radii"), a = given("p"), b = given("q")](const Vec& at) {
    const double plane = std::pow(std::fabs(at.x / r.x), a) + std::pow(std::fabs(at.y / r.y), a);
    return std::pow(plane, b / a) + std::pow(std::fabs(at.z / r.z), b) < 1;
  };
}
Inside supertorus(const Given& given) {
  return [major = given("major"), minor = given("minor"), a = given("p"),
          b = given("q")](const Vec& at) {
    const double ring =
        std::pow(std::pow(std::fabs(at.x), a) + std::pow(std::fabs(at.y), a), 1 / a) - major;
    return std::pow(std::fabs(ring / minor), b) + std::pow(std::fabs(at.z / minor), b) < 1;
  };
}
Inside triangle(const Given& given) {
  return [a = given.vector("a"), b = given.vector("b"), c = given.vector("c"),
          r = given("radius")](const Vec& p) { return distance_to_triangle(a, b, c, p) < r; };
}
Inside polyhedron(const Given& given) {
  return [planes = given.numbers("planes")](const Vec& p) {
    for (std::size_t i = 0; i < planes.size(); i += 4) {
      const double h = planes[i] * p.x + planes[i + 1] * p.y + planes[i + 2] * p.z;
      if (h >= planes[i + 3]) return false;
    }
    return true;
  };
}
Inside bezier(const Given& given) {
  return [curve = Curve(given.points("points")), r = given("radius")](const Vec& p) {
    return curve.distance(p) < r;
  };
}
Inside points(const Given& given) {
  return [all = given.points("points"), r = given("radius")](const Vec& p) {
    return std::any_of(all.begin(), all.end(), [&](const Vec& q) { return norm(p - q) < r; });
  };
}

// How a blob falls off, from 1 at its centre to 0 at r = 1.
double blob(const std::string& falloff, double r) {
  if (r >= 1) return 0;
  const double q = r * r;
  if (falloff == "wyvill") return 1 - q * q * q * 4 / 9 + q * q * 17 / 9 - q * 22 / 9;
  if (falloff == "linear") return 1 - r;
  if (falloff == "squared") return sq(1 - q);
  if (falloff == "cubed") return std::pow(1 - q, 3);
  if (falloff == "gaussian") return (std::exp(-4 * q) - std::exp(-4.0)) / (1 - std::exp(-4.0));
  return r < 0.5 ? 1 - 2 * q : 2 * sq(1 - r);
}
// Random centres are where the seed puts them: by the same generator.
std::vector<Vec> blob_centers(const Given& given) {
  std::vector<Vec> centers = given.points("points");
  if (!centers.empty()) return centers;
  std::mt19937 random(static_cast<std::uint32_t>(given("seed")));
  const auto unit = [&] { return static_cast<double>(random()) / 2147483648.0 - 1; };
  while (centers.size() < static_cast<std::size_t>(given("count"))) {
    const double x = unit();
    const double y = unit();
    const Vec c(x, y, unit());
    if (norm(c) <= 1) centers.push_back(c * given("size"));
  }
  return centers;
}
Inside metaballs(const Given& given) {
  std::vector<double> radii = given.numbers("radii");
  const std::vector<Vec> centers = blob_centers(given);
  if (radii.empty()) radii = {1};
  if (radii.size() == 1) radii.assign(centers.size(), radii[0]);
  return
      [=, threshold = given("threshold"), falloff = given.text("falloff", "wyvill")](const Vec& p) {
        double sum = 0;
        for (std::size_t i = 0; i < centers.size(); ++i) {
          sum += blob(falloff, norm(p - centers[i]) / radii[i]);
        }
        return sum > threshold;
      };
}

Inside function(const Given& given) {
  const std::vector<float> code = sdfgrid::parse_formula(given.text("f", ""), given("t"), "x");
  return [code, mode = given.text("mode", "revolve_z"), from = given("from"), to = given("to"),
          floor = given("floor"), depth = given("depth")](const Vec& p) {
    const double u = mode == "revolve_z" ? p.z : p.x;
    if (u <= from || u >= to) return false;
    const double f = sdfgrid::ops::run_formula({code.data(), static_cast<int>(code.size())},
                                               sdfgrid::ops::Point<double>{u, 0, 0});
    if (mode == "extrude") return p.y > floor && p.y < f && std::fabs(p.z) < depth / 2;
    return (mode == "revolve_z" ? std::hypot(p.x, p.y) : std::hypot(p.y, p.z)) < f;
  };
}
Inside formula(const Given& given) {
  const std::vector<float> code = sdfgrid::parse_formula(given.text("f", ""), given("t"));
  const std::vector<Vec> corners = given.points("bounds");
  return [code, corners](const Vec& p) {
    for (int a = 0; a < 3 && !corners.empty(); ++a) {
      if ((p[a] < corners[0][a]) == (p[a] < corners[1][a])) return false;
    }
    return sdfgrid::ops::run_formula({code.data(), static_cast<int>(code.size())},
                                     sdfgrid::ops::Point<double>{p.x, p.y, p.z}) < 0;
  };
}
Inside terrain(const Given& given) {
  const NoiseSum noise = {1 / given("size"), given("height"), 2 * (3 - given("dimension")),
                          static_cast<int>(given("octaves")), static_cast<int>(given("seed"))};
  return [noise, cut = given("size") / 2](const Vec& p) { return p.z < noise({p.x, p.y, cut}); };
}

const std::map<std::string, Inside (*)(const Given&)>& makers() {
  static const std::map<std::string, Inside (*)(const Given&)> all = {
      {"sphere", sphere},
      {"box", box},
      {"plane", plane},
      {"torus", torus},
      {"cylinder", cylinder},
      {"infinite_cylinder", infinite_cylinder},
      {"cone", cone},
      {"infinite_cone", infinite_cone},
      {"capsule", capsule},
      {"lozenge", lozenge},
      {"ellipsoid", ellipsoid},
      {"ellipsoid_bound", ellipsoid},
      {"superellipsoid", superellipsoid},
      {"supertorus", supertorus},
      {"triangle", triangle},
      {"polyhedron", polyhedron},
      {"bezier", bezier},
      {"points", points},
      {"metaballs", metaballs},
      {"function", function},
      {"formula", formula},
      {"terrain", terrain},
      {"gdf", faceted_solid},
      {"menger", menger},
      {"sierpinski", sierpinski},
      {"julia", julia},
      {"mandelbrot", mandelbrot},
      {"mandelbulb", mandelbulb},
  };
  return all;
}

}  // namespace

Inside leaf_solid(const ExampleNode& node) {
  const auto found = makers().find(node.word);
  return found == makers().end() ? nullptr : found->second(Given(node));
}
