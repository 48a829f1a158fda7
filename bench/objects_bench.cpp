// Many objects: what a ray costs with each of the things that spare it objects switched on and off.
//   boxes     a hierarchy of boxes and a heap ordered by distance; off: all objects of the scene
//   triangle  an object is evaluated only where its last value ends; off: at every step of the ray
//   convex    steps past convex objects follow the secant
// one ray at a time, as Hart (1996) and Krayer (2016) have it, and then as FieldTracer does it, in
// bundles, all on and without objects. Objects: spheres, boxes, capsules, tori, turned any way, a
// hundredth of a cube full; and nine spheres over a plane. Then a thousand of them with others
// beside and behind the view, which no ray comes near: `objects` counts those. CSV on standard
// output.
// usage: objects_bench [MOST_OBJECTS]; one thread, CPU time
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <ctime>
#include <glm/common.hpp>
#include <glm/geometric.hpp>
#include <limits>
#include <numbers>
#include <numeric>
#include <random>
#include <string_view>
#include <vector>

#include "sdfgrid/core/parallel.h"
#include "sdfgrid/field/field.h"
#include "sdfgrid/field/parts.h"
#include "sdfgrid/trace/field_trace.h"
#include "sdfgrid/trace/object_tree.h"

using namespace sdfgrid;

namespace {

constexpr double kInfinity = std::numeric_limits<double>::infinity();
constexpr double kRadian = std::numbers::pi / 180;
constexpr int kSide = 256;  // pixels of the picture
constexpr const char* kOthers = "a thousand and others";
constexpr int kSets = 8;  // of switches

double cpu_seconds() { return static_cast<double>(std::clock()) / CLOCKS_PER_SEC; }

// So large that `count` of them fill a hundredth of a cube of edge 2.
class RandomObjects {
 public:
  explicit RandomObjects(int count) : size_(0.45 * std::cbrt(1.0 / count)) {}

  double unit() { return std::uniform_real_distribution<double>(0, 1)(random_); }
  [[nodiscard]] double size() const { return size_; }

  // The i-th, at the origin, turned any way.
  Field next(int i) {
    const double r = size_ * (0.4 + 0.6 * unit());
    Field node;
    switch (i % 4) {
      case 0:
        node = make_field("sphere", {{"radius", r}});
        break;
      case 1:
        node = make_field("box", {{"size", {1.5 * r, 1.2 * r, r}}});
        break;
      case 2:
        node = make_field("torus", {{"major", r}, {"minor", 0.3 * r}});
        break;
      default:
        node =
            make_field("capsule", {{"from", {0, 0, -r}}, {"to", {0, 0, r}}, {"radius", 0.4 * r}});
    }
    const auto angle = [&] { return 360 * unit(); };
    return make_field("rotate", {{"by", {angle(), angle(), angle()}}}, {node});
  }
  // A place in a cube of half the edge `reach`.
  glm::dvec3 place(double reach) {
    const auto one = [&] { return reach * (2 * unit() - 1); };
    return {one(), one(), one()};
  }

 private:
  double size_;
  std::mt19937 random_{5};
};

Field moved(const Field& node, const glm::dvec3& by) {
  return make_field("translate", {{"by", {by.x, by.y, by.z}}}, {node});
}

std::vector<Field> strewn(RandomObjects& random, int count) {
  std::vector<Field> nodes;
  for (int i = 0; i < count; ++i) {
    const Field node = random.next(i);
    nodes.push_back(moved(node, random.place(1)));
  }
  return nodes;
}

Field random_objects(int count) {
  RandomObjects random(count);
  return make_field("union", {}, strewn(random, count));
}

Field nine_spheres() {
  std::vector<Field> nodes = {make_field(
      "intersection", {},
      {make_field("plane", {{"normal", {0, 1, 0}}}), make_field("box", {{"size", {3, 1, 3}}})})};
  for (int i = 0; i < 9; ++i) {
    nodes.push_back(make_field("translate", {{"by", {i % 3 - 1.0, 0.3, i / 3 - 1.0}}},
                               {make_field("sphere", {{"radius", 0.3}})}));
  }
  return make_field("union", {}, nodes);
}

struct Switches {
  bool boxes, triangle, convex;
};

// An object on a ray's way: where it is evaluated next, and what it was before.
struct Item {
  double next;
  std::uint32_t index;
  bool node;
  double end = kInfinity;
  double last = -1;
  double value = 0;
  bool operator<(const Item& other) const { return next > other.next; }
};

// One ray after the other, object by object.
class SingleRays {
 public:
  SingleRays(const ObjectTree& tree, const Box& region, double tolerance, const Switches& on)
      : tree_(tree), region_(region), tolerance_(tolerance), on_(on) {}

