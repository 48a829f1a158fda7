#include "sdfgrid/mesh/reference_tree.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <glm/geometric.hpp>
#include <utility>

namespace sdfgrid::reference {
namespace {

using glm::dvec3;

// No path from the root is longer than this: kSahDepth levels of any split, then halves.
constexpr int kSahDepth = 48;
constexpr int kMaxDepth = kSahDepth + 33;

double squared_length(const dvec3& v) { return glm::dot(v, v); }

dvec3 closest_on_segment(const dvec3& p, const dvec3& a, const dvec3& b) {
  const dvec3 ab = b - a;
  const double along = glm::dot(p - a, ab);
  const double whole = squared_length(ab);
  if (!(along > 0)) return a;  // also where a equals b
  return along >= whole ? b : a + (along / whole) * ab;
}

dvec3 nearer(const dvec3& p, const dvec3& q, const dvec3& r) {
  return squared_length(q - p) <= squared_length(r - p) ? q : r;
}

dvec3 closest_on_border(const dvec3& p, const Corners& t) {
  const dvec3 first = closest_on_segment(p, t.a, t.b);
  const dvec3 second = closest_on_segment(p, t.b, t.c);
  return nearer(p, nearer(p, first, second), closest_on_segment(p, t.c, t.a));
}

double squared_distance(const Box& box, const dvec3& p) {
  double sum = 0;
  for (int k = 0; k < 3; ++k) {
    const double out = std::max(std::max(box.lo[k] - p[k], p[k] - box.hi[k]), 0.0);
    sum += out * out;
  }
  return sum;
}

// Whether the ray p + t / inverse, t >= 0, meets the box; never no where the exact answer is yes.
bool meets(const Box& box, const dvec3& p, const dvec3& inverse) {
  double enter = 0;
  double leave = std::numeric_limits<double>::infinity();
  for (int k = 0; k < 3; ++k) {
    const double t0 = (box.lo[k] - p[k]) * inverse[k];
    const double t1 = (box.hi[k] - p[k]) * inverse[k];
    enter = std::max(enter, std::min(t0, t1));
    leave = std::min(leave, std::max(t0, t1));
  }
  constexpr double kSlack = 1e-14;  // covers two roundings of each t
  return enter <= leave * (1 + kSlack);
}

enum class Crossing { none, outward, inward, unsure };

// How the ray from p meets the triangle: the signs of the areas that the three edges span with the
// ray, seen along it, and of the way to the plane. What is within its rounding error is unsure.
Crossing crossing(const dvec3& p, const RayFrame& frame, const Corners& t) {
  const std::array<dvec3, 3> corner{t.a - p, t.b - p, t.c - p};
  std::array<double, 3> x{};
  std::array<double, 3> y{};
  double reach = 0;
  for (int k = 0; k < 3; ++k) {
    x[k] = glm::dot(corner[k], frame.across);
    y[k] = glm::dot(corner[k], frame.aside);
    reach = std::max(reach, squared_length(corner[k]));
  }
  // Each area is a difference of two products of coordinates with 3 roundings each, of at most
  // `reach`: 16 units in the last place is above twice that.
  constexpr double kUnit = std::numeric_limits<double>::epsilon();
  const double doubt = 16 * kUnit * reach;
  const double ab = x[0] * y[1] - y[0] * x[1];
  const double bc = x[1] * y[2] - y[1] * x[2];
  const double ca = x[2] * y[0] - y[2] * x[0];
  const double low = std::min(ab, std::min(bc, ca));
  const double high = std::max(ab, std::max(bc, ca));
  if (low < -doubt && high > doubt) return Crossing::none;
  if (low <= doubt && high >= -doubt) return Crossing::unsure;

  // The way along the ray to the plane, times the sum of the areas; corner k weighs with the area
  // that the other two span.
  const std::array<double, 3> weight{bc, ca, ab};
  double way = 0;
  double spread = 0;
  for (int k = 0; k < 3; ++k) {
    const double z = glm::dot(corner[k], frame.along);
    way += z * weight[k];
    spread += std::abs(z);
  }
  const double areas = ab + bc + ca;
  if (std::abs(way) <= doubt * spread + 16 * kUnit * std::sqrt(reach) * std::abs(areas)) {
    return Crossing::unsure;
  }
  if ((way < 0) != (areas < 0)) return Crossing::none;  // behind the ray's start
  return low > 0 ? Crossing::outward : Crossing::inward;
}

}  // namespace

glm::dvec3 closest_on_triangle(const glm::dvec3& p, const Corners& t) {
  const dvec3 ab = t.b - t.a;
  const dvec3 ac = t.c - t.a;
  const dvec3 normal = glm::cross(ab, ac);
  const double whole = squared_length(normal);
  const auto inside = [&](double v, double w) { return v >= 0 && w >= 0 && v + w <= whole; };
  const auto point = [&](double v, double w) { return t.a + (v / whole) * ab + (w / whole) * ac; };
  // The foot of a + way on the plane is point(v, w).
  const auto v_of = [&](const dvec3& way) { return glm::dot(glm::cross(way, ac), normal); };
  const auto w_of = [&](const dvec3& way) { return glm::dot(glm::cross(ab, way), normal); };
  const double v = v_of(p - t.a);
  const double w = w_of(p - t.a);
  if (!(whole > 0 && inside(v, w))) return closest_on_border(p, t);
  const dvec3 foot = point(v, w);
  constexpr double kThin = 1e-8;
  if (whole > kThin * squared_length(ab) * squared_length(ac)) return foot;
  // In a sliver rounding moves the foot along it. What is left of the way to p is short and
  // corrects it; where even that fails, the border is no further from the true foot than the sliver
  // is wide.
  const dvec3 best = nearer(p, foot, closest_on_border(p, t));
  const double better_v = v + v_of(p - foot);
  const double better_w = w + w_of(p - foot);
  return inside(better_v, better_w) ? nearer(p, best, point(better_v, better_w)) : best;
}

// Splits where a binned surface area heuristic (Wald 2007, On fast construction of SAH-based
// bounding volume hierarchies) is least, and in halves where it finds nothing or the tree grows too
// deep.
class TriangleTree::Builder {
 public:
  explicit Builder(TriangleTree& tree) : tree_(tree), items_(tree.triangles_.size()) {
    for (std::size_t i = 0; i < items_.size(); ++i) {
      const Corners& t = tree.triangles_[i];
      items_[i].index = static_cast<std::uint32_t>(i);
      for (const dvec3& corner : {t.a, t.b, t.c}) items_[i].box.add(corner);
    }
  }

