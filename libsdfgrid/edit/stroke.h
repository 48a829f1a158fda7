// edit/stroke.h: what a stroke is: a brush moved along a path, and what it does to the grid.
// Positions and lengths are in world units.
#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <glm/vec3.hpp>
#include <memory>
#include <string>
#include <string_view>
#include <vector>

#include "sdfgrid/core/lattice.h"

namespace sdfgrid {

enum class StrokeOp : std::uint8_t {
  unite,      // add the brush
  subtract,   // take it away
  intersect,  // keep only what is within it
  inflate,    // move the surface outwards within the brush
  deflate,    // and inwards
  flatten,    // move the surface towards the plane of the path's first point
  smooth,     // even it out
  pinch,      // draw it together towards the path
  paint,      // give the samples of the band within the brush a material
};

// The word for it in stroke files ("union", "difference", ...).
[[nodiscard]] std::string_view stroke_op_word(StrokeOp op);
[[nodiscard]] bool is_csg(StrokeOp op);

// A brush that is no ball: distances in its own coordinates, whose origin follows the path.
struct BrushShape {
  // Writes the distance (world units, negative inside) at each of `count` points. Called from
  // several threads at once.
  std::function<void(const float* x, const float* y, const float* z, float* distance,
                     std::size_t count)>
      distances;
  Box bounds;         // of the solid, in its own coordinates; must not be empty
  bool exact = true;  // whether those are true distances, or only bounds of them
  // Whether they may be so much smaller than the distances that they stand for those only when they
  // are divided by their slope.
  bool shallow = false;
};

struct Brush {
  double radius = 0;                        // of the ball, or of what clay tools reach
  std::shared_ptr<const BrushShape> shape;  // in place of the ball
};

// A file that a brush is made of (edit/stamp.h).
struct Stamp {
  enum class Kind : std::uint8_t { grid, scene };
  Kind kind = Kind::grid;
  std::string file;   // its path
  bool kept = false;  // whether it is named by the hash of its contents
};

struct PathPoint {
  glm::dvec3 at{0.0};
  double pressure = 1;  // scales the brush, and a clay tool's strength; in (0, 1]
};

// The plane of one coordinate: axis 0, 1 or 2 at `at`.
struct MirrorPlane {
  int axis = 0;
  double at = 0;
};

struct Stroke {
  StrokeOp op = StrokeOp::unite;
  Brush brush;
  std::vector<PathPoint> path;
  double spacing = 0.25;   // between places of the brush along the path, in radii of it
  bool at_points = false;  // put it down at the path's points alone, neither swept nor spaced
  double smooth = 0;       // width of the blend of a CSG stroke; 0: a sharp edge
  double strength = 0.5;   // of a clay tool, in (0, 1]
  int material = 0;        // that paint gives, up to kMostMaterial; 0 takes paint away
  std::string text;        // as in a stroke file, one line; empty for a stroke made in code
  int line = 0;            // of the file, where it begins; 0 for a stroke made in code
  std::vector<MirrorPlane> mirror;  // the stroke is repeated on the other side of each
  std::vector<Stamp> stamps;        // that the brush is made of, in the order of the text
};

}  // namespace sdfgrid