  double trace(const Ray& ray) {
    ray_ = ray;
    const Span all = clip(ray, region_);
    if (!(all.from < all.to)) return kInfinity;
    waiting_.clear();
    open_.clear();
    if (on_.boxes) {
      add(0, true, tree_.nodes()[0].box);
    } else {
      for (std::uint32_t i = 0; i < tree_.objects().size(); ++i) {
        waiting_.push_back({all.from, i, false, all.to});
      }
    }
    return on_.triangle ? each_by_itself() : all_together(all.to);
  }

  std::size_t evaluations = 0;

 private:
  void add(std::uint32_t index, bool node, const Box& box) {
    const Span s = clip(ray_, box);
    if (!(s.from <= s.to)) return;
    waiting_.push_back({s.from, index, node, s.to});
    std::push_heap(waiting_.begin(), waiting_.end());
  }
  Item nearest() {
    std::pop_heap(waiting_.begin(), waiting_.end());
    const Item item = waiting_.back();
    waiting_.pop_back();
    return item;
  }
  void open(const Item& item) {
    const ObjectTree::Node& node = tree_.nodes()[item.index];
    if (node.count == 1) {
      add(node.first, false, node.box);
    } else {
      add(node.first, true, tree_.nodes()[node.first].box);
      add(node.first + 1, true, tree_.nodes()[node.first + 1].box);
    }
  }

  // Evaluates at t; how far the object leaves the way free, or -1 if it is hit.
  double evaluate(Item& item, double t) {
    ++evaluations;
    const ObjectTree::Object& object = tree_.objects()[item.index];
    const glm::dvec3 p = ray_.origin + t * ray_.direction;
    const double r = static_cast<double>(object.field(glm::vec3(p)));
    const double error = kFieldSlack * std::max({std::fabs(p.x), std::fabs(p.y), std::fabs(p.z)});
    double ahead = r;
    if (on_.convex && object.convex && item.last >= 0 && t > item.last) {
      const double fall = (item.value - r + 2 * error) / (t - item.last);
      ahead = fall > 0 ? std::max(r, (r - error) / fall) : kInfinity;
    }
    item.last = t;
    item.value = r;
    return ahead < tolerance_ * t + error ? -1 : ahead;
  }

  double each_by_itself() {
    while (!waiting_.empty()) {
      Item item = nearest();
      if (item.node) {
        open(item);
        continue;
      }
      const double ahead = evaluate(item, item.next);
      if (ahead < 0) return item.next;
      item.next += ahead;
      if (item.next >= item.end) continue;
      waiting_.push_back(item);
      std::push_heap(waiting_.begin(), waiting_.end());
    }
    return kInfinity;
  }

  // All objects whose boxes the ray is in, at every step.
  double all_together(double end) {
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
        if (ahead < 0) return t;
        step = std::min(step, ahead);
        if (ahead < kInfinity) open_[left++] = item;
      }
      open_.resize(left);
      t += std::max(step, 1e-9);
    }
    return kInfinity;
  }

  const ObjectTree& tree_;
  Box region_;
  double tolerance_;
  Switches on_;
  Ray ray_{};
  std::vector<Item> waiting_;
  std::vector<Item> open_;
};

struct Shot {
  Field field;
  Box region;
  Camera camera;
};

void report(const char* scene, int objects, const char* how, std::size_t rays, double evaluations,
            double seconds, std::size_t hits) {
  const auto n = static_cast<double>(rays);
  fmt::print("{},{},{},{},{:.3f},{:.3f},{:.4f}\n", scene, objects, how, rays, evaluations / n,
             1e6 * seconds / n, static_cast<double>(hits) / n);
}

