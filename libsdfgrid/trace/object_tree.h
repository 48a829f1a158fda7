// trace/object_tree.h: many objects, found by rays through a hierarchy of boxes (internal to
// trace/).
//
// After J. C. Hart, "Sphere Tracing" (1996), figure 5, and G. Krayer (2016), algorithm 1: what lies
// along a ray, boxes and objects, waits in a heap, nearest first; a box is replaced by the two in
// it, an object is traced within its box. An object that was evaluated is next evaluated where
// that value ends, whatever the others make of the ray: the triangle inequality bounds it until
// then. Here a heap serves a bundle of rays, each entry with those groups of sixteen that may meet
// it.
#pragma once

#include <memory>
#include <vector>

#include "sdfgrid/field/parts.h"
#include "sdfgrid/trace/field_march.h"

namespace sdfgrid {

// Which of the things that spare rays objects are used: see FieldTraceOptions.
struct ObjectRules {
  bool boxes = true;
  bool apart = true;  // FieldTraceOptions::objects
  bool convex = true;
};

class ObjectTree {
 public:
  struct Object {
    Field field;
    Box box;
    bool convex = false;
    std::unique_ptr<const LocalBounds> bounds;  // none where they would not help
  };
  // Boxes of objects end at the region's; `slopes`: ask for local bounds. Those without end
  // are as large as it.
  ObjectTree(std::vector<FieldPart> parts, const Box& region, bool slopes);

  [[nodiscard]] const std::vector<Object>& objects() const { return objects_; }
  [[nodiscard]] const Box& region() const { return region_; }

  // First hits of all rays of the bundle, which start outside of all objects, each object by
  // itself. Of `rules` convex and bounds are set for each object.
  void trace(Bundle& bundle, const MarchRules& rules, const ObjectRules& use,
             FieldMarch& march) const;

  // An inner node has its two children at `first` and the next place; a leaf (count 1) its object.
  struct Node {
    Box box;
    std::uint32_t first = 0;
    std::uint32_t count = 0;
  };
  // The root is the first; none if there are no objects.
  [[nodiscard]] const std::vector<Node>& nodes() const { return nodes_; }

 private:
  void build(std::uint32_t node, std::uint32_t begin, std::uint32_t end);

  Box region_;
  std::vector<Object> objects_;
  std::vector<Node> nodes_;
};

// Local bounds of a field over a box; null where it is nowhere less steep than a distance.
[[nodiscard]] std::unique_ptr<const LocalBounds> useful_bounds(const Field& field, const Box& box,
                                                               int levels);

}  // namespace sdfgrid
