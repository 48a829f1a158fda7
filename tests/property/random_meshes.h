// tests/property/random_meshes.h: meshes made in code for tests. Everything returned here is
// closed, consistently oriented (counter-clockwise seen from outside) and free of
// self-intersections unless its comment says otherwise, so inside and outside are never in doubt.
// Randomness is seeded and does not depend on the standard library's distributions.
#pragma once

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <glm/geometric.hpp>
#include <glm/gtc/quaternion.hpp>
#include <glm/mat3x3.hpp>
#include <map>
#include <numbers>
#include <random>
#include <string>
#include <utility>
#include <vector>

#include "sdfgrid/mesh/soup.h"

namespace sdfgrid::shapes {

// A seeded source of numbers; the same sequence on every machine.
class Random {
 public:
  explicit Random(std::uint64_t seed) : engine_(seed) {}

  // In [0, 1).
  double unit() { return static_cast<double>(engine_() >> 11U) * 0x1p-53; }
  double range(double lo, double hi) { return lo + (hi - lo) * unit(); }
  int integer(int lo, int hi) { return lo + static_cast<int>(unit() * (hi - lo + 1)); }
  glm::dvec3 in_box(const glm::dvec3& lo, const glm::dvec3& hi) {
    const double x = unit();
    const double y = unit();
    const double z = unit();
    return lo + (hi - lo) * glm::dvec3(x, y, z);
  }
  glm::dvec3 direction() {
    const double z = range(-1.0, 1.0);
    const double angle = range(0.0, 2.0 * std::numbers::pi);
    const double r = std::sqrt(1.0 - z * z);
    return {r * std::cos(angle), r * std::sin(angle), z};
  }
  glm::dmat3 rotation() {
    const double angle = range(0.0, 2.0 * std::numbers::pi);
    return glm::mat3_cast(glm::angleAxis(angle, direction()));
  }

