// bench/csg_scene.h: the scene of 127 ops, 64 solids and 63 combinations, as a field and as a tree
// of virtual nodes.
#pragma once

#include <algorithm>
#include <cmath>
#include <memory>
#include <random>

#include "sdfgrid/field/field.h"

namespace {

using sdfgrid::Field;
using sdfgrid::make_field;

inline constexpr int kSolids = 64;

// The peer: nodes with a virtual function, in float, each solid with its place.
struct Node {
  virtual ~Node() = default;
  [[nodiscard]] virtual float at(float x, float y, float z) const = 0;
};
struct BallNode : Node {
  float c[3], r;
  [[nodiscard]] float at(float x, float y, float z) const override {
    x -= c[0], y -= c[1], z -= c[2];
    return std::sqrt(x * x + y * y + z * z) - r;
  }
};
struct BoxNode : Node {
  float c[3], half[3];
  [[nodiscard]] float at(float x, float y, float z) const override {
    x = std::fabs(x - c[0]) - half[0], y = std::fabs(y - c[1]) - half[1];
    z = std::fabs(z - c[2]) - half[2];
    const float u = std::max(x, 0.0F);
    const float v = std::max(y, 0.0F);
    const float w = std::max(z, 0.0F);
    return std::sqrt(u * u + v * v + w * w) + std::min(std::max(x, std::max(y, z)), 0.0F);
  }
};
struct TorusNode : Node {
  float c[3], major, minor;
  [[nodiscard]] float at(float x, float y, float z) const override {
    x -= c[0], y -= c[1], z -= c[2];
    const float q = std::sqrt(x * x + y * y) - major;
    return std::sqrt(q * q + z * z) - minor;
  }
};
struct PairNode : Node {
  std::unique_ptr<Node> a, b;
};
struct UnionNode : PairNode {
  [[nodiscard]] float at(float x, float y, float z) const override {
    return std::min(a->at(x, y, z), b->at(x, y, z));
  }
};
struct DifferenceNode : PairNode {
  [[nodiscard]] float at(float x, float y, float z) const override {
    return std::max(a->at(x, y, z), -b->at(x, y, z));
  }
};
struct SmoothNode : PairNode {
  float k = 0.1F;
  [[nodiscard]] float at(float x, float y, float z) const override {
    const float u = a->at(x, y, z);
    const float v = b->at(x, y, z);
    const float h = std::max(k - std::fabs(u - v), 0.0F);
    return std::min(u, v) - h * h * (0.25F / k);
  }
};

struct Both {
  Field field;
  std::unique_ptr<Node> node;
};

inline Both solid(int i, std::mt19937& random) {
  std::uniform_real_distribution<double> at(-1.7, 1.7);
  std::uniform_real_distribution<double> size(0.1, 0.45);
  const double c[3] = {at(random), at(random), at(random)};
  const auto placed = [&](auto node, const Field& f) {
    for (int a = 0; a < 3; ++a) node->c[a] = static_cast<float>(c[a]);
    return Both{make_field("translate", {{"by", {c[0], c[1], c[2]}}}, {f}), std::move(node)};
  };
  if (i % 3 == 0) {
    auto node = std::make_unique<BallNode>();
    const double r = size(random);
    node->r = static_cast<float>(r);
    return placed(std::move(node), make_field("sphere", {{"radius", r}}));
  }
  if (i % 3 == 1) {
    auto node = std::make_unique<BoxNode>();
    const double edge[3] = {2 * size(random), 2 * size(random), 2 * size(random)};
    for (int a = 0; a < 3; ++a) node->half[a] = static_cast<float>(0.5 * edge[a]);
    return placed(std::move(node), make_field("box", {{"size", {edge[0], edge[1], edge[2]}}}));
  }
  auto node = std::make_unique<TorusNode>();
  const double r = size(random);
  node->major = static_cast<float>(r);
  node->minor = static_cast<float>(0.4 * r);
  return placed(std::move(node), make_field("torus", {{"major", r}, {"minor", 0.4 * r}}));
}

// A balanced tree of unions, smooth unions and differences.
inline Both csg_scene(int first, int count, std::mt19937& random) {
  if (count == 1) return solid(first, random);
  Both a = csg_scene(first, count / 2, random);
  Both b = csg_scene(first + count / 2, count - count / 2, random);
  std::unique_ptr<PairNode> node;
  Field f;
  if (count == 4) {
    node = std::make_unique<DifferenceNode>();
    f = make_field("difference", {}, {a.field, b.field});
  } else if (count == 2) {
    node = std::make_unique<SmoothNode>();
    f = make_field("smooth_union", {{"k", 0.1}}, {a.field, b.field});
  } else {
    node = std::make_unique<UnionNode>();
    f = make_field("union", {}, {a.field, b.field});
  }
  node->a = std::move(a.node);
  node->b = std::move(b.node);
  return {f, std::move(node)};
}

}  // namespace
