// Whose surface is hit: random trees of coloured leaves, whose own distances in double say which
// leaf it must be and where it faces.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <glm/common.hpp>
#include <glm/geometric.hpp>
#include <glm/mat3x3.hpp>
#include <glm/trigonometric.hpp>
#include <random>
#include <vector>

#include "sdfgrid/trace/field_seen.h"
#include "sdfgrid/trace/field_trace.h"

namespace sdfgrid {
namespace {

struct Leaf {
  std::function<double(const glm::dvec3&)> distance;  // of a point of the whole
  bool turned;                                        // its inside is taken away
};

double box_distance(const glm::dvec3& p, const glm::dvec3& half) {
  const glm::dvec3 q = glm::abs(p) - half;
  return glm::length(glm::max(q, 0.0)) + std::min(std::max({q.x, q.y, q.z}), 0.0);
}
double torus_distance(const glm::dvec3& p, double major, double minor) {
  return std::hypot(std::hypot(p.x, p.y) - major, p.z) - minor;
}

// From the whole's space to a node's: p -> scale * rotation * p + shift, lengths by `scale`.
struct Place {
  glm::dmat3 rotation{1.0};
  glm::dvec3 shift{0.0};
  double scale = 1;

  [[nodiscard]] glm::dvec3 operator()(const glm::dvec3& p) const {
    return scale * (rotation * p) + shift;
  }
};

class RandomTree {
 public:
  explicit RandomTree(std::uint32_t seed) : random_(seed) {
    // Ends: a complement alone would not.
    const Field inner = node(Place(), false, 3);
    const Field room = leaf(Place(), false, 1);
    field = make_field("intersection", {}, {inner, room});
  }

  Field field;  // leaf i carries mark i
  std::vector<Leaf> leaves;

 private:
  double unit() { return std::uniform_real_distribution<double>(0, 1)(random_); }

  Field leaf(const Place& at, bool turned, int kind) {
    const double r = 0.4 + 0.6 * unit();
    const bool room = kind == 1;
    const glm::dvec3 half = room ? glm::dvec3(1.4, 1.3, 1.2) : glm::dvec3(r, 0.8 * r, 0.6 * r);
    Field made;
    std::function<double(const glm::dvec3&)> own;
    switch (kind % 3) {
      case 0:
        made = make_field("sphere", {{"radius", r}});
        own = [r](const glm::dvec3& p) { return glm::length(p) - r; };
        break;
      case 1:
        made = make_field("box", {{"size", {2 * half.x, 2 * half.y, 2 * half.z}}});
        own = [half](const glm::dvec3& p) { return box_distance(p, half); };
        break;
      default:
        made = make_field("torus", {{"major", r}, {"minor", 0.3 * r}});
        own = [r](const glm::dvec3& p) { return torus_distance(p, r, 0.3 * r); };
    }
    leaves.push_back({[own, at](const glm::dvec3& p) { return own(at(p)) / at.scale; }, turned});
    return made.tagged(static_cast<int>(leaves.size()) - 1);
  }

  Field moved(const Place& at, bool turned, int depth) {
    const glm::dvec3 by(1.6 * unit() - 0.8, 1.6 * unit() - 0.8, 1.6 * unit() - 0.8);
    const double angle = 360 * unit();
    const double scale = 0.7 + 0.5 * unit();
    const double c = std::cos(glm::radians(angle));
    const double s = std::sin(glm::radians(angle));
    const glm::dmat3 back(c, -s, 0, s, c, 0, 0, 0, 1);  // columns: turns by -angle about z
    const Place inner{back * at.rotation, back * ((at.shift - by) / scale), at.scale / scale};
    const Field content = node(inner, turned, depth - 1);
    const Field scaled = make_field("scale", {{"by", {scale, scale, scale}}}, {content});
    const Field rotated = make_field("rotate", {{"by", {0, 0, angle}}}, {scaled});
    return make_field("translate", {{"by", {by.x, by.y, by.z}}}, {rotated});
  }

  Field node(const Place& at, bool turned, int depth) {
    if (depth == 0) return leaf(at, turned, 3 + static_cast<int>(random_() % 3));
    switch (random_() % 6) {
      case 0:
        return make_field("complement", {}, {moved(at, !turned, depth)});
      case 1:
        return make_field(
            "difference", {},
            {moved(at, turned, depth), moved(at, !turned, depth), moved(at, !turned, depth)});
      case 2:
        return make_field("intersection", {}, {moved(at, turned, depth), moved(at, turned, depth)});
      default:
        return make_field(
            "union", {},
            {moved(at, turned, depth), moved(at, turned, depth), moved(at, turned, depth)});
    }
  }

