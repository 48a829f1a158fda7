#include "sdfgrid/trace/shader.h"

#include <algorithm>
#include <cmath>
#include <glm/common.hpp>
#include <glm/exponential.hpp>
#include <glm/geometric.hpp>
#include <glm/trigonometric.hpp>
#include <limits>

namespace sdfgrid {
namespace {

constexpr std::size_t kLanes = 16;  // of the visibility kernel

void copy(const glm::vec3& from, float (&to)[3]) {
  for (int a = 0; a < 3; ++a) to[a] = from[a];
}

}  // namespace

struct Shader::Points {
  explicit Points(std::size_t samples) : of_sample(samples, -1) {}

  void add(std::size_t sample, const glm::vec3& at, const glm::vec3& n) {
    of_sample[sample] = static_cast<int>(x.size());
    for (int a = 0; a < 3; ++a) {
      (a == 0 ? x : a == 1 ? y : z).push_back(at[a]);
      (a == 0 ? nx : a == 1 ? ny : nz).push_back(n[a]);
    }
  }

  void light(const VisibilityScene& scene) {
    const std::size_t count = (x.size() + kLanes - 1) / kLanes * kLanes;
    for (auto* column : {&x, &y, &z, &nx, &ny, &nz}) {
      if (!column->empty()) column->resize(count, column->back());
    }
    sun.resize(count);
    sky.resize(count);
    visibility_kernel()(scene, {x.data(), y.data(), z.data(), nx.data(), ny.data(), nz.data(),
                                sun.data(), sky.data(), static_cast<std::int32_t>(count)});
  }