// With every set of switches, or the last of them: all on.
void single(const char* scene, int objects, const Shot& view, int first_set = 0) {
  const ObjectTree tree(parts_of(view.field), view.region, false);
  const RayGenerator generator(view.camera);
  const double tolerance = 0.02 * glm::length(generator.right());
  // The same pixels in the same order, as many as there is time for.
  std::vector<int> pixels(kSide * kSide);
  std::iota(pixels.begin(), pixels.end(), 0);
  std::shuffle(pixels.begin(), pixels.end(), std::mt19937(1));
  for (int bits = first_set; bits < kSets; ++bits) {
    const Switches on{(bits & 1) != 0, (bits & 2) != 0, (bits & 4) != 0};
    const int most = on.boxes ? 8192 : std::clamp(400000 / std::max(objects, 1), 8, 8192);
    SingleRays rays(tree, view.region, tolerance, on);
    std::size_t hits = 0;
    const double start = cpu_seconds();
    for (int i = 0; i < most; ++i) {
      const Ray ray = generator.ray(pixels[i] % kSide + 0.5, pixels[i] / kSide + 0.5);
      hits += rays.trace(ray) < kInfinity ? 1 : 0;
    }
    const std::string how =
        fmt::format("{}{}{}{}", on.boxes ? " boxes" : "", on.triangle ? " triangle" : "",
                    on.convex ? " convex" : "", bits == 0 ? " none" : "");
    report(scene, objects, how.c_str() + 1, most, static_cast<double>(rays.evaluations),
           cpu_seconds() - start, hits);
  }
}

void bundles(const char* scene, int objects, const Shot& view) {
  for (const bool all : {true, false}) {
    if (!all && (objects > 2000 || std::string_view(scene) == kOthers)) continue;
    FieldTraceOptions options;
    options.objects = options.convex = all;
    const FieldTracer tracer(view.field, view.region, options);
    HitBuffer made;
    double seconds = kInfinity;  // the least of a few
    for (int i = 0; i < (all ? 5 : 1); ++i) {
      const double start = cpu_seconds();
      made = tracer.trace_primary(view.camera, Job());
      seconds = std::min(seconds, cpu_seconds() - start);
    }
    const double steps = std::accumulate(made.steps.begin(), made.steps.end(), 0.0);
    const auto hits = static_cast<std::size_t>(std::count_if(
        made.depth.begin(), made.depth.end(), [](float d) { return std::isfinite(d); }));
    report(scene, objects, all ? "bundles" : "bundles without objects", made.size(), steps, seconds,
           hits);
  }
}

// All others at least their own size away from what the camera sees: from the pyramid with the eye
// for its apex. As dense as those in view.
Shot with_others(int near, int others) {
  RandomObjects random(near);
  std::vector<Field> nodes = strewn(random, near);
  const Box view{glm::dvec3(-1.1), glm::dvec3(1.1)};
  const Camera camera = frame(view, kSide, kSide);
  const glm::dvec3 forward = glm::normalize(camera.target - camera.eye);
  const double corner = std::atan(std::sqrt(2.0) * std::tan(0.5 * camera.fov * kRadian));
  const double reach = std::cbrt(8.0 + 8.0 * others / near) + glm::length(camera.eye);
  for (int i = 0; i < others;) {
    const glm::dvec3 at = random.place(reach);
    const glm::dvec3 from_eye = at - camera.eye;
    const double ahead = glm::dot(from_eye, forward);
    const double aside = glm::length(from_eye - ahead * forward);
    const double gap = aside * std::cos(corner) - ahead * std::sin(corner);
    if (gap < 2 * random.size() || glm::length(at) < 2) continue;
    nodes.push_back(moved(random.next(i), at));
    ++i;
  }
  const Field field = make_field("union", {}, nodes);
  const Box box = field.bounds();
  return {field, {box.lo - 1e-3, box.hi + 1e-3}, camera};
}

void run(const char* scene, int objects, const Field& field) {
  const Box box = field.bounds();
  const Shot view{field, {box.lo - 1e-3, box.hi + 1e-3}, frame(box, kSide, kSide)};
  single(scene, objects, view);
  bundles(scene, objects, view);
}

}  // namespace

int main(int argc, char** argv) {
  const int most = argc > 1 ? std::atoi(argv[1]) : 100000;
  const ThreadLimit one(1);
  fmt::print("scene,objects,switches on,rays,evaluations a ray,microseconds a ray,hits\n");
  run("spheres and plane", 10, nine_spheres());
  for (int n = 10; n <= most; n *= 10) run("random", n, random_objects(n));
  for (int n = 0; n <= most; n = n == 0 ? 1000 : 10 * n) {
    const Shot view = with_others(1000, n);
    single(kOthers, n, view, kSets - 1);
    bundles(kOthers, n, view);
  }
  return 0;
}
