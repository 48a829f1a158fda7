#include "sdfgrid/trace/object_tree.h"

#include <algorithm>
#include <cmath>
#include <glm/common.hpp>
#include <limits>

namespace sdfgrid {
namespace {

constexpr double kInfinity = std::numeric_limits<double>::infinity();

constexpr int kFewLevels = 3;  // of local bounds, where there are many objects

// The beam around a group of rays, prepared for boxes.
struct Line {
  glm::dvec3 origin, inverse;
  double width, widening;  // the radius is width + widening * t
};

// Where rays of a beam may be in a box, within what is given. A ray is in the box no later than at
// the distance of its farthest corner, and the beam's axis then no farther from the box than the
// beam is wide there.
inline Span within(const Line& line, const Box& box, Span s) {
  double farthest = 0;  // or a little more, without a root
  for (int a = 0; a < 3; ++a) {
    const double below = line.origin[a] - box.lo[a];
    const double above = box.hi[a] - line.origin[a];
    farthest += below > above ? below : above;
  }
  const double radius = line.width + line.widening * (line.width + farthest);
  for (int a = 0; a < 3; ++a) {
    const double t0 = (box.lo[a] - radius - line.origin[a]) * line.inverse[a];
    const double t1 = (box.hi[a] + radius - line.origin[a]) * line.inverse[a];
    const double near = t1 < t0 ? t1 : t0;
    const double far = t1 < t0 ? t0 : t1;
    s.from = near > s.from ? near : s.from;
    s.to = far < s.to ? far : s.to;
  }
  return s;
}

// A group of sixteen rays, and where they may meet a node.
struct Passage {
  std::uint32_t group;
  double from, to;
};

// A node that waits, and which groups may meet it.
struct Waiting {
  double nearest;
  std::uint32_t node;
  std::uint32_t begin, end;  // of its passages in the list of all
  bool operator<(const Waiting& other) const { return nearest > other.nearest; }
};

class Traversal {
 public:
  Traversal(const ObjectTree& tree, Bundle& bundle, const MarchRules& rules, bool use_convex,
            FieldMarch& march)
      : tree_(tree), bundle_(bundle), rules_(rules), use_convex_(use_convex), march_(march) {
    for (const RayLanes& rays : bundle.rays) {
      RayLanes axis;
      RayGroup beam;
      step_kernel().beam(rays, axis, beam, 0);
      const auto of = [](const double(&column)[3][RayLanes::kLanes]) {
        return glm::dvec3(column[0][0], column[1][0], column[2][0]);
      };
      lines_.push_back(
          {of(axis.start), 1.0 / of(axis.along), double(beam.width[0]), double(beam.widening[0])});
    }
    deepest_.assign(lines_.size(), kInfinity);
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
  // Lets a node wait for those of the groups that may meet it before what they hit.
  void push(std::uint32_t node, std::uint32_t begin, std::uint32_t end) {
    const Box& box = tree_.nodes()[node].box;
    Waiting waiting{kInfinity, node, static_cast<std::uint32_t>(all_.size()), 0};
    for (std::uint32_t i = begin; i < end; ++i) {
      const Passage at = all_[i];
      const Span s = within(lines_[at.group], box, {at.from, std::min(at.to, deepest_[at.group])});
      if (!(s.from <= s.to)) continue;
      all_.push_back({at.group, s.from, s.to});
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
    const std::span<const Passage> groups = std::span(all_).subspan(at.begin, at.end - at.begin);
    stretches_.clear();
    for (const Passage& passage : groups) add_rays(passage.group, object.box);
    if (stretches_.empty()) return;
    march_.run(bundle_, object.field, rules, stretches_);
    for (const Passage& passage : groups) {
      const std::size_t first = std::size_t{passage.group} * kLanes;
      const double* const depth = bundle_.depth.data() + first;
      deepest_[passage.group] = *std::max_element(depth, depth + rays_of(first));
    }
  }

  // Of the group whose first ray that is: the bundle's last one may not be full.
  [[nodiscard]] std::size_t rays_of(std::size_t first) const {
    return std::min<std::size_t>(kLanes, bundle_.size - first);
  }

  // The stretches of a group's rays in a box, before what they hit.
  void add_rays(std::uint32_t group, const Box& box) {
    double from[kLanes];
    double to[kLanes];
    step_kernel().clip(bundle_.rays[group], &box.lo.x, &box.hi.x, from, to);
    const std::size_t first = std::size_t{group} * kLanes;
    for (std::size_t i = 0; i < rays_of(first); ++i) {
      const double end = std::min(to[i], bundle_.depth[first + i]);
      if (!(from[i] < end)) continue;
      stretches_.push_back({static_cast<std::uint32_t>(first + i), from[i], end});
    }
  }

  static constexpr int kLanes = RayLanes::kLanes;
  const ObjectTree& tree_;
  Bundle& bundle_;
  MarchRules rules_;
  bool use_convex_;
  FieldMarch& march_;
  std::vector<Line> lines_;      // of each group
  std::vector<double> deepest_;  // of its rays' hits so far
  std::vector<Passage> all_;
  std::vector<Stretch> stretches_;
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

void ObjectTree::trace(Bundle& bundle, const MarchRules& rules, bool use_convex,
                       FieldMarch& march) const {
  if (nodes_.empty()) return;
  Traversal(*this, bundle, rules, use_convex, march).run();
}

}  // namespace sdfgrid
