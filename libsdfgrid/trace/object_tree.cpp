#include "sdfgrid/trace/object_tree.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <glm/common.hpp>
#include <limits>

#include "sdfgrid/trace/box_kernel.h"

namespace sdfgrid {
namespace {

constexpr double kInfinity = std::numeric_limits<double>::infinity();

constexpr double kEndless = 1e100;  // farther than any hit

constexpr int kFewLevels = 3;  // of local bounds, where there are many objects

// Of sixteen groups of rays beside each other those that may meet a node.
struct Passage {
  std::uint32_t cluster;  // group i of it is the bundle's group 16 * cluster + i
  std::uint32_t groups;   // a bit each
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
  Traversal(const ObjectTree& tree, Bundle& bundle, const MarchRules& rules, const ObjectRules& use,
            FieldMarch& march)
      : tree_(tree), bundle_(bundle), rules_(rules), use_(use), march_(march) {
    beams_.resize((bundle.rays.size() + kLanes - 1) / kLanes);
    for (std::size_t i = 0; i < bundle.rays.size(); ++i) set_beam(bundle.rays[i], i);
  }

  void run() {
    const std::size_t groups = bundle_.rays.size();
    for (std::uint32_t i = 0; i < beams_.size(); ++i) {
      const std::size_t count = std::min<std::size_t>(kLanes, groups - std::size_t{i} * kLanes);
      all_.push_back({i, (1U << count) - 1});
    }
    const auto passages = static_cast<std::uint32_t>(all_.size());
    if (!use_.boxes) {
      for (const ObjectTree::Object& object : tree_.objects()) {
        trace(object, tree_.region(), {0, 0, 0, passages});
      }
      return;
    }
    push(0, 0, passages);
    while (!heap_.empty()) {
      std::pop_heap(heap_.begin(), heap_.end());
      const Waiting at = heap_.back();
      heap_.pop_back();
      const ObjectTree::Node& node = tree_.nodes()[at.node];
      if (node.count == 1) {
        const ObjectTree::Object& object = tree_.objects()[node.first];
        trace(object, object.box, at);
      } else {
        push(node.first, at.begin, at.end);
        push(node.first + 1, at.begin, at.end);
      }
    }
  }

 private:
  void set_beam(const RayLanes& rays, std::size_t group) {
    RayLanes axis;
    RayGroup beam;
    step_kernel().beam(rays, axis, beam, 0);
    BeamLanes& beams = beams_[group / kLanes];
    const std::size_t lane = group % kLanes;
    glm::dvec3 origin;
    for (int a = 0; a < 3; ++a) {
      beams.origin[a][lane] = origin[a] = axis.start[a][0];
      // An axis along a face leaves its box far away, or never.
      const double along = axis.along[a][0];
      beams.inverse[a][lane] =
          1 / (std::fabs(along) < 1e-200 ? std::copysign(1e-200, along) : along);
    }
    origins_.add(origin);
    beams.width[lane] = double(beam.width[0]);
    beams.widening[lane] = double(beam.widening[0]);
    beams.deepest[lane] = kEndless;
  }

  // No less than from any beam's beginning to the box's farthest corner, without a root.
  [[nodiscard]] double farthest_of(const Box& box) const {
    double farthest = 0;
    for (int a = 0; a < 3; ++a) {
      farthest += std::max(origins_.hi[a] - box.lo[a], box.hi[a] - origins_.lo[a]);
    }
    return farthest;
  }

  // Lets a node wait for those of the groups that may meet it before what they hit.
  void push(std::uint32_t node, std::uint32_t begin, std::uint32_t end) {
    const Box& box = tree_.nodes()[node].box;
    const double farthest = farthest_of(box);
    Waiting waiting{kInfinity, node, static_cast<std::uint32_t>(all_.size()), 0};
    for (std::uint32_t i = begin; i < end; ++i) {
      const auto [cluster, groups] = all_[i];
      const BeamsMet met = meet_(beams_[cluster], &box.lo.x, &box.hi.x, farthest, groups);
      if (met.beams == 0) continue;
      all_.push_back({cluster, met.beams});
      waiting.nearest = std::min(waiting.nearest, met.nearest);
    }
    waiting.end = static_cast<std::uint32_t>(all_.size());
    if (waiting.begin == waiting.end) return;
    heap_.push_back(waiting);
    std::push_heap(heap_.begin(), heap_.end());
  }