  void build() {
    tree_.nodes_.reserve(items_.size());
    tree_.nodes_.emplace_back();
    std::vector<Task> tasks{{0, 0, items_.size(), 0}};
    while (!tasks.empty()) {
      const Task task = tasks.back();
      tasks.pop_back();
      const std::size_t middle = split(task);
      if (middle == task.begin) continue;
      const auto child = static_cast<std::uint32_t>(tree_.nodes_.size());
      tree_.nodes_[task.node].first = child;
      tree_.nodes_.resize(tree_.nodes_.size() + 2);
      tasks.push_back({child, task.begin, middle, task.depth + 1});
      tasks.push_back({child + 1, middle, task.end, task.depth + 1});
    }
    reorder();
  }

 private:
  static constexpr std::size_t kLeaf = 4;  // triangles a leaf
  static constexpr int kBins = 16;

  struct Item {
    Box box;
    std::uint32_t index = 0;
  };
  struct Task {
    std::uint32_t node;
    std::size_t begin, end;
    int depth;
  };
  struct Bin {
    Box box;
    std::size_t count = 0;
  };
  struct Plane {
    double cost = std::numeric_limits<double>::infinity();
    int axis = 0;
    int bin = 0;  // the first bin above the plane
  };

  static void add(Box& box, const Box& other) {
    if (other.empty()) return;
    box.add(other.lo);
    box.add(other.hi);
  }

  static double half_area(const Box& box) {
    if (box.empty()) return 0;
    const dvec3 size = box.size();
    return size.x * size.y + size.y * size.z + size.z * size.x;
  }

  static int bin_of(const Item& item, const Box& centers, int axis) {
    const double at = item.box.center()[axis] - centers.lo[axis];
    return std::min(kBins - 1, static_cast<int>(kBins * (at / centers.size()[axis])));
  }

  // Fills the node's box; makes it a leaf and returns begin, or partitions its items and returns
  // where the second part begins.
  std::size_t split(const Task& task) {
    Node& node = tree_.nodes_[task.node];
    Box centers;
    for (std::size_t i = task.begin; i < task.end; ++i) {
      add(node.box, items_[i].box);
      centers.add(items_[i].box.center());
    }
    if (task.end - task.begin <= kLeaf) {
      node.first = static_cast<std::uint32_t>(task.begin);
      node.count = static_cast<std::uint32_t>(task.end - task.begin);
      return task.begin;
    }
    Plane best;
    if (task.depth < kSahDepth) {
      for (int axis = 0; axis < 3; ++axis) consider(task, centers, axis, best);
    }
    return std::isfinite(best.cost) ? partition(task, centers, best) : halve(task, centers);
  }

