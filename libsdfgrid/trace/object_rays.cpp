#include "sdfgrid/trace/object_rays.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace sdfgrid {
namespace {

constexpr double kInfinity = std::numeric_limits<double>::infinity();
constexpr std::uint32_t kMostEvaluations = 1U << 22;  // no ray needs so many

}  // namespace

ObjectRays::Result ObjectRays::trace(const ObjectTree& tree, const ObjectRules& rules,
                                     double tolerance, const Ray& ray) {
  tree_ = &tree;
  rules_ = rules;
  tolerance_ = tolerance;
  ray_ = ray;
  evaluations_ = 0;
  waiting_.clear();
  open_.clear();
  const Span all = clip(ray, tree.region());
  if (tree.nodes().empty() || !(all.from < all.to)) return {kInfinity, 0};
  if (rules.boxes) {
    add(0, true, tree.nodes().front().box);
  } else {
    for (std::uint32_t i = 0; i < tree.objects().size(); ++i) {
      waiting_.push_back({all.from, i, false, all.to});  // a heap, as all are equally near
    }
  }
  const double depth = rules.apart ? each_by_itself() : all_together(all.to);
  return {depth, evaluations_};
}

void ObjectRays::add(std::uint32_t index, bool node, const Box& box) {
  const Span s = clip(ray_, box);
  if (!(s.from <= s.to)) return;
  waiting_.push_back({s.from, index, node, s.to});
  std::push_heap(waiting_.begin(), waiting_.end());
}

ObjectRays::Item ObjectRays::nearest() {
  std::pop_heap(waiting_.begin(), waiting_.end());
  const Item item = waiting_.back();
  waiting_.pop_back();
  return item;
}

void ObjectRays::open(const Item& item) {
  const ObjectTree::Node& node = tree_->nodes()[item.index];
  if (node.count == 1) {
    add(node.first, false, node.box);
  } else {
    for (const std::uint32_t child : {node.first, node.first + 1}) {
      add(child, true, tree_->nodes()[child].box);
    }
  }
}

// Evaluates at t, and returns how far the way ahead is free as far as the object knows; minus that
// if it is hit there.
double ObjectRays::evaluate(Item& item, double t) {
  ++evaluations_;
  const ObjectTree::Object& object = tree_->objects()[item.index];
  const glm::dvec3 p = ray_.origin + t * ray_.direction;
  const double r = static_cast<double>(object.field(glm::vec3(p)));
  if (r < 0) return -0.0;
  const double error = kFieldSlack * reach({p, p});
  double ahead = r;
  double surface = r;  // where it is at least as long as the slope stays
  if (rules_.boxes && object.bounds != nullptr) {
    const LocalBounds::Free free = object.bounds->free(p, ray_.direction, r);
    ahead = free.ahead;
    surface = free.surface;
  }
  if (rules_.convex && object.convex && item.last >= 0 && t > item.last) {
    // A convex function lies above the line through two of its values, beyond them.
    const double fall = (item.value - r + 2 * error) / (t - item.last);
    const double above = fall > 0 ? (r - error) / fall : kInfinity;
    ahead = std::max(ahead, above);
    surface = std::max(surface, above);
  }
  item.last = t;
  item.value = r;
  ahead = ahead > 0.5 * error ? ahead : 0.5 * error;  // of what is no number, too
  const bool hit = surface <= tolerance_ * t + error || evaluations_ >= kMostEvaluations;
  return hit ? -ahead : ahead;
}

double ObjectRays::each_by_itself() {
  while (!waiting_.empty()) {
    Item item = nearest();
    if (item.node) {
      open(item);
      continue;
    }
    const double ahead = evaluate(item, item.next);
    if (std::signbit(ahead)) return item.next - ahead;
    item.next += ahead;
    if (item.next >= item.end) continue;
    waiting_.push_back(item);
    std::push_heap(waiting_.begin(), waiting_.end());
  }
  return kInfinity;
}

double ObjectRays::all_together(double end) {
  double t = waiting_.empty() ? kInfinity : waiting_.front().next;
  while (t < end) {
    while (!waiting_.empty() && waiting_.front().next <= t) {
      const Item item = nearest();
      if (item.node) open(item);
      if (!item.node) open_.push_back(item);
    }
    double step = waiting_.empty() ? kInfinity : waiting_.front().next - t;
    std::size_t left = 0;
    for (Item& item : open_) {
      if (item.end < t) continue;
      const double ahead = evaluate(item, t);
      if (std::signbit(ahead)) return t - ahead;
      step = std::min(step, ahead);
      if (ahead < kInfinity) open_[left++] = item;
    }
    open_.resize(left);
    t += step;
  }
  return kInfinity;
}

}  // namespace sdfgrid