  // Within a box, which is the object's own if those are used.
  void trace(const ObjectTree::Object& object, const Box& box, const Waiting& at) {
    MarchRules rules = rules_;
    rules.convex = use_.convex && object.convex;
    rules.bounds = use_.boxes ? object.bounds.get() : nullptr;  // it has none beyond its box
    stretches_.clear();
    each_group(at, [&](std::uint32_t group) { add_rays(group, box); });
    if (stretches_.empty()) return;
    march_.run(bundle_, object.field, rules, stretches_);
    each_group(at, [&](std::uint32_t group) {
      const std::size_t first = std::size_t{group} * kLanes;
      const double* const depth = bundle_.depth.data() + first;
      beams_[group / kLanes].deepest[group % kLanes] =
          std::min(kEndless, *std::max_element(depth, depth + rays_of(first)));
    });
  }

  template <class Visit>
  void each_group(const Waiting& at, const Visit& visit) const {
    for (std::uint32_t i = at.begin; i < at.end; ++i) {
      for (std::uint32_t left = all_[i].groups; left != 0; left &= left - 1) {
        visit(all_[i].cluster * kLanes + static_cast<std::uint32_t>(std::countr_zero(left)));
      }
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
  ObjectRules use_;
  FieldMarch& march_;
  const MeetBox meet_ = meet_box();
  std::vector<BeamLanes> beams_;  // of sixteen groups each; deepest: of their rays' hits so far
  Box origins_;                   // where they begin
  std::vector<Passage> all_;
  std::vector<Stretch> stretches_;
  std::vector<Waiting> heap_;
};

Box common(const Box& a, const Box& b) { return {glm::max(a.lo, b.lo), glm::min(a.hi, b.hi)}; }

double half_area(const Box& box) {
  if (box.empty()) return 0;
  const glm::dvec3 s = box.size();
  return s.x * s.y + s.y * s.z + s.z * s.x;
}

// Two parts of objects by their middles along the axis along which those are spread farthest: where
// a ray that meets the whole box meets the least number of objects in the two (J. Goldsmith and J.
// Salmon 1987), of fifteen places. How many are in the first.
std::uint32_t divide(std::span<ObjectTree::Object> objects, const Box& middles) {
  constexpr int kBins = 16;
  const glm::dvec3 size = middles.size();
  int axis = size.x >= size.y ? 0 : 1;
  if (size.z > size[axis]) axis = 2;
  const double scale = kBins / size[axis];
  const auto bin_of = [&](const ObjectTree::Object& object) {
    const double place = (object.box.center()[axis] - middles.lo[axis]) * scale;
    return place > 0 ? static_cast<int>(std::min(place, kBins - 1.0)) : 0;
  };
  struct Bin {
    Box box;
    double count = 0;
    void add(const Box& more, double n) {
      if (more.empty()) return;
      box.add(more.lo);
      box.add(more.hi);
      count += n;
    }
  };
  Bin bins[kBins];
  for (const ObjectTree::Object& object : objects) bins[bin_of(object)].add(object.box, 1);
  double upper[kBins] = {};  // cost of all from a bin on
  Bin sum;
  for (int i = kBins - 1; i > 0; --i) {
    sum.add(bins[i].box, bins[i].count);
    upper[i] = half_area(sum.box) * sum.count;
  }
  sum = {};
  double least = kInfinity;
  int first_above = 0;
  for (int i = 1; i < kBins; ++i) {
    sum.add(bins[i - 1].box, bins[i - 1].count);
    const double cost = half_area(sum.box) * sum.count + upper[i];
    if (sum.count == 0 || upper[i] == 0 || !(cost < least)) continue;
    least = cost;
    first_above = i;
  }
  const auto half = static_cast<std::ptrdiff_t>(objects.size() / 2);
  if (first_above == 0) return static_cast<std::uint32_t>(half);  // all in one place
  const auto above = std::partition(objects.begin(), objects.end(), [&](const auto& object) {
    return bin_of(object) < first_above;
  });
  return static_cast<std::uint32_t>(above - objects.begin());
}

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

ObjectTree::ObjectTree(std::vector<FieldPart> parts, const Box& region, bool slopes)
    : region_(region) {
  objects_.reserve(parts.size());
  const int levels = parts.size() <= 64 ? LocalBounds::kLevels : kFewLevels;
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
  const std::uint32_t half =
      begin + divide(std::span(objects_).subspan(begin, end - begin), middles);
  const auto children = static_cast<std::uint32_t>(nodes_.size());
  nodes_[node].first = children;
  nodes_.resize(nodes_.size() + 2);
  build(children, begin, half);
  build(children + 1, half, end);
}

void ObjectTree::trace(Bundle& bundle, const MarchRules& rules, const ObjectRules& use,
                       FieldMarch& march) const {
  if (nodes_.empty()) return;
  Traversal(*this, bundle, rules, use, march).run();
}

}  // namespace sdfgrid