  void consider(const Task& task, const Box& centers, int axis, Plane& best) const {
    if (!(centers.size()[axis] > 0)) return;
    std::array<Bin, kBins> bins;
    for (std::size_t i = task.begin; i < task.end; ++i) {
      Bin& bin = bins[bin_of(items_[i], centers, axis)];
      add(bin.box, items_[i].box);
      ++bin.count;
    }
    std::array<double, kBins> above{};  // cost of the bins from k on
    Bin sum;
    for (int k = kBins - 1; k > 0; --k) {
      add(sum.box, bins[k].box);
      sum.count += bins[k].count;
      above[k] = half_area(sum.box) * static_cast<double>(sum.count);
    }
    sum = Bin();
    const std::size_t all = task.end - task.begin;
    for (int k = 1; k < kBins; ++k) {
      add(sum.box, bins[k - 1].box);
      sum.count += bins[k - 1].count;
      const double cost = half_area(sum.box) * static_cast<double>(sum.count) + above[k];
      if (sum.count > 0 && sum.count < all && cost < best.cost) best = {cost, axis, k};
    }
  }

  std::size_t partition(const Task& task, const Box& centers, const Plane& plane) {
    const auto below = [&](const Item& item) {
      return bin_of(item, centers, plane.axis) < plane.bin;
    };
    const auto middle = std::partition(at(task.begin), at(task.end), below);
    return static_cast<std::size_t>(middle - items_.begin());
  }

  std::size_t halve(const Task& task, const Box& centers) {
    const dvec3 size = centers.size();
    int axis = size.x >= size.y ? 0 : 1;
    if (size.z > size[axis]) axis = 2;
    const std::size_t middle = task.begin + (task.end - task.begin) / 2;
    std::nth_element(at(task.begin), at(middle), at(task.end), [&](const Item& l, const Item& r) {
      return l.box.center()[axis] < r.box.center()[axis];
    });
    return middle;
  }

  std::vector<Item>::iterator at(std::size_t i) {
    return items_.begin() + static_cast<std::ptrdiff_t>(i);
  }

  void reorder() {
    std::vector<Corners> ordered;
    ordered.reserve(items_.size());
    for (const Item& item : items_) ordered.push_back(tree_.triangles_[item.index]);
    tree_.triangles_ = std::move(ordered);
  }

  TriangleTree& tree_;
  std::vector<Item> items_;
};

TriangleTree::TriangleTree(std::vector<Corners> triangles) : triangles_(std::move(triangles)) {
  Builder(*this).build();
}

TriangleTree::Nearest TriangleTree::nearest(const glm::dvec3& p, double squared_limit) const {
  struct Entry {
    double squared;
    std::uint32_t node;
  };
  std::array<Entry, kMaxDepth> stack;  // NOLINT: filled as far as it is read
  int height = 0;
  Nearest best;
  double limit = squared_limit;
  Entry entry{squared_distance(nodes_.front().box, p), 0};
  for (;;) {
    if (entry.squared <= limit) {
      const Node& node = nodes_[entry.node];
      if (node.count == 0) {
        Entry near{squared_distance(nodes_[node.first].box, p), node.first};
        Entry far{squared_distance(nodes_[node.first + 1].box, p), node.first + 1};
        if (far.squared < near.squared) std::swap(near, far);
        stack[height++] = far;
        entry = near;
        continue;
      }
      for (std::uint32_t i = node.first; i < node.first + node.count; ++i) {
        const dvec3 point = closest_on_triangle(p, triangles_[i]);
        const double squared = squared_length(point - p);
        if (squared < best.squared && squared <= limit) {
          best = {point, squared};
          limit = squared;
        }
      }
    }
    if (height == 0) return best;
    entry = stack[--height];
  }
}

std::optional<int> TriangleTree::crossings(const glm::dvec3& p, const RayFrame& frame) const {
  const dvec3 inverse = 1.0 / frame.along;
  std::array<std::uint32_t, kMaxDepth> stack;  // NOLINT: filled as far as it is read
  int height = 0;
  stack[height++] = 0;
  int sum = 0;
  while (height > 0) {
    const Node& node = nodes_[stack[--height]];
    if (!meets(node.box, p, inverse)) continue;
    if (node.count == 0) {
      stack[height++] = node.first;
      stack[height++] = node.first + 1;
      continue;
    }
    for (std::uint32_t i = node.first; i < node.first + node.count; ++i) {
      const Crossing c = crossing(p, frame, triangles_[i]);
      if (c == Crossing::unsure) return std::nullopt;
      if (c == Crossing::outward) ++sum;
      if (c == Crossing::inward) --sum;
    }
  }
  return sum;
}

}  // namespace sdfgrid::reference
