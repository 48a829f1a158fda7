// trace/object_rays.h: many objects, met by one ray at a time (internal to trace/).
//
// After J. C. Hart, "Sphere Tracing" (1996), figure 5, and G. Krayer (2016), algorithm 1: what lies
// along the ray, boxes and objects, waits in a heap, nearest first; a box is replaced by what is in
// it, an object by its next place on the ray. field_trace.h has the switches.
#pragma once

#include <cstdint>
#include <vector>

#include "sdfgrid/trace/object_tree.h"

namespace sdfgrid {

// Memory is kept from one ray to the next.
class ObjectRays {
 public:
  struct Result {
    double depth;  // of the first hit, infinite if there is none
    std::uint32_t evaluations;
  };
  // Of a ray that begins outside of all objects; the tolerance is that of FieldTracer::trace.
  Result trace(const ObjectTree& tree, const ObjectRules& rules, double tolerance, const Ray& ray);

 private:
  // What waits: a box, or an object that is evaluated at `next` unless it ends before.
  struct Item {
    double next;
    std::uint32_t index;  // of a node or an object
    bool node;
    double end;
    double last = -1;  // where it was evaluated before, if it was, and
    double value = 0;  // what it was there
    bool operator<(const Item& other) const { return next > other.next; }
  };

  void add(std::uint32_t index, bool node, const Box& box);
  [[nodiscard]] Item nearest();
  void open(const Item& node);
  [[nodiscard]] double evaluate(Item& item, double t);
  [[nodiscard]] double each_by_itself();
  [[nodiscard]] double all_together(double end);

  const ObjectTree* tree_ = nullptr;
  ObjectRules rules_;
  double tolerance_ = 0;
  Ray ray_{};
  std::uint32_t evaluations_ = 0;
  std::vector<Item> waiting_, open_;
};

}  // namespace sdfgrid
