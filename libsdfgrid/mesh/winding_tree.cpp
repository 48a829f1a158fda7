#include "sdfgrid/mesh/winding_tree.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <glm/geometric.hpp>
#include <span>

#include "sdfgrid/core/parallel.h"

namespace sdfgrid::winding {
namespace {

constexpr float kNowhere = 1e12F;          // where unused children sit: farther than any query
constexpr std::size_t kSerial = 1U << 14;  // fewer triangles than this are split by one thread

struct Item {
  std::array<float, 3> center;
  std::uint32_t triangle;
};

struct Range {
  std::size_t begin, end;
  [[nodiscard]] std::size_t size() const { return end - begin; }
};

std::size_t divide_up(std::size_t a, std::size_t b) { return (a + b - 1) / b; }

// One over the least power of two above every coordinate in use.
double scale_of(const TriangleSoup& soup) {
  float largest = 0.0F;
  for (const glm::uvec3& t : soup.triangles) {
    for (int k = 0; k < 3; ++k) {
      const glm::vec3& p = soup.points[t[k]];
      largest = std::max({largest, std::abs(p.x), std::abs(p.y), std::abs(p.z)});
    }
  }
  return largest > 0.0F ? std::ldexp(1.0, -std::ilogb(largest) - 1) : 1.0;
}

// Triangles without area add nothing anywhere, and their rounded normals would.
std::vector<Item> items_with_area(const TriangleSoup& soup) {
  std::vector<Item> items;
  items.reserve(soup.triangles.size());
  for (std::uint32_t i = 0; i < soup.triangles.size(); ++i) {
    const glm::uvec3& t = soup.triangles[i];
    const glm::dvec3 a = soup.local(t.x);
    const glm::dvec3 b = soup.local(t.y);
    const glm::dvec3 c = soup.local(t.z);
    if (glm::cross(b - a, c - a) == glm::dvec3(0.0)) continue;
    const glm::vec3 center((a + b + c) / 3.0);
    items.push_back({{center.x, center.y, center.z}, i});
  }
  return items;
}

std::size_t longest_axis(const Item* begin, const Item* end) {
  std::array<float, 3> lo = begin->center;
  std::array<float, 3> hi = begin->center;
  for (const Item* item = begin; item != end; ++item) {
    for (std::size_t a = 0; a < 3; ++a) {
      lo[a] = std::min(lo[a], item->center[a]);
      hi[a] = std::max(hi[a], item->center[a]);
    }
  }
  std::size_t axis = 0;
  for (std::size_t a = 1; a < 3; ++a) {
    if (hi[a] - lo[a] > hi[axis] - lo[axis]) axis = a;
  }
  return axis;
}

// Orders the items so that `parts` consecutive ranges, of nearly equal sizes, are compact in space,
// and writes the ranges.
void split(Item* items, const Range& range, Range* out, std::size_t parts, const Job& job) {
  if (parts == 1) {
    *out = range;
    return;
  }
  const std::size_t left_parts = parts / 2;
  const std::size_t middle = range.begin + range.size() * left_parts / parts;
  const std::size_t axis = longest_axis(items + range.begin, items + range.end);
  std::nth_element(
      items + range.begin, items + middle, items + range.end,
      [axis](const Item& a, const Item& b) { return a.center[axis] < b.center[axis]; });
  const auto half = [&](std::size_t side) {
    if (side == 0) split(items, {range.begin, middle}, out, left_parts, job);
    if (side == 1) split(items, {middle, range.end}, out + left_parts, parts - left_parts, job);
  };
  if (range.size() < kSerial) {
    half(0);
    half(1);
  } else {
    parallel_for(2, 1, job, [&](std::size_t begin, std::size_t) { half(begin); });
  }
}

struct Level {
  std::vector<Range> ranges;  // of items, one a node
  std::vector<std::size_t>
      first;  // the first child of each, and one past the last child at the end
};

// The levels of nodes from the root down; the last entry is the leaves. Every node but the root has
// close to sixteen children, and all leaves lie at one depth.
std::vector<Level> make_levels(std::vector<Item>& items, const Job& job) {
  std::size_t capacity = kWidth;
  while (capacity * kWidth < items.size()) capacity *= kWidth;
  std::vector<Level> levels(1);
  levels.back().ranges = {{0, items.size()}};
  for (; capacity >= kWidth; capacity /= kWidth) {
    Level& level = levels.back();
    level.first = {0};
    for (const Range& range : level.ranges) {
      level.first.push_back(level.first.back() + divide_up(range.size(), capacity));
    }
    Level next;
    next.ranges.resize(level.first.back());
    parallel_for(level.ranges.size(), 1, job, [&](std::size_t begin, std::size_t end) {
      for (std::size_t i = begin; i < end; ++i) {
        split(items.data(), level.ranges[i], &next.ranges[level.first[i]],
              level.first[i + 1] - level.first[i], job);
      }
    });
    levels.push_back(std::move(next));
  }
  return levels;
}

Moments fill_leaf(Leaf& leaf, const TriangleSoup& soup, double scale, std::span<const Item> items) {
  std::array<Triangle, kWidth> triangles;
  for (std::size_t lane = 0; lane < kWidth; ++lane) {
    glm::uvec3 t = soup.triangles[items[std::min(lane, items.size() - 1)].triangle];
    if (lane >= items.size()) t = glm::uvec3(t.x);
    for (int k = 0; k < 3; ++k) {
      triangles[lane][k] = scale * soup.local(t[k]);
      for (int a = 0; a < 3; ++a) {
        leaf.corner[k][a][lane] = static_cast<float>(triangles[lane][k][a]);
      }
    }
  }
  return moments_of({triangles.data(), items.size()});
}

// What cancelled to a rounding error becomes zero: no farther away than the radius is any child
// expanded, where it would add 1e-12. Left alone it may be a denormal number, which takes a hundred
// times as long.
float without_dust(double coefficient, double radius, int degree) {
  const double at_radius = std::abs(coefficient) / std::pow(radius, degree + 1);
  return at_radius < 1e-12 ? 0.0F : static_cast<float>(coefficient);
}

void fill_child(Node& node, std::size_t lane, const Moments& child, const Accuracy& accuracy) {
  const double distance = reach(child, accuracy);
  node.reach2[lane] = static_cast<float>(distance * distance);
  node.radius[lane] = static_cast<float>(child.radius);
  for (int a = 0; a < 3; ++a) node.center[a][lane] = static_cast<float>(child.center[a]);
  const std::array<double, kCoefficients> c = coefficients(child);
  for (int i = 0; i < kCoefficients; ++i) {
    const int degree = i < 3 ? 1 : i < 8 ? 2 : 3;
    node.coefficient[i][lane] = without_dust(c[i], child.radius, degree);
  }
}

// A child without triangles, too far from any query to be opened.
void fill_unused(Node& node, std::size_t lane) {
  node.reach2[lane] = 0.0F;
  node.radius[lane] = 0.0F;
  for (auto& center : node.center) center[lane] = kNowhere;
  for (auto& coefficient : node.coefficient) coefficient[lane] = 0.0F;
}

void fill_node(Node& node, std::span<const Moments> children, const Accuracy& accuracy) {
  for (std::size_t lane = 0; lane < children.size(); ++lane) {
    fill_child(node, lane, children[lane], accuracy);
  }
  for (std::size_t lane = children.size(); lane < kWidth; ++lane) fill_unused(node, lane);
}

std::vector<Moments> fill_leaves(Tree& tree, const TriangleSoup& soup,
                                 const std::vector<Item>& items, const Level& level,
                                 const Job& job) {
  tree.leaves.resize(level.ranges.size());
  std::vector<Moments> moments(level.ranges.size());
  parallel_for(level.ranges.size(), 64, job, [&](std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i) {
      const Range& range = level.ranges[i];
      moments[i] = fill_leaf(tree.leaves[i], soup, tree.scale, {&items[range.begin], range.size()});
    }
  });
  return moments;
}

// Fills the nodes [offset, ...) of one level from their children's moments and returns their own.
std::vector<Moments> fill_level(Tree& tree, std::size_t offset, bool above_leaves,
                                const Level& level, const std::vector<Moments>& children,
                                const Accuracy& accuracy, const Job& job) {
  const std::size_t count = level.ranges.size();
  std::vector<Moments> moments(count);
  parallel_for(count, 16, job, [&](std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i) {
      Node& node = tree.nodes[offset + i];
      const std::size_t first = level.first[i];
      const std::span below(&children[first], level.first[i + 1] - first);
      fill_node(node, below, accuracy);
      node.leaves = above_leaves ? 1 : 0;
      node.first = static_cast<std::uint32_t>(above_leaves ? first : offset + count + first);
      moments[i] = merged(below);
    }
  });
  return moments;
}

}  // namespace

Tree build_tree(const TriangleSoup& soup, const Accuracy& accuracy, const Job& job) {
  Tree tree;
  tree.scale = scale_of(soup);
  std::vector<Item> items = items_with_area(soup);
  if (items.empty()) return tree;
  const std::vector<Level> levels = make_levels(items, job);
  std::size_t offset = 0;
  for (std::size_t l = 0; l + 1 < levels.size(); ++l) offset += levels[l].ranges.size();
  tree.nodes.resize(offset);
  std::vector<Moments> moments = fill_leaves(tree, soup, items, levels.back(), job);
  for (std::size_t l = levels.size() - 1; l-- > 0;) {
    offset -= levels[l].ranges.size();
    moments = fill_level(tree, offset, l + 2 == levels.size(), levels[l], moments, accuracy, job);
  }
  return tree;
}

}  // namespace sdfgrid::winding
