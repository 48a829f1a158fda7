// Solids with faces, from their corners, and fractals, by their definitions.
#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <stdexcept>

#include "field/solids.h"

namespace {

double dot(const Vec& u, const Vec& v) { return u.x * v.x + u.y * v.y + u.z * v.z; }
Vec cross(const Vec& u, const Vec& v) {
  return {u.y * v.z - u.z * v.y, u.z * v.x - u.x * v.z, u.x * v.y - u.y * v.x};
}

void add_new(std::vector<Vec>& all, const Vec& v) {
  const bool known =
      std::any_of(all.begin(), all.end(), [&](const Vec& q) { return norm(q - v) < 1e-9; });
  if (!known) all.push_back(v);
}

// With even permutations and all signs; of the tetrahedra those signs alone whose product keeps
// that of the corner.
std::vector<Vec> all_images(const std::vector<Vec>& corners, bool even_signs) {
  std::vector<Vec> all;
  for (const Vec& c : corners) {
    for (int k = 0; k < 24; ++k) {
      const int signs = k / 3;
      if (even_signs && (signs ^ signs >> 1 ^ signs >> 2) % 2 != 0) continue;
      Vec p(c[k % 3], c[(k + 1) % 3], c[(k + 2) % 3]);
      for (int a = 0; a < 3; ++a) p[a] *= (signs >> a & 1) != 0 ? -1 : 1;
      add_new(all, p);
    }
  }
  return all;
}

// The normals of the planes through three corners that have all others behind them; each as long
// as 1 / its distance.
std::vector<Vec> faces_of(const std::vector<Vec>& corners) {
  std::vector<Vec> faces;
  const std::size_t n = corners.size();
  for (std::size_t i = 0; i < n; ++i) {
    for (std::size_t j = i + 1; j < n; ++j) {
      for (std::size_t k = j + 1; k < n; ++k) {
        const Vec across = cross(corners[j] - corners[i], corners[k] - corners[i]);
        const double d = dot(across, corners[i]);
        if (std::fabs(d) < 1e-9) continue;
        const Vec face = across / d;
        const bool outside = std::any_of(corners.begin(), corners.end(),
                                         [&](const Vec& c) { return dot(face, c) > 1 + 1e-9; });
        if (!outside) add_new(faces, face);
      }
    }
  }
  return faces;
}

}  // namespace

std::vector<Vec> solid_corners(const std::string& name) {
  const double g = 0.5 * (1 + std::sqrt(5.0));
  const double s = std::sqrt(2.0) - 1;
  const std::map<std::string, std::vector<Vec>> known = {
      {"tetrahedron", {Vec(-1, -1, -1)}},
      {"cube", {Vec(1, 1, 1)}},
      {"octahedron", {Vec(1, 0, 0)}},
      {"dodecahedron", {Vec(1, 1, 1), Vec(1 / g, 0, g)}},
      {"icosahedron", {Vec(0, 1, g)}},
      {"truncated_tetrahedron", {Vec(-3, -1, -1)}},
      {"truncated_cube", {Vec(1, 1, s)}},
      {"truncated_octahedron", {Vec(0, 1, 2), Vec(0, 2, 1)}},
      {"truncated_dodecahedron", {Vec(0, 2 + g, 1 / g), Vec(1 / g, 2 * g, g), Vec(g, g + 1, 2)}},
      {"truncated_icosahedron", {Vec(0, 1, 3 * g), Vec(1, 2 + g, 2 * g), Vec(g, 2, 2 * g + 1)}}};
  const auto found = known.find(name);
  if (found == known.end()) throw std::runtime_error("no corners of " + name);
  return all_images(found->second, name.find("tetrahedron") != std::string::npos);
}

// The norm of the heights above the faces' planes, in units of how far the nearest of them is.
Inside faceted_solid(const Given& given) {
  std::vector<Vec> faces = faces_of(solid_corners(given.text("solid", "icosahedron")));
  double nearest = 0;
  for (const Vec& f : faces) nearest = std::fmax(nearest, norm(f));
  for (Vec& f : faces) f /= nearest;
  return [faces, v = given("exponent"), r = given("radius")](const Vec& p) {
    double sum = 0;
    for (const Vec& f : faces) {
      const double height = std::fmax(dot(f, p) / r, 0);
      if (v >= 1000) {
        if (height >= 1) return false;
      } else {
        sum += std::pow(height, v);
      }
    }
    return sum < 1;
  };
}

