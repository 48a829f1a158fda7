// Pictures of shapes whose pixels are known in closed form.
#include "sdfgrid/trace/shade.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <glm/geometric.hpp>
#include <glm/trigonometric.hpp>
#include <glm/vec2.hpp>

#include "render/scenes.h"
#include "sdfgrid/core/error.h"
#include "sdfgrid/core/parallel.h"
#include "sdfgrid/grid/bricks.h"
#include "sdfgrid/trace/atlas_seen.h"

namespace sdfgrid {
namespace {

using test::cuboid;
using test::Distance;
using test::either;
using test::grid_of;
using test::sphere;
using test::unit_sphere;

struct Shot {
  Atlas atlas;
  Surroundings surroundings;
  Camera camera;
  HitBuffer hits;
  Picture picture;

  [[nodiscard]] std::size_t pixel(int x, int y) const {
    return static_cast<std::size_t>(y) * camera.width + x;
  }
  [[nodiscard]] const glm::vec3& color(int x, int y) const { return picture.color[pixel(x, y)]; }
  [[nodiscard]] bool hit(int x, int y) const { return std::isfinite(hits.depth[pixel(x, y)]); }
};

Shot shoot(const Grid& grid, const Camera& camera, const Look& look) {
  Shot shot;
  shot.atlas = make_atlas(grid, Job());
  shot.surroundings = make_surroundings(shot.atlas, Job());
  shot.camera = camera;
  shot.hits = trace_primary(shot.atlas, camera, Job());
  shot.picture = shade(shot.atlas, shot.surroundings, camera, shot.hits, look, Job());
  return shot;
}

Camera camera_at(const glm::dvec3& eye, const glm::dvec3& target, double fov, int size) {
  Camera camera;
  camera.eye = eye;
  camera.target = target;
  camera.fov = fov;
  camera.width = camera.height = size;
  return camera;
}

// Shows a single light on white, so that a pixel is what that light does there.
Look only(const glm::vec3& sun, const glm::vec3& ambient) {
  Look look;
  look.material = {glm::vec3(1), 0, 1};
  look.lighting.sun = sun;
  look.lighting.sky = look.lighting.glow = ambient;
  look.floor = false;
  look.samples = 1;
  return look;
}
Look only_sky() { return only(glm::vec3(0), glm::vec3(1)); }
Look only_sun() { return only(glm::vec3(1), glm::vec3(0)); }

TEST(Shade, SphereHasItsDepthNormalsAndArea) {
  const int size = 401;  // odd: a pixel's centre lies on the axis
  const Camera camera = camera_at({0, 0, 4}, {0, 0, 0}, 40, size);
  const Shot shot = shoot(unit_sphere(), camera, only_sky());
  EXPECT_NEAR(shot.hits.depth[shot.pixel(200, 200)], 3.0, 1e-3);
  const RayGenerator rays(camera);
  std::size_t hits = 0;
  for (int y = 0; y < size; ++y) {
    for (int x = 0; x < size; ++x) {
      const std::size_t i = shot.pixel(x, y);
      if (!shot.hit(x, y)) {
        EXPECT_EQ(shot.picture.normal[i], glm::vec3(0));
        continue;
      }
      ++hits;
      const Ray ray = rays.ray(x + 0.5, y + 0.5);
      const glm::dvec3 p = ray.origin + static_cast<double>(shot.hits.depth[i]) * ray.direction;
      EXPECT_LT(glm::distance(shot.picture.normal[i], glm::vec3(glm::normalize(p))), 0.01);
    }
  }
  // The silhouette is the circle of the cone that touches the sphere: sin a = 1 / 4.
  const double radius = size / 2.0 * std::tan(std::asin(0.25)) / std::tan(glm::radians(20.0));
  EXPECT_NEAR(static_cast<double>(hits), M_PI * radius * radius, 0.004 * M_PI * radius * radius);
}

// Three balls, the larger the further along its axis: each appears where the projection puts it.
TEST(Shade, AxesPointWhereTheyShould) {
  const Distance shape =
      either(either(sphere({1, 0, 0}, 0.15), sphere({0, 1, 0}, 0.25)), sphere({0, 0, 1}, 0.35));
  const Grid grid = grid_of(shape, {glm::dvec3(-0.6), glm::dvec3(1.6)}, 1.0 / 32);
  const Camera camera = camera_at({5, 0.5, 0.5}, {0, 0.5, 0.5}, 40, 200);
  const Shot shot = shoot(grid, camera, only_sky());  // from +x: y is up, z is to the left
  const double scale = 100 / std::tan(glm::radians(20.0));
  const auto place = [&](const glm::dvec3& p) {
    const double depth = 5 - p.x;
    return glm::ivec2(100 - scale * (p.z - 0.5) / depth, 100 - scale * (p.y - 0.5) / depth);
  };
  const glm::ivec2 y = place({0, 1, 0});
  const glm::ivec2 z = place({0, 0, 1});
  const auto expect_ball = [&](const glm::dvec3& center, double radius) {
    const glm::ivec2 at = place(center);
    const double distance = glm::distance(camera.eye, center) - radius;
    EXPECT_NEAR(shot.hits.depth[shot.pixel(at.x, at.y)], distance, 0.01);
  };
  expect_ball({1, 0, 0}, 0.15);
  expect_ball({0, 1, 0}, 0.25);
  expect_ball({0, 0, 1}, 0.35);
  EXPECT_LT(z.x, 100);
  EXPECT_LT(y.y, 100);
  EXPECT_FALSE(shot.hit(z.x, y.y)) << "there is no ball at (0, 1, 1)";
}

TEST(Shade, SkyIsOpenOverPlanesAndConvexBodies) {
  const Grid box =
      grid_of(cuboid({-1, -0.25, -1}, {1, 0.25, 1}), {glm::dvec3(-1.2), glm::dvec3(1.2)}, 1.0 / 24);
  const Shot plane = shoot(box, camera_at({0, 4, 0.01}, {0, 0, 0}, 20, 64), only_sky());
  EXPECT_GT(plane.color(32, 32).x, 0.97F);
  EXPECT_LE(plane.color(32, 32).x, 1.0F);
  const Shot ball = shoot(unit_sphere(), camera_at({0, 0, 4}, {0, 0, 0}, 20, 64), only_sky());
  for (int i = 8; i < 56; ++i) EXPECT_GT(ball.color(i, i).x, 0.95F) << i;
}

// The floor of a right-angled corner: cosine-weighted, half the sky is left beside the wall.
TEST(Shade, SkyDarkensIntoACorner) {
  const Distance shape =
      either(cuboid({-2, -0.3, -2}, {2, 0, 2}), cuboid({-2, -0.3, -2}, {0, 2, 2}));
  const Grid grid = grid_of(shape, {glm::dvec3(-2.2), glm::dvec3(2.2)}, 1.0 / 20);
  const Camera camera = camera_at({1, 5, 0.01}, {1, 0, 0}, 20, 101);
  const Shot shot = shoot(grid, camera, only_sky());
  // Along the row through the target, from beside the wall (x = 0) outwards.
  const double half = 5 * std::tan(glm::radians(10.0));
  float before = 0;
  for (int x = 0; x < 101; ++x) {
    const double at = 1 + half * ((x + 0.5) / 50.5 - 1);
    if (at < 0.15) continue;
    const float sky = shot.color(x, 50).x;
    if (at < 0.25) {
      EXPECT_GT(sky, 0.4F);
      EXPECT_LT(sky, 0.8F);
    }
    EXPECT_GE(sky, before - 0.01F) << "at " << at;
    before = sky;
  }
  EXPECT_GT(before, 0.9F) << "far from the wall";
}

TEST(Shade, TheSunCastsASoftShadow) {
  const Distance shape = either(cuboid({-2, -0.3, -2}, {2, 0, 2}), sphere({0, 1, 0}, 0.4));
  const Grid grid = grid_of(shape, {glm::dvec3(-2.2), glm::dvec3(2.2)}, 1.0 / 20);
  Look look = only_sun();
  look.lighting.sun_turn = 90;  // from the right, at 45 degrees: the shadow falls to x = -1
  look.lighting.sun_height = 45;
  look.lighting.sun_radius = 4;
  const Camera camera = camera_at({0, 9, 0.02}, {0, 0, 0}, 26, 201);
  const Shot shot = shoot(grid, camera, look);
  const double scale = 100.5 / (9 * std::tan(glm::radians(13.0)));
  const auto at = [&](double x, double z) {
    return shot.color(static_cast<int>(100.5 + scale * x), static_cast<int>(100.5 + scale * z)).x;
  };
  EXPECT_LT(at(-1, 0), 0.01F) << "the umbra";
  const auto open = static_cast<float>(std::sqrt(0.5));
  EXPECT_NEAR(at(1.5, 0), open, 0.01F);
  EXPECT_NEAR(at(-1, 1.2), open, 0.01F);
  EXPECT_NEAR(at(-1.85, 0), open, 0.02F);
  // Across its edge the shadow fades, without a jump or a speck.
  float before = 0;
  int between = 0;
  for (double z = 0.1; z < 0.9; z += 0.02) {
    const float light = at(-1, z);
    EXPECT_GE(light, before - 1e-3F) << z;
    if (light > 0.05F * open && light < 0.95F * open) ++between;
    before = light;
  }
  EXPECT_GE(between, 3);
}

TEST(Shade, EdgesAndNothingElseTakeMoreSamples) {
  const Camera camera = camera_at({0, 0, 4}, {0, 0, 0}, 40, 128);
  Look look = only_sky();
  look.background_top = look.background_bottom = glm::vec3(0);
  look.samples = 16;
  const Shot shot = shoot(unit_sphere(), camera, look);
  const double radius = 64 * std::tan(std::asin(0.25)) / std::tan(glm::radians(20.0));
  EXPECT_GT(shot.picture.refined, 2 * M_PI * radius);
  EXPECT_LT(shot.picture.refined, 4 * M_PI * radius);
  // White on black, so the sum of the pixels is the disc's area, about the picture's middle.
  double covered = 0;
  glm::dvec2 moment(0);
  int grey = 0;
  for (int y = 0; y < 128; ++y) {
    for (int x = 0; x < 128; ++x) {
      const double cover = std::min(shot.color(x, y).x / 0.98, 1.0);
      covered += cover;
      moment += cover * glm::dvec2(x + 0.5, y + 0.5);
      if (cover > 0.1 && cover < 0.9) ++grey;
    }
  }
  EXPECT_NEAR(covered, M_PI * radius * radius, 0.01 * M_PI * radius * radius);
  EXPECT_LT(glm::length(moment / covered - 64.0), 0.03);
  EXPECT_GT(grey, 2 * radius);
}

TEST(Shade, FloorShowsTheShadowAndNoMore) {
  Look look;
  look.samples = 1;
  const Camera camera = camera_at({0, 1.5, 6}, {0, 0, 0}, 50, 160);
  const Shot with = shoot(unit_sphere(), camera, look);
  look.floor = false;
  const Shot without = shoot(unit_sphere(), camera, look);
  std::size_t darker = 0;
  for (std::size_t i = 0; i < with.hits.size(); ++i) {
    const float a = with.picture.color[i].x;
    const float b = without.picture.color[i].x;
    EXPECT_LE(a, b + 1e-6F);
    if (std::isfinite(with.hits.depth[i])) {
      EXPECT_EQ(a, b);
    }
    if (a < 0.8F * b) ++darker;
  }
  EXPECT_GT(darker, 500U);
  EXPECT_EQ(with.color(2, 2), without.color(2, 2));
}

TEST(Shade, IsTheSameAtAnyNumberOfThreads) {
  const Camera camera = camera_at({1, 1, 3}, {0, 0, 0}, 40, 96);
  const ThreadLimit one(1);
  const Shot alone = shoot(unit_sphere(), camera, Look());
  for (const int threads : {2, 5}) {
    const ThreadLimit limit(threads);
    const Shot other = shoot(unit_sphere(), camera, Look());
    EXPECT_EQ(other.picture.color, alone.picture.color);
    EXPECT_EQ(other.picture.normal, alone.picture.normal);
  }
}

// The surface is then seen from behind, in the light of its front.
TEST(Shade, FromInsideEveryRayHits) {
  const Camera camera = camera_at({0, 0, 0.2}, {0, 0, 0}, 60, 32);
  const Shot shot = shoot(unit_sphere(), camera, Look());
  for (std::size_t i = 0; i < shot.hits.size(); ++i) {
    EXPECT_GT(shot.hits.depth[i], 0.79F);
    EXPECT_LT(shot.hits.depth[i], 1.21F);
    EXPECT_GT(shot.picture.color[i].x, 0.0F);
    EXPECT_LT(shot.picture.color[i].x, 2.0F);
    EXPECT_NEAR(glm::length(shot.picture.normal[i]), 1.0F, 1e-5F);
  }
}

TEST(Shade, NothingIsBackground) {
  const Look look;
  const Shot shot = shoot(Grid(), camera_at({0, 0, 4}, {0, 0, 0}, 40, 16), look);
  for (int y = 0; y < 16; ++y) {
    for (int x = 0; x < 16; ++x) {
      EXPECT_FALSE(shot.hit(x, y));
      EXPECT_GE(shot.color(x, y).x, look.background_top.x);
      EXPECT_LE(shot.color(x, y).x, look.background_bottom.x);
    }
  }
}

TEST(Shade, RefusesWhatDoesNotFit) {
  const Camera camera = camera_at({0, 0, 4}, {0, 0, 0}, 40, 16);
  const Shot shot = shoot(Grid(), camera, Look());
  Look look;
  look.samples = 0;
  EXPECT_THROW((void)shade(shot.atlas, shot.surroundings, camera, shot.hits, look, Job()), Error);
  Camera other = camera;
  other.width = 17;
  EXPECT_THROW((void)shade(shot.atlas, shot.surroundings, other, shot.hits, Look(), Job()), Error);
  const Job cancelled;
  cancelled.cancel();
  EXPECT_THROW((void)shade(shot.atlas, shot.surroundings, camera, shot.hits, Look(), cancelled),
               Error);
}

// Gives the samples with x < 0 material 3.
void paint_left(const Grid& grid) {
  GridBricks bricks(grid);
  for (const glm::ivec3& brick : all_bricks(grid)) {
    std::int32_t materials[kBrickSamples] = {};
    for (int i = 0; i < kBrickSamples; ++i) materials[i] = 8 * brick.x + (i >> 6) < 0 ? 3 : 0;
    bricks.set_paint(brick, materials);
  }
}

TEST(Shade, PaintIsSeenWhereItIsAndItsBorderIsSmooth) {
  const Grid grid = unit_sphere();
  const Camera camera = camera_at({0, 0, 4}, {0, 0, 0}, 40, 200);
  Look look = only_sky();
  look.samples = 8;
  const Shot plain = shoot(grid, camera, look);
  paint_left(grid);
  const SeenAtlas seen(plain.atlas, look.material, grid);
  const Picture painted =
      shade(seen, plain.atlas, plain.surroundings, camera, plain.hits, look, Job());
  // The border lies half a voxel left of the axis, whose place in the picture is x = 100.
  const double pixels_a_voxel = 100 / std::tan(glm::radians(20.0)) / 3 / 32;
  const int border = static_cast<int>(std::floor(100 - 0.5 * pixels_a_voxel));
  const auto at = [](int x) { return std::size_t{100} * 200 + x; };
  for (int x = 60; x < 140; ++x) {
    if (x == border) continue;
    EXPECT_EQ(painted.material[at(x)], x < border ? 3 : 0) << x;
    EXPECT_EQ(plain.picture.material[at(x)], 0);
    if (std::abs(x - border) < 2) continue;
    const glm::vec3 white = plain.picture.color[at(x)];
    const glm::vec3 expected = x < border ? white * paint_look(3).diffuse : white;
    EXPECT_LT(glm::length(painted.color[at(x)] - expected), 1e-5F) << x;
  }
  EXPECT_GT(painted.refined, plain.picture.refined + 200);  // two pixels a row of the border
  const float red = painted.color[at(border)].r;
  EXPECT_GT(red, painted.color[at(border - 3)].r);
  EXPECT_LT(red, painted.color[at(border + 3)].r);
}

}  // namespace
}  // namespace sdfgrid
