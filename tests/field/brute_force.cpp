#include "field/brute_force.h"

#include <cmath>

Vec random_direction(std::mt19937& random) {
  std::normal_distribution<double> normal(0, 1);
  const Vec v(normal(random), normal(random), normal(random));
  return v / norm(v);
}

Vec random_point(const sdfgrid::Box& box, std::mt19937& random) {
  std::uniform_real_distribution<double> unit(0, 1);
  const Vec t(unit(random), unit(random), unit(random));
  return box.lo + t * box.size();
}

Vec crossing(const Inside& inside, Vec a, Vec b) {
  const bool in = inside(a);
  for (int i = 0; i < 24; ++i) {
    const Vec middle = 0.5 * (a + b);
    (inside(middle) == in ? a : b) = middle;
  }
  return 0.5 * (a + b);
}

namespace {

std::vector<Vec> lattice_crossings(const Inside& inside, const sdfgrid::Box& box, int cells) {
  const Vec step = box.size() / static_cast<double>(cells);
  const int n = cells + 1;
  const int stride[3] = {1, n, n * n};
  std::vector<char> in(static_cast<std::size_t>(n) * n * n);
  const auto at = [&](int i) { return box.lo + step * Vec(i % n, i / n % n, i / (n * n)); };
  const int all = static_cast<int>(in.size());
  for (int i = 0; i < all; ++i) in[i] = inside(at(i)) ? 1 : 0;
  std::vector<Vec> points;
  for (int i = 0; i < all; ++i) {
    for (const int along : stride) {
      if (i / along % n == cells || in[i] == in[i + along]) continue;
      points.push_back(crossing(inside, at(i), at(i + along)));
    }
  }
  return points;
}

}  // namespace

std::vector<Vec> surface_points(const Inside& inside, const sdfgrid::Box& box) {
  // Off the planes of symmetry, where faces would lie between no two nodes.
  const sdfgrid::Box shifted{box.lo - 0.0131 * box.size(), box.hi + 0.0079 * box.size()};
  constexpr int kCells = 16;
  constexpr std::size_t kEnough = 300;
  const std::vector<Vec> found = lattice_crossings(inside, shifted, kCells);
  return found.size() >= kEnough ? found : lattice_crossings(inside, shifted, 4 * kCells);
}

double nearest_found(const Inside& inside, const std::vector<Vec>& surface, const Vec& p,
                     std::mt19937& random) {
  const bool in = inside(p);
  Vec nearest(1e9);
  for (const Vec& q : surface) {
    if (norm(q - p) < norm(nearest - p)) nearest = q;
  }
  double d = norm(nearest - p);
  double around = 2;
  for (int i = 0; i < 60; ++i) {
    const Vec u = (nearest - p) / d + around * random_direction(random);
    const Vec q = p + u * (d * (1 - 1e-7) / norm(u));
    const bool nearer = inside(q) != in;
    around *= nearer ? 1.5 : 0.85;
    if (!nearer) continue;
    nearest = crossing(inside, p, q);
    d = norm(nearest - p);
  }
  return d;
}

bool both_sides_near(const Inside& inside, const Vec& p, double distance, std::mt19937& random) {
  const bool in = inside(p);
  for (int i = 0; i < 300; ++i) {
    if (inside(p + random_direction(random) * distance) != in) return true;
  }
  return false;
}