// A cell of each generation is a digit of the coordinates in base three; it is empty where two of
// the three digits are the middle one.
Inside menger(const Given& given) {
  return [edge = given("size"), generations = static_cast<int>(given("iterations"))](const Vec& p) {
    Vec q = p / edge + Vec(0.5);
    for (int a = 0; a < 3; ++a) {
      if (q[a] <= 0 || q[a] >= 1) return false;
    }
    for (int i = 0; i < generations; ++i) {
      int middle = 0;
      for (int a = 0; a < 3; ++a) {
        q[a] *= 3;
        const double digit = std::floor(q[a]);
        middle += digit == 1 ? 1 : 0;
        q[a] -= digit;
      }
      if (middle > 1) return false;
    }
    return true;
  };
}

namespace {

const Vec kTetrahedron[] = {Vec(1, 1, 1), Vec(1, -1, -1), Vec(-1, 1, -1), Vec(-1, -1, 1)};

bool in_sierpinski(const Vec& p, int generations) {
  for (const Vec& c : kTetrahedron) {
    if (dot(c, p) <= -1) return false;  // beyond the face across from that corner
  }
  if (generations == 0) return true;
  return std::any_of(std::begin(kTetrahedron), std::end(kTetrahedron),
                     [&](const Vec& c) { return in_sierpinski(p * 2.0 - c, generations - 1); });
}

using Quaternion = std::array<double, 4>;

Quaternion product(const Quaternion& a, const Quaternion& b) {
  return {a[0] * b[0] - a[1] * b[1] - a[2] * b[2] - a[3] * b[3],
          a[0] * b[1] + a[1] * b[0] + a[2] * b[3] - a[3] * b[2],
          a[0] * b[2] - a[1] * b[3] + a[2] * b[0] + a[3] * b[1],
          a[0] * b[3] + a[1] * b[2] - a[2] * b[1] + a[3] * b[0]};
}
double size_of(const Quaternion& z) {
  return std::sqrt(z[0] * z[0] + z[1] * z[1] + z[2] * z[2] + z[3] * z[3]);
}

// Whether the orbit of z under z^2 + c is within 2 after so many turns, or within what it never
// comes back from if that is more.
bool stays(Quaternion z, const Quaternion& c, int turns) {
  const double reach = std::fmax(2, 0.5 + std::sqrt(0.25 + size_of(c)));
  for (int i = 0; i < turns && size_of(z) < 1e6; ++i) {
    z = product(z, z);
    for (int a = 0; a < 4; ++a) z[a] += c[a];
  }
  return size_of(z) < reach;
}

}  // namespace

Inside sierpinski(const Given& given) {
  return [edge = given("size"), generations = static_cast<int>(given("iterations"))](const Vec& p) {
    return in_sierpinski(p * (2 / edge), generations);
  };
}

Inside julia(const Given& given) {
  const Vec c = given.vector("c");
  return [q = Quaternion{c.x, c.y, c.z, given("w")},
          turns = static_cast<int>(given("iterations"))](const Vec& p) {
    return stays({p.x, p.y, p.z, 0}, q, turns);
  };
}

Inside mandelbrot(const Given& given) {
  return [turns = static_cast<int>(given("iterations"))](const Vec& p) {
    const Quaternion c = {p.x, p.y, p.z, 0};
    return size_of(c) < 2 && stays(c, c, turns);
  };
}

Inside mandelbulb(const Given& given) {
  return [n = given("power"), turns = static_cast<int>(given("iterations"))](const Vec& p) {
    Vec z = p;
    for (int i = 0; i < turns && norm(z) < 1e3; ++i) {
      const double r = std::pow(norm(z), n);
      const double polar = n * std::atan2(std::hypot(z.x, z.y), z.z);
      const double around = n * std::atan2(z.y, z.x);
      z = p + r * Vec(std::sin(polar) * std::cos(around), std::sin(polar) * std::sin(around),
                      std::cos(polar));
    }
    return norm(z) < 2;
  };
}