  std::mt19937 random_;
};

glm::dvec3 slope(const std::function<double(const glm::dvec3&)>& f, const glm::dvec3& p) {
  constexpr double kStep = 1e-5;
  glm::dvec3 g;
  for (int a = 0; a < 3; ++a) {
    glm::dvec3 h(0.0);
    h[a] = kStep;
    g[a] = (f(p + h) - f(p - h)) / (2 * kStep);
  }
  return g;
}

class CsgSurface {
 public:
  // At the hits of a picture, but for those near the edges between two leaves.
  void check(const RandomTree& tree) {
    const Box region{glm::dvec3(-1.5), glm::dvec3(1.5)};
    const Camera camera = frame(region, 24, 24);
    const FieldTracer tracer(tree.field, region);
    const SeenField seen(tracer, std::vector<Material>(tree.leaves.size()), Material(), 1e-5);
    const RayGenerator generator(camera);
    std::vector<Ray> rays;
    rays.reserve(24 * 24);
    for (int y = 0; y < 24; ++y) {
      for (int x = 0; x < 24; ++x) rays.push_back(generator.ray(x + 0.5, y + 0.5));
    }
    std::vector<float> depth(rays.size());
    seen.trace(rays, depth);
    std::vector<glm::dvec3> points;
    for (std::size_t i = 0; i < rays.size(); ++i) {
      if (!std::isfinite(depth[i])) continue;
      points.push_back(rays[i].origin + double(depth[i]) * rays[i].direction);
    }
    std::vector<glm::vec3> normals(points.size());
    std::vector<Material> materials(points.size());
    seen.describe(points, normals, materials);
    for (std::size_t i = 0; i < points.size(); ++i) {
      check(tree, points[i], camera.eye, glm::dvec3(normals[i]), materials[i].index - 1);
    }
  }

  int checked = 0;
  int edges = 0;
  int turned = 0;

 private:
  void check(const RandomTree& tree, const glm::dvec3& p, const glm::dvec3& eye,
             const glm::dvec3& normal, int found) {
    constexpr double kNear = 1e-3;  // farther than a hit may be off
    std::vector<int> near;
    for (std::size_t i = 0; i < tree.leaves.size(); ++i) {
      if (std::fabs(tree.leaves[i].distance(p)) < kNear) near.push_back(static_cast<int>(i));
    }
    ASSERT_FALSE(near.empty()) << "a hit on no leaf";
    if (near.size() > 1) {
      ++edges;
      return;
    }
    ++checked;
    ASSERT_EQ(found, near.front());
    const Leaf& leaf = tree.leaves[static_cast<std::size_t>(found)];
    turned += leaf.turned ? 1 : 0;
    const glm::dvec3 g = (leaf.turned ? -1.0 : 1.0) * slope(leaf.distance, p);
    if (std::fabs(glm::length(g) - 1) > 1e-4) return;  // across a leaf's own edge
    ASSERT_GT(glm::dot(normal, g), 0.999) << "leaf " << found << (leaf.turned ? ", turned" : "");
    // A hit is up to the tolerance before the surface, and so a little beyond where rays graze it.
    ASSERT_GT(glm::dot(normal, glm::normalize(eye - p)), -0.05);
  }
};

TEST(CsgSurfaces, BringTheirMaterialAndNormal) {
  CsgSurface surface;
  for (std::uint32_t seed = 0; seed < 200 && !testing::Test::HasFatalFailure(); ++seed) {
    SCOPED_TRACE(seed);
    surface.check(RandomTree(seed));
  }
  EXPECT_GT(surface.checked, 10000);
  EXPECT_GT(surface.turned, 1000);
  EXPECT_LT(surface.edges, surface.checked / 20);
}

TEST(CsgSurfaces, OfPartitionsAndMorphsAreThoseOfTheNodeThatIsThere) {
  const Field large = make_field("sphere", {{"radius", 1}}).tagged(0);
  const Field small = make_field("sphere", {{"radius", 0.7}}).tagged(1);
  const Field cut = make_field("partition", {{"normal", {1, 0, 0}}}, {large, small});
  std::mt19937 random(5);
  std::normal_distribution<double> any;
  for (int i = 0; i < 1000; ++i) {
    const glm::dvec3 d = glm::normalize(glm::dvec3(any(random), any(random), any(random)));
    if (std::fabs(d.x) < 1e-3) continue;
    EXPECT_EQ(cut.tag_at(d * (d.x < 0 ? 1.0 : 0.7)), d.x < 0 ? 0 : 1);
    // The large ball's face beside the small one.
    const glm::dvec3 face = 0.85 * glm::normalize(glm::dvec3(0, d.y, d.z));
    EXPECT_EQ(cut.tag_at(face + glm::dvec3(1e-7, 0, 0)), 0);
  }
  const Field changing =
      make_field("spatial_morph", {{"from", {-1, 0, 0}}, {"to", {1, 0, 0}}}, {large, small});
  EXPECT_EQ(changing.tag_at({-0.9, 0.1, 0}), 0);
  EXPECT_EQ(changing.tag_at({0.7, 0.1, 0}), 1);
}

}  // namespace
}  // namespace sdfgrid
