#include "sdfgrid/trace/object_tree.h"

#include <algorithm>
#include <cmath>
#include <glm/common.hpp>
#include <limits>

namespace sdfgrid {
namespace {

constexpr double kInfinity = std::numeric_limits<double>::infinity();

constexpr int kFewLevels = 3;  // of local bounds, where there are many objects

// The rays of a bundle, prepared for boxes.
struct Line {
  glm::dvec3 origin, inverse;
};

// Where a line is in a box, within what is given.
inline Span within(const Line& line, const Box& box, Span s) {
  for (int a = 0; a < 3; ++a) {
    const double t0 = (box.lo[a] - line.origin[a]) * line.inverse[a];
    const double t1 = (box.hi[a] - line.origin[a]) * line.inverse[a];
    const double near = t1 < t0 ? t1 : t0;
    const double far = t1 < t0 ? t0 : t1;
    s.from = near > s.from ? near : s.from;
    s.to = far < s.to ? far : s.to;
  }
  return s;
}

// A node that waits, and which rays may meet it.
struct Waiting {
  double nearest;
  std::uint32_t node;
  std::uint32_t begin, end;  // of its stretches in the list of all
  bool operator<(const Waiting& other) const { return nearest > other.nearest; }
};

class Traversal {
 public:
  Traversal(const ObjectTree& tree, Bundle& bundle, const MarchRules& rules, bool use_convex)
      : tree_(tree), bundle_(bundle), rules_(rules), use_convex_(use_convex), march_(bundle) {
    for (const Ray& ray : bundle.rays) {
      lines_.push_back({ray.origin, 1.0 / ray.direction});
    }
  }

  void run() {
    for (std::uint32_t i = 0; i < lines_.size(); ++i) all_.push_back({i, 0, kInfinity});
    push(0, 0, static_cast<std::uint32_t>(all_.size()));
    while (!heap_.empty()) {
      std::pop_heap(heap_.begin(), heap_.end());
      const Waiting at = heap_.back();
      heap_.pop_back();
      const ObjectTree::Node& node = tree_.nodes()[at.node];
      if (node.count == 1) {
        trace(tree_.objects()[node.first], at);
      } else {
        push(node.first, at.begin, at.end);
        push(node.first + 1, at.begin, at.end);
      }
    }
  }

 private:
  // Lets a node wait for those of the rays that may meet it before what they hit.
  void push(std::uint32_t node, std::uint32_t begin, std::uint32_t end) {
    const Box& box = tree_.nodes()[node].box;
    Waiting waiting{kInfinity, node, static_cast<std::uint32_t>(all_.size()), 0};
    for (std::uint32_t i = begin; i < end; ++i) {
      const Stretch at = all_[i];
      const Span s = within(lines_[at.ray], box, {at.from, std::min(at.to, bundle_.depth[at.ray])});
      if (!(s.from <= s.to)) continue;
      all_.push_back({at.ray, s.from, s.to});
      waiting.nearest = std::min(waiting.nearest, s.from);
    }
    waiting.end = static_cast<std::uint32_t>(all_.size());
    if (waiting.begin == waiting.end) return;
    heap_.push_back(waiting);
    std::push_heap(heap_.begin(), heap_.end());
  }

  void trace(const ObjectTree::Object& object, const Waiting& at) {
    MarchRules rules = rules_;
    rules.convex = use_convex_ && object.convex;
    rules.bounds = object.bounds.get();
    march_.run(object.field, rules, std::span(all_).subspan(at.begin, at.end - at.begin));
  }

  const ObjectTree& tree_;
  Bundle& bundle_;
  MarchRules rules_;
  bool use_convex_;
  FieldMarch march_;
  std::vector<Line> lines_;
  std::vector<Stretch> all_;
  std::vector<Waiting> heap_;
};

Box common(const Box& a, const Box& b) { return {glm::max(a.lo, b.lo), glm::min(a.hi, b.hi)}; }

}  // namespace

std::unique_ptr<const LocalBounds> useful_bounds(const Field& field, const Box& box, int levels) {
  const int probes = levels > kFewLevels ? 8 : 2;  // along each axis
  auto bounds = std::make_unique<LocalBounds>(field, box, levels);
  for (int i = 0; i < probes * probes * probes; ++i) {
    const glm::dvec3 at(i / (probes * probes), i / probes % probes, i % probes);
    if (bounds->at(box.lo + box.size() * (at + 0.5) / double(probes)).slope < 0.9) return bounds;
  }
  return nullptr;
}

ObjectTree::ObjectTree(std::vector<FieldPart> parts, const Box& region, bool slopes) {
  objects_.reserve(parts.size());
  const int levels = parts.size() <= 64 ? 5 : kFewLevels;
  for (FieldPart& part : parts) {
    const Box box = common(part.box, region);
    if (box.empty()) continue;
    Object object{std::move(part.field), box, part.convex, nullptr};
    if (slopes && part.scaled) object.bounds = useful_bounds(object.field, box, levels);
    objects_.push_back(std::move(object));
  }
  if (objects_.empty()) return;
  nodes_.reserve(2 * objects_.size());
  nodes_.emplace_back();
  build(0, 0, static_cast<std::uint32_t>(objects_.size()));
}

// Halves along the axis along which the middles are spread farthest.
void ObjectTree::build(std::uint32_t node, std::uint32_t begin, std::uint32_t end) {
  Box middles;
  for (std::uint32_t i = begin; i < end; ++i) {
    nodes_[node].box.add(objects_[i].box.lo);
    nodes_[node].box.add(objects_[i].box.hi);
    middles.add(objects_[i].box.center());
  }
  if (end - begin == 1) {
    nodes_[node].first = begin;
    nodes_[node].count = 1;
    return;
  }
  const glm::dvec3 size = middles.size();
  int axis = size.x >= size.y ? 0 : 1;
  if (size.z > size[axis]) axis = 2;
  const std::uint32_t half = begin + (end - begin) / 2;
  std::nth_element(objects_.begin() + begin, objects_.begin() + half, objects_.begin() + end,
                   [&](const Object& a, const Object& b) {
                     return a.box.center()[axis] < b.box.center()[axis];
                   });
  const auto children = static_cast<std::uint32_t>(nodes_.size());
  nodes_[node].first = children;
  nodes_.resize(nodes_.size() + 2);
  build(children, begin, half);
  build(children + 1, half, end);
}

void ObjectTree::trace(Bundle& bundle, const MarchRules& rules, bool use_convex) const {
  if (nodes_.empty()) return;
  Traversal(*this, bundle, rules, use_convex).run();
}

}  // namespace sdfgrid