  std::vector<int> of_sample;  // -1 for a sample that no light is asked for
  std::vector<float> x, y, z, nx, ny, nz, sun, sky;
};

Shader::Shader(const Seen& seen, const Atlas& atlas, const Surroundings& surroundings,
               const Camera& camera, const Look& look)
    : seen_(seen), atlas_(atlas), camera_(camera), look_(look), rays_(camera) {
  up_ = glm::normalize(camera.up);
  const glm::dvec3 to_eye = glm::normalize(camera.eye - camera.target);
  right_ = glm::cross(up_, to_eye);
  if (!(glm::length(right_) > 1e-6)) {  // looking straight down or up
    right_ = glm::cross(up_, std::abs(up_.x) < 0.9 ? glm::dvec3(1, 0, 0) : glm::dvec3(0, 0, 1));
  }
  right_ = glm::normalize(right_);
  back_ = glm::cross(right_, up_);

  const FarField& far = surroundings.far;
  scene_.bricks = atlas.bricks.data();
  scene_.samples = atlas.samples.data();
  scene_.outside = atlas.outside;
  scene_.inside = atlas.inside;
  scene_.far_values = far.values.data();
  scene_.far_spacing = far.spacing;
  for (int a = 0; a < 3; ++a) {
    scene_.dims[a] = atlas.dims[a];
    scene_.far_dims[a] = far.dims[a];
    scene_.far_origin[a] = far.origin[a];
  }
  scene_.sun_reach = far.spacing * glm::length(glm::vec3(far.dims));
  scene_.sky_reach = 0.25F * scene_.sun_reach;
  set_up_light();
  set_up_cones();
  set_up_floor(surroundings.points);
}

void Shader::set_up_light() {
  const Lighting& light = look_.lighting;
  const double turn = glm::radians(light.sun_turn);
  const double height = glm::radians(light.sun_height);
  sun_ = glm::vec3(std::sin(height) * up_ +
                   std::cos(height) * (std::sin(turn) * right_ + std::cos(turn) * back_));
  copy(sun_, scene_.sun);
  scene_.sun_tan = static_cast<float>(std::tan(glm::radians(light.sun_radius)));
}

// About the direction to the eye: the normals opposite to it, where the layout tears, are not seen.
void Shader::set_up_cones() {
  const glm::dvec3 axis = glm::normalize(camera_.eye - camera_.target);
  const glm::dvec3 side = glm::normalize(
      glm::cross(axis, std::abs(axis.x) < 0.9 ? glm::dvec3(1, 0, 0) : glm::dvec3(0, 0, 1)));
  const glm::dvec3 other = glm::cross(axis, side);
  copy(glm::vec3(axis), scene_.axis);
  copy(glm::vec3(axis), scene_.cones[0]);
  for (int c = 1; c < 6; ++c) {
    const double around = glm::radians(72.0 * c);
    const glm::dvec3 level = std::cos(around) * side + std::sin(around) * other;
    copy(glm::vec3(0.5 * axis + std::sqrt(0.75) * level), scene_.cones[c]);
  }
}

void Shader::set_up_floor(const std::vector<glm::vec3>& points) {
  if (points.empty()) return;
  const glm::dvec3 base(atlas_.lo * Atlas::kBrick);
  Box box;
  double lowest = std::numeric_limits<double>::max();
  for (const glm::vec3& point : points) {
    const glm::dvec3 world = atlas_.lattice.to_world(base + glm::dvec3(point));
    lowest = std::min(lowest, glm::dot(up_, world));
    box.add(world);
  }
  // From below the floor would hide the object.
  has_floor_ = look_.floor && glm::dot(up_, camera_.eye) > lowest;
  floor_height_ = lowest;
  floor_center_ = box.center() + (lowest - glm::dot(up_, box.center())) * up_;
  floor_radius_ = 0.5 * glm::length(box.size());
}

Shader::Kind Shader::locate(const Ray& ray, float depth, glm::dvec3& world) const {
  if (std::isfinite(depth)) {
    world = ray.origin + static_cast<double>(depth) * ray.direction;
    return Kind::surface;
  }
  const double sinks = -glm::dot(up_, ray.direction);
  if (!has_floor_ || !(sinks > 1e-3)) return Kind::background;
  const double t = (glm::dot(up_, ray.origin) - floor_height_) / sinks;
  world = ray.origin + t * ray.direction;
  const bool near = glm::distance(world, floor_center_) < 4 * floor_radius_;
  return near ? Kind::floor : Kind::background;
}

glm::vec3 Shader::background(double y) const {
  const auto down = static_cast<float>(y / camera_.height);
  return glm::mix(look_.background_top, look_.background_bottom, down);
}

// What an open hemisphere about the normal gives, from a sky that fades into the glow below.
glm::vec3 Shader::ambient(const glm::vec3& normal) const {
  const float upward = 0.5F + 0.5F * glm::dot(normal, glm::vec3(up_));
  return glm::mix(look_.lighting.glow, look_.lighting.sky, upward);
}

glm::vec3 Shader::surface_color(const Material& material, const glm::vec3& normal,
                                const glm::vec3& to_eye, float sun, float sky) const {
  const float facing = std::max(glm::dot(normal, sun_), 0.0F);
  const glm::vec3 direct = sun * look_.lighting.sun;
  const glm::vec3 diffuse = material.diffuse * (facing * direct + sky * ambient(normal));
  const glm::vec3 mirrored = 2 * glm::dot(normal, sun_) * normal - sun_;
  const float aligned = facing > 0 ? std::max(glm::dot(mirrored, to_eye), 0.0F) : 0.0F;
  return diffuse + material.specular * std::pow(aligned, material.exponent) * direct;
}

// What the object leaves of the floor's light, fading to all of it away from the object.
glm::vec3 Shader::floor_shadow(const glm::dvec3& world, float sun, float sky) const {
  const glm::vec3 up(up_);
  const glm::vec3 direct = std::max(glm::dot(up, sun_), 0.0F) * look_.lighting.sun;
  const glm::vec3 open = direct + ambient(up);
  const glm::vec3 left = (sun * direct + sky * ambient(up)) / open;
  const double distance = glm::distance(world, floor_center_) / floor_radius_;
  const auto fade = static_cast<float>(glm::smoothstep(2.0, 4.0, distance));
  return glm::mix(left, glm::vec3(1.0F), fade);
}

// Normals where there is something, materials where that is a surface.
void Shader::describe(std::span<const Kind> kinds, std::span<const glm::dvec3> worlds,
                      std::span<glm::vec3> normals, std::span<Material> materials) const {
  std::vector<std::size_t> hit;
  std::vector<glm::dvec3> points;
  for (std::size_t i = 0; i < kinds.size(); ++i) {
    normals[i] = kinds[i] == Kind::floor ? glm::vec3(up_) : glm::vec3(0.0F);
    if (kinds[i] != Kind::surface) continue;
    hit.push_back(i);
    points.push_back(worlds[i]);
  }
  std::vector<glm::vec3> n(hit.size());
  std::vector<Material> m(hit.size());
  seen_.describe(points, n, m);
  for (std::size_t k = 0; k < hit.size(); ++k) {
    normals[hit[k]] = n[k];
    materials[hit[k]] = m[k];
  }
}

void Shader::operator()(std::span<const Sample> samples, std::span<glm::vec3> colors,
                        std::span<glm::vec3> normals, std::span<int> indices) const {
  std::vector<Kind> kinds(samples.size());
  std::vector<glm::dvec3> worlds(samples.size());
  std::vector<glm::vec3> directions(samples.size());
  std::vector<glm::vec3> at(samples.size());  // normals
  std::vector<Material> materials(samples.size());
  Points points(samples.size());
  const glm::dvec3 base(atlas_.lo * Atlas::kBrick);
  for (std::size_t i = 0; i < samples.size(); ++i) {
    const Ray ray = rays_.ray(samples[i].x, samples[i].y);
    kinds[i] = locate(ray, samples[i].depth, worlds[i]);
    directions[i] = glm::vec3(ray.direction);
  }
  describe(kinds, worlds, at, materials);
  for (std::size_t i = 0; i < samples.size(); ++i) {
    if (!normals.empty()) normals[i] = kinds[i] == Kind::surface ? at[i] : glm::vec3(0.0F);
    if (!indices.empty()) indices[i] = kinds[i] == Kind::surface ? materials[i].index : 0;
    if (kinds[i] == Kind::background) continue;
    points.add(i, glm::vec3(atlas_.lattice.to_index(worlds[i]) - base), at[i]);
  }
  points.light(scene_);
  for (std::size_t i = 0; i < samples.size(); ++i) {
    colors[i] = background(samples[i].y);
    const int p = points.of_sample[i];
    if (p < 0) continue;
    if (kinds[i] == Kind::floor) {
      colors[i] *= floor_shadow(worlds[i], points.sun[p], points.sky[p]);
    } else {
      colors[i] = surface_color(materials[i], at[i], -directions[i], points.sun[p], points.sky[p]);
    }
  }
}

}  // namespace sdfgrid
