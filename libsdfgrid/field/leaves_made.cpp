// Makes the leaves that take lists and choices: polyhedra, generalized distances, curves,
// metaballs.
#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <random>

#include "sdfgrid/field/build.h"
#include "sdfgrid/field/curve.h"
#include "sdfgrid/field/interval.h"
#include "sdfgrid/field/leaf_bounds.h"
#include "sdfgrid/field/leaves_round.h"
#include "sdfgrid/field/leaves_soft.h"

namespace sdfgrid::ops {
namespace {

std::vector<float> floats(const std::vector<double>& v) { return {v.begin(), v.end()}; }

// The point on three planes, if they have one.
bool common_point(const double a[4], const double b[4], const double c[4], glm::dvec3& p) {
  const auto cross = [](const double* u, const double* v) {
    return glm::dvec3(u[1] * v[2] - u[2] * v[1], u[2] * v[0] - u[0] * v[2],
                      u[0] * v[1] - u[1] * v[0]);
  };
  const glm::dvec3 bc = cross(b, c);
  const double volume = a[0] * bc.x + a[1] * bc.y + a[2] * bc.z;
  if (std::fabs(volume) < 1e-9) return false;
  p = (a[3] * bc + b[3] * cross(c, a) + c[3] * cross(a, b)) / volume;
  return true;
}

}  // namespace

Box half_spaces_box(Data planes, double level) {
  constexpr double kFar = 1e7;  // six more planes: a corner out there means that there is no end
  std::vector<std::array<double, 4>> all;
  for (int i = 0; i < planes.count; i += 4) {
    const float* v = planes.values + i;
    all.push_back({v[0], v[1], v[2], v[3] + level});
  }
  for (int a = 0; a < 6; ++a) {
    std::array<double, 4> plane = {0, 0, 0, kFar};
    plane[a / 2] = a % 2 == 0 ? 1 : -1;
    all.push_back(plane);
  }
  Box box;
  for (std::size_t i = 0; i < all.size(); ++i) {
    for (std::size_t j = i + 1; j < all.size(); ++j) {
      for (std::size_t k = j + 1; k < all.size(); ++k) {
        glm::dvec3 p;
        if (!common_point(all[i].data(), all[j].data(), all[k].data(), p)) continue;
        const double slack = 1e-6 * (1 + std::fabs(p.x) + std::fabs(p.y) + std::fabs(p.z));
        const bool inside = std::all_of(all.begin(), all.end(), [&](const auto& q) {
          return q[0] * p.x + q[1] * p.y + q[2] * p.z <= q[3] + slack;
        });
        if (inside) box.add(p);
      }
    }
  }
  for (int a = 0; a < 3 && !box.empty(); ++a) {
    const double slack = 1e-6 * (1 + std::fabs(box.lo[a]) + std::fabs(box.hi[a]));
    box.lo[a] = box.lo[a] < -0.9 * kFar ? -kInfinity : box.lo[a] - slack;
    box.hi[a] = box.hi[a] > 0.9 * kFar ? kInfinity : box.hi[a] + slack;
  }
  return box;
}

Field Polyhedron::make(const std::vector<Argument>& given) {
  const CheckedArguments arguments({&info, parameters}, given);
  std::vector<double> planes = arguments.numbers("planes");
  if (planes.empty() || planes.size() % 4 != 0 || planes.size() > 4 * 64) {
    throw arguments.refused("`planes` needs four numbers a plane, at most 64 planes");
  }
  for (std::size_t i = 0; i < planes.size(); i += 4) {
    const double l = std::hypot(planes[i], planes[i + 1], planes[i + 2]);
    if (!(l > 0)) throw arguments.refused("a plane has the normal 0");
    for (std::size_t a = 0; a < 4; ++a) planes[i + a] /= l;
  }
  return make_leaf(op_number("polyhedron"), {}, floats(planes));
}

namespace {

const double kGolden = 0.5 * (1 + std::sqrt(5.0));

using Normals = std::vector<std::array<double, 3>>;

// One of each opposite pair of faces.
Normals cube_normals() { return {{1, 0, 0}, {0, 1, 0}, {0, 0, 1}}; }
Normals octahedron_normals() { return {{1, 1, 1}, {-1, 1, 1}, {1, -1, 1}, {1, 1, -1}}; }
Normals dodecahedron_normals() {
  const double g = kGolden;
  return {{0, 1, g}, {0, -1, g}, {1, g, 0}, {-1, g, 0}, {g, 0, 1}, {g, 0, -1}};
}
// The corners of that dodecahedron.
Normals icosahedron_normals() {
  const double g = kGolden;
  const double h = 1 / kGolden;
  Normals n = octahedron_normals();
  const Normals rest = {{h, 0, g}, {-h, 0, g}, {0, g, h}, {0, g, -h}, {g, h, 0}, {g, -h, 0}};
  n.insert(n.end(), rest.begin(), rest.end());
  return n;
}

struct Solid {
  const char* name;
  Normals normals;  // 1 / length is a face's distance, that of the nearest 1
  bool two_sided = true;
};

// All faces at the distance 1.
Solid platonic(const char* name, Normals normals, bool two_sided = true) {
  for (auto& n : normals) {
    const double l = std::hypot(n[0], n[1], n[2]);
    for (double& c : n) c /= l;
  }
  return {name, std::move(normals), two_sided};
}

// The faces of one solid, its corners cut by those of another so that both kinds meet at `corner`.
Solid truncated(const char* name, const Solid& whole, const Solid& cut,
                const std::array<double, 3>& corner) {
  const auto distance = [&](const Solid& solid) {
    double largest = 0;
    for (const auto& n : solid.normals) {
      const double d = n[0] * corner[0] + n[1] * corner[1] + n[2] * corner[2];
      largest = std::max(largest, solid.two_sided ? std::fabs(d) : d);
    }
    return largest;
  };
  Solid made = {name, whole.normals, whole.two_sided};
  const double nearer = distance(whole) / distance(cut);  // at most 1
  for (auto n : cut.normals) {
    for (double& c : n) c *= nearer;
    made.normals.push_back(n);
  }
  return made;
}

// Tetrahedra alone have faces without an opposite one. The truncated solids are the uniform ones:
// all their edges are equal.
std::vector<Solid> make_solids() {
  const Normals corners = {{1, 1, 1}, {1, -1, -1}, {-1, 1, -1}, {-1, -1, 1}};
  Normals opposite = corners;
  for (auto& n : opposite) n = {-n[0], -n[1], -n[2]};
  const double g = kGolden;
  const Solid tetrahedron = platonic("tetrahedron", corners, false);
  const Solid cube = platonic("cube", cube_normals());
  const Solid octahedron = platonic("octahedron", octahedron_normals());
  const Solid dodecahedron = platonic("dodecahedron", dodecahedron_normals());
  const Solid icosahedron = platonic("icosahedron", icosahedron_normals());
  return {
      tetrahedron,
      cube,
      octahedron,
      dodecahedron,
      icosahedron,
      truncated("truncated_tetrahedron", tetrahedron, platonic("", opposite, false), {-3, -1, -1}),
      truncated("truncated_cube", cube, octahedron, {1, 1, std::sqrt(2.0) - 1}),
      truncated("truncated_octahedron", octahedron, cube, {0, 1, 2}),
      truncated("truncated_dodecahedron", dodecahedron, icosahedron, {0, 2 + g, 1 / g}),
      truncated("truncated_icosahedron", icosahedron, dodecahedron, {0, 1, 3 * g})};
}

// Refused with all names.
const Solid& solid_named(const CheckedArguments& arguments, const std::string& name) {
  static const std::vector<Solid> solids = make_solids();
  std::string names;
  for (const Solid& solid : solids) {
    if (name == solid.name) return solid;
    names += fmt::format("{}{}", names.empty() ? "" : ", ", solid.name);
  }
  throw arguments.refused(fmt::format("`solid` is `{}`; give one of {}", name, names));
}

// The largest value of the norm on the unit sphere, which is its slope. The norm is convex, so
// following its gradient climbs; from many directions.
double largest_on_sphere(const Normals& normals, double exponent, bool two_sided) {
  std::mt19937 random(1);
  std::uniform_real_distribution<double> unit(-1, 1);
  double largest = 0;
  for (int start = 0; start < 200; ++start) {
    double u[3] = {unit(random), unit(random), unit(random)};
    double value = 0;
    for (int step = 0; step < 200; ++step) {
      const double l = std::hypot(u[0], u[1], u[2]);
      if (!(l > 0)) break;
      double gradient[3] = {};
      double sum = 0;
      for (const auto& n : normals) {
        const double d = (n[0] * u[0] + n[1] * u[1] + n[2] * u[2]) / l;
        if (d < 0 && !two_sided) continue;
        sum += std::pow(std::fabs(d), exponent);
        const double w = std::pow(std::fabs(d), exponent - 1) * (d < 0 ? -1 : 1);
        for (int a = 0; a < 3; ++a) gradient[a] += w * n[a];
      }
      value = std::pow(sum, 1 / exponent);
      std::copy(gradient, gradient + 3, u);
    }
    largest = std::max(largest, value);
  }
  return largest;
}

}  // namespace

namespace {

// The heights above the planes themselves, where the norm has those above farther ones too small.
Field flat_faces(const Normals& normals, bool two_sided, double radius) {
  std::vector<double> planes;
  for (const auto& n : normals) {
    for (const double side : {1.0, -1.0}) {
      if (side < 0 && !two_sided) continue;
      for (const double c : n) planes.push_back(side * c);
      planes.push_back(radius);
    }
  }
  return make_field("polyhedron", {{"planes", planes}});
}

}  // namespace

Field GeneralizedDistance::make(const std::vector<Argument>& given) {
  const CheckedArguments arguments({&info, parameters}, given);
  const auto& [name, normals, two_sided] =
      solid_named(arguments, arguments.text("solid", "icosahedron"));
  const double exponent = std::fmin(arguments.number("exponent"), 1000);  // flat from there on
  if (exponent == 1000) return flat_faces(normals, two_sided, arguments.number("radius"));
  const double slope = largest_on_sphere(normals, exponent, two_sided);
  std::vector<float> list;
  for (const auto& n : normals) {
    for (const double c : n) list.push_back(static_cast<float>(c));
  }
  // A thousandth of a percent for what the climb may have missed.
  const double scale = 1 / (slope * 1.00001);
  return make_leaf(op_number("gdf"),
                   floats({exponent, arguments.number("radius"), two_sided ? 1.0 : 0.0, scale}),
                   list);
}

// The norm is at least its largest term: the solid lies within that of flat faces.
Box GeneralizedDistance::bounds(Data normals, double level) const {
  std::vector<float> planes;
  for (int i = 0; i < normals.count; i += 3) {
    for (const float side : {1.0F, -1.0F}) {
      if (side < 0 && two_sided <= 0) continue;
      for (int a = 0; a < 3; ++a) planes.push_back(side * normals.values[i + a]);
      planes.push_back(radius);
    }
  }
  return half_spaces_box({planes.data(), static_cast<int>(planes.size())},
                         level / static_cast<double>(scale));
}

Field Bezier::make(const std::vector<Argument>& given) {
  const CheckedArguments arguments({&info, parameters}, given);
  const std::vector<double> v = arguments.numbers("points");
  const double r = arguments.number("radius");
  if (v.size() == 12) return make_field(make_cubic_curve(v, r));
  if (v.size() != 9) throw arguments.refused("`points` needs three or four control points");
  Bezier op{};
  double points[3][3];
  double extent = 0;
  for (int i = 0; i < 3; ++i) {
    for (int a = 0; a < 3; ++a) {
      points[i][a] = v[3 * i + a];
      op.control[i][a] = static_cast<float>(v[3 * i + a]);
      extent = std::max(extent, std::fabs(v[3 * i + a] - v[a]));
    }
  }
  op.arc.set(points);
  op.radius = static_cast<float>(r);
  // A parabola that is nearly straight is a capsule: its closed form would divide by little.
  if (op.arc.curve < 1e-8 * extent * extent || extent == 0) {
    return make_field("capsule",
                      {{"from", {v[0], v[1], v[2]}}, {"to", {v[6], v[7], v[8]}}, {"radius", r}});
  }
  const auto* first = reinterpret_cast<const float*>(&op);
  return make_leaf(op_number("bezier"), {first, first + sizeof op / sizeof(float)}, {});
}

// Its ends, and where it turns along an axis.
Box Bezier::bounds(Data, double level) const {
  Box box;
  for (const int end : {0, 2}) box.add({control[end][0], control[end][1], control[end][2]});
  for (int a = 0; a < 3; ++a) {
    const double first = static_cast<double>(control[0][a]) - control[1][a];
    const double second = first - control[1][a] + control[2][a];
    const double t = first / second;
    if (!(t > 0 && t < 1)) continue;
    const double turn = control[0][a] - first * t;
    box.lo[a] = std::fmin(box.lo[a], turn);
    box.hi[a] = std::fmax(box.hi[a], turn);
  }
  // A hair more, for what single precision makes of the curve, and of where it lies.
  double hair = 0;
  for (int a = 0; a < 3; ++a) {
    const double far = std::fmax(std::fabs(box.lo[a]), std::fabs(box.hi[a]));
    hair += 1e-6 * (box.hi[a] - box.lo[a] + far);
  }
  const glm::dvec3 grow(std::fmax(radius + level, 0.0) + hair);
  return {box.lo - grow, box.hi + grow};
}

namespace {

struct NamedFalloff {
  const char* name;
  Falloff falloff;
  double slope;  // the largest derivative
};
// Rounded up; tests sample them.
constexpr NamedFalloff kFalloffs[] = {
    {"wyvill", Falloff::wyvill, 1.583430},     {"linear", Falloff::linear, 1},
    {"squared", Falloff::squared, 1.539601},   {"cubed", Falloff::cubed, 1.717301},
    {"gaussian", Falloff::gaussian, 1.747536}, {"quadratic", Falloff::quadratic, 2}};

std::vector<double> random_centers(const CheckedArguments& arguments) {
  std::mt19937 random(static_cast<std::uint32_t>(arguments.number("seed")));
  const auto unit = [&] { return static_cast<double>(random()) / 2147483648.0 - 1; };
  std::vector<double> v;
  const auto count = static_cast<std::size_t>(arguments.number("count"));
  const double size = arguments.number("size");
  while (v.size() < 3 * count) {
    const double p[3] = {unit(), unit(), unit()};
    if (std::hypot(p[0], p[1], p[2]) > 1) continue;
    for (const double c : p) v.push_back(c * size);
  }
  return v;
}

// The largest sum of 1 / radius over blobs that meet one of them: all blobs at a point meet.
double largest_overlap(const std::vector<float>& blobs) {
  double largest = 0;
  for (std::size_t i = 0; i < blobs.size(); i += 4) {
    double sum = 0;
    for (std::size_t j = 0; j < blobs.size(); j += 4) {
      const double d =
          std::hypot(blobs[i] - blobs[j], blobs[i + 1] - blobs[j + 1], blobs[i + 2] - blobs[j + 2]);
      if (d < 1.0 / blobs[i + 3] + 1.0 / blobs[j + 3]) sum += blobs[j + 3];
    }
    largest = std::max(largest, sum);
  }
  return largest;
}

}  // namespace

Field Metaballs::make(const std::vector<Argument>& given) {
  const CheckedArguments arguments({&info, parameters}, given);
  const std::vector<double> centers =
      arguments.has("points") ? arguments.numbers("points") : random_centers(arguments);
  std::vector<double> radii = arguments.numbers("radii");
  if (centers.empty()) throw arguments.refused("`points` is empty");
  const std::size_t n = centers.size() / 3;
  if (radii.empty()) radii = {1};
  if (radii.size() == 1) radii.assign(n, radii[0]);
  if (radii.size() != n) {
    throw arguments.refused(fmt::format("`radii` has {} numbers for {} points", radii.size(), n));
  }
  const std::string name = arguments.text("falloff", "wyvill");
  const auto* falloff = std::find_if(std::begin(kFalloffs), std::end(kFalloffs),
                                     [&](const NamedFalloff& f) { return name == f.name; });
  if (falloff == std::end(kFalloffs)) {
    throw arguments.refused(fmt::format(
        "`falloff` is `{}`; give wyvill, linear, squared, cubed, gaussian or quadratic", name));
  }
  std::vector<float> blobs;
  for (std::size_t i = 0; i < n; ++i) {
    for (std::size_t a = 0; a < 3; ++a) blobs.push_back(static_cast<float>(centers[3 * i + a]));
    blobs.push_back(static_cast<float>(1 / radii[i]));
  }
  const double scale = 1 / (falloff->slope * largest_overlap(blobs));
  return make_leaf(
      op_number("metaballs"),
      floats({arguments.number("threshold"), static_cast<double>(falloff->falloff), scale}), blobs);
}

// Beyond a plane no blob is larger than where it is nearest to it.
Box Metaballs::bounds(Data blobs, double level) const {
  Box box;
  for (int axis = 0; axis < 3; ++axis) {
    for (const double side : {-1.0, 1.0}) {
      const auto lowest = [&](double c) {
        double sum = 0;
        double beyond = kInfinity;
        for (int i = 0; i < blobs.count; i += 4) {
          const double r = std::fmax(c - side * blobs.values[i + axis], 0);
          sum += blob(r * blobs.values[i + 3]);
          beyond = std::fmin(beyond, r - 1.0 / blobs.values[i + 3]);
        }
        return std::fmax((threshold - sum) * scale, beyond);
      };
      (side < 0 ? box.lo : box.hi)[axis] = side * first_excluded(lowest, level);
    }
    if (box.lo[axis] > box.hi[axis]) return {};
  }
  return box;
}

}  // namespace sdfgrid::ops