 private:
  std::mt19937_64 engine_;
};

// ---- shapes -------------------------------------------------------------------------------------

inline TriangleSoup box_mesh(const glm::dvec3& lo, const glm::dvec3& hi) {
  TriangleSoup soup;
  for (int i = 0; i < 8; ++i) {
    soup.points.emplace_back((i & 1) != 0 ? hi.x : lo.x, (i & 2) != 0 ? hi.y : lo.y,
                             (i & 4) != 0 ? hi.z : lo.z);
  }
  soup.triangles = {{0, 2, 1}, {1, 2, 3}, {4, 5, 6}, {5, 7, 6}, {0, 1, 4}, {1, 5, 4},
                    {2, 6, 3}, {3, 6, 7}, {0, 4, 2}, {2, 4, 6}, {1, 3, 5}, {3, 7, 5}};
  return soup;
}

// A square plate across z, `thickness` thick.
inline TriangleSoup plate_mesh(const glm::dvec3& center, double side, double thickness) {
  const glm::dvec3 half = 0.5 * glm::dvec3(side, side, thickness);
  return box_mesh(center - half, center + half);
}

// The corners may come in either orientation; the result is outward.
inline TriangleSoup tetrahedron_mesh(const glm::dvec3& a, const glm::dvec3& b, const glm::dvec3& c,
                                     const glm::dvec3& d) {
  TriangleSoup soup;
  soup.points = {glm::vec3(a), glm::vec3(b), glm::vec3(c), glm::vec3(d)};
  soup.triangles = {{0, 2, 1}, {0, 1, 3}, {1, 2, 3}, {2, 0, 3}};
  if (glm::dot(glm::cross(b - a, c - a), d - a) < 0.0) {
    for (glm::uvec3& t : soup.triangles) std::swap(t.y, t.z);
  }
  return soup;
}

// 20 * 4^level triangles with their corners on the sphere.
inline TriangleSoup icosphere(int level, double radius,
                              const glm::dvec3& center = glm::dvec3(0.0)) {
  const double g = std::numbers::phi;
  std::vector<glm::dvec3> points = {{-1, g, 0}, {1, g, 0}, {-1, -g, 0}, {1, -g, 0},
                                    {0, -1, g}, {0, 1, g}, {0, -1, -g}, {0, 1, -g},
                                    {g, 0, -1}, {g, 0, 1}, {-g, 0, -1}, {-g, 0, 1}};
  std::vector<glm::uvec3> faces = {{0, 11, 5}, {0, 5, 1},  {0, 1, 7},   {0, 7, 10}, {0, 10, 11},
                                   {1, 5, 9},  {5, 11, 4}, {11, 10, 2}, {10, 7, 6}, {7, 1, 8},
                                   {3, 9, 4},  {3, 4, 2},  {3, 2, 6},   {3, 6, 8},  {3, 8, 9},
                                   {4, 9, 5},  {2, 4, 11}, {6, 2, 10},  {8, 6, 7},  {9, 8, 1}};
  for (int l = 0; l < level; ++l) {
    std::map<std::pair<std::uint32_t, std::uint32_t>, std::uint32_t> middles;
    const auto middle = [&](std::uint32_t a, std::uint32_t b) {
      const auto [at, fresh] =
          middles.try_emplace(std::minmax(a, b), static_cast<std::uint32_t>(points.size()));
      if (fresh) points.push_back(0.5 * (glm::normalize(points[a]) + glm::normalize(points[b])));
      return at->second;
    };
    std::vector<glm::uvec3> finer;
    for (const glm::uvec3& t : faces) {
      const std::uint32_t ab = middle(t.x, t.y);
      const std::uint32_t bc = middle(t.y, t.z);
      const std::uint32_t ca = middle(t.z, t.x);
      finer.insert(finer.end(), {{t.x, ab, ca}, {ab, t.y, bc}, {ca, bc, t.z}, {ab, bc, ca}});
    }
    faces = std::move(finer);
  }
  TriangleSoup soup;
  for (const glm::dvec3& p : points) {
    soup.points.emplace_back(center + radius * glm::normalize(p));
  }
  soup.triangles = std::move(faces);
  return soup;
}

// A torus about z, 2 * around * across triangles.
inline TriangleSoup torus_mesh(double major, double minor, int around = 24, int across = 12,
                               const glm::dvec3& center = glm::dvec3(0.0)) {
  TriangleSoup soup;
  for (int i = 0; i < around; ++i) {
    const double u = 2.0 * std::numbers::pi * i / around;
    for (int j = 0; j < across; ++j) {
      const double v = 2.0 * std::numbers::pi * j / across;
      const double r = major + minor * std::cos(v);
      const glm::dvec3 p(r * std::cos(u), r * std::sin(u), minor * std::sin(v));
      soup.points.emplace_back(center + p);
    }
  }
  const auto at = [&](int i, int j) {
    return static_cast<std::uint32_t>((i % around) * across + j % across);
  };
  for (int i = 0; i < around; ++i) {
    for (int j = 0; j < across; ++j) {
      soup.triangles.emplace_back(at(i, j), at(i + 1, j), at(i + 1, j + 1));
      soup.triangles.emplace_back(at(i, j), at(i + 1, j + 1), at(i, j + 1));
    }
  }
  return soup;
}

// ---- changes ------------------------------------------------------------------------------------

// All triangles of both, in the first one's origin. The caller keeps them from crossing.
inline TriangleSoup joined(TriangleSoup a, const TriangleSoup& b) {
  const auto base = static_cast<std::uint32_t>(a.points.size());
  const glm::dvec3 shift = b.origin - a.origin;
  for (std::uint32_t i = 0; i < b.points.size(); ++i) a.points.emplace_back(b.local(i) + shift);
  for (const glm::uvec3& t : b.triangles) a.triangles.push_back(t + base);
  return a;
}

// The same surface, inside out.
inline TriangleSoup flipped(TriangleSoup soup) {
  for (glm::uvec3& t : soup.triangles) std::swap(t.y, t.z);
  return soup;
}

// Without the triangles [first, first + count): no longer closed.
inline TriangleSoup with_hole(TriangleSoup soup, std::size_t first, std::size_t count) {
  const auto from = soup.triangles.begin() + static_cast<std::ptrdiff_t>(first);
  soup.triangles.erase(from, from + static_cast<std::ptrdiff_t>(count));
  return soup;
}

// Points become matrix * point, in local coordinates (the origin stays).
inline TriangleSoup transformed(TriangleSoup soup, const glm::dmat3& matrix) {
  for (glm::vec3& p : soup.points) p = glm::vec3(matrix * glm::dvec3(p));
  return soup;
}

// Scales in local coordinates, origin included.
inline TriangleSoup scaled(TriangleSoup soup, double factor) {
  for (glm::vec3& p : soup.points) p = glm::vec3(factor * glm::dvec3(p));
  soup.origin *= factor;
  return soup;
}

// Moves every point by its own factor in [1 - amount, 1 + amount] along its ray from `center`: what
// was star-shaped about `center` stays so, and free of self-intersections.
inline TriangleSoup perturbed(TriangleSoup soup, Random& random, double amount,
                              const glm::dvec3& center = glm::dvec3(0.0)) {
  for (glm::vec3& p : soup.points) {
    p = glm::vec3(center + random.range(1.0 - amount, 1.0 + amount) * (glm::dvec3(p) - center));
  }
  return soup;
}

// A sphere with a spherical hole: the inner shell faces the hollow.
inline TriangleSoup nested_shells(int level, double outer, double inner) {
  return joined(icosphere(level, outer), flipped(icosphere(level, inner)));
}

// Two spheres of one radius side by side along x, `gap` apart (more at level 0: no corner is
// there).
inline TriangleSoup two_spheres(int level, double radius, double gap) {
  const glm::dvec3 offset(radius + 0.5 * gap, 0.0, 0.0);
  return joined(icosphere(level, radius, -offset), icosphere(level, radius, offset));
}

// Triangles with corners anywhere in [-1, 1]^3: open, crossing, oriented at random.
inline TriangleSoup random_triangles(std::size_t count, std::uint64_t seed, double size = 0.3) {
  Random random(seed);
  TriangleSoup soup;
  for (std::size_t i = 0; i < count; ++i) {
    const glm::dvec3 center = random.in_box(glm::dvec3(size - 1.0), glm::dvec3(1.0 - size));
    const auto base = static_cast<std::uint32_t>(soup.points.size());
    for (int k = 0; k < 3; ++k) {
      soup.points.emplace_back(center + size * random.in_box(glm::dvec3(-1.0), glm::dvec3(1.0)));
    }
    soup.triangles.emplace_back(base, base + 1, base + 2);
  }
  return soup;
}

// ---- a seeded stream of closed meshes -----------------------------------------------------------

struct NamedMesh {
  std::string name;  // says how it was made, for a failing test's message
  TriangleSoup soup;
};

// A shape of size about 1 near its local zero.
inline NamedMesh random_unit_mesh(Random& random) {
  const int level = random.integer(0, 4);
  const std::string l = std::to_string(level);
  switch (random.integer(0, 7)) {
    case 0:
      return {"icosphere " + l, icosphere(level, 1.0)};
    case 1:
      return {"perturbed icosphere " + l, perturbed(icosphere(level, 1.0), random, 0.1)};
    case 2:
      return {"torus", torus_mesh(0.7, random.range(0.1, 0.3), random.integer(5, 40),
                                  random.integer(4, 20))};
    case 3: {
      const glm::dvec3 half = random.in_box(glm::dvec3(0.2), glm::dvec3(1.0));
      return {"box", box_mesh(-half, half)};
    }
    case 4: {
      const glm::dvec3 apex(0.0, 0.0, random.range(0.3, 1.0));
      return {"tetrahedron",
              tetrahedron_mesh({1.0, 0.0, -0.3}, {-0.5, 0.8, -0.3}, {-0.5, -0.8, -0.3}, apex)};
    }
    case 5:
      return {"nested shells " + l, nested_shells(level, 1.0, random.range(0.3, 0.6))};
    case 6:
      return {"two spheres " + l, two_spheres(level, 0.5, 0.1)};
    default:
      return {"plate", plate_mesh(glm::dvec3(0.0), 1.5, random.range(0.01, 0.1))};
  }
}

// One closed mesh: a random shape, rotated, scaled by 1e-6, 1 or 1e6, with its origin at zero or
// about 1e6 of its own sizes away.
inline NamedMesh random_closed_mesh(Random& random) {
  NamedMesh mesh = random_unit_mesh(random);
  mesh.soup = transformed(std::move(mesh.soup), random.rotation());
  constexpr double kScales[] = {1e-6, 1.0, 1e6};
  const double scale = kScales[random.integer(0, 2)];
  mesh.soup = scaled(std::move(mesh.soup), scale);
  mesh.name += ", scale " + std::to_string(scale);
  if (random.integer(0, 1) == 1) {
    mesh.soup.origin = 1e6 * scale * random.direction();
    mesh.name += ", offset";
  }
  return mesh;
}

inline std::vector<NamedMesh> random_closed_meshes(std::uint64_t seed, int count) {
  Random random(seed);
  std::vector<NamedMesh> meshes;
  for (int i = 0; i < count; ++i) {
    meshes.push_back(random_closed_mesh(random));
    meshes.back().name = "#" + std::to_string(i) + " " + meshes.back().name;
  }
  return meshes;
}

}  // namespace sdfgrid::shapes
