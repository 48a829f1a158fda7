// tests/field/solids.h: what solid a node is, by its definition: sums of powers, orbits, nearest
// points by search, points mapped back; in double, sharing nothing with the formulas of the ops.
#pragma once

#include <cmath>
#include <functional>

#include "field/examples.h"

using Vec = glm::dvec3;

inline double norm(const Vec& v) { return std::sqrt(v.x * v.x + v.y * v.y + v.z * v.z); }

// Whether a point is in a solid.
using Inside = std::function<bool(const Vec&)>;

// Throws std::runtime_error for an op that has no definition here: a new op needs one.
Inside solid_of(const ExampleNode& node);
inline Inside solid_of(const Example& e) { return e.solid ? e.solid : solid_of(e.node); }

// Those of leaves, and of ops of other nodes; null if there is none of that word.
Inside leaf_solid(const ExampleNode& node);
Inside combined_solid(const ExampleNode& node);

// The arguments of a node, with the defaults that its op says.
class Given {
 public:
  explicit Given(const ExampleNode& node) : node_(node) {}
  double operator()(const char* name) const;            // one number
  Vec vector(const char* name) const;                   // three; one stands for all
  std::vector<double> numbers(const char* name) const;  // none if it is a list without default
  std::vector<Vec> points(const char* name) const;
  std::string text(const char* name, const char* fallback) const;

 private:
  const ExampleNode& node_;
};

// Those of fractals and of solids with faces.
Inside faceted_solid(const Given& given);
Inside menger(const Given& given);
Inside sierpinski(const Given& given);
Inside julia(const Given& given);
Inside mandelbrot(const Given& given);
Inside mandelbulb(const Given& given);
// The corners of a solid of `gdf` by its name, as books have them; its nearest faces at any
// distance.
std::vector<Vec> solid_corners(const std::string& name);

// Noise of several octaves, with whole numbers for hashes: what terrain and displacement are made
// of.
struct NoiseSum {
  double frequency, amplitude, beta;
  int octaves, seed;
  double operator()(const Vec& p) const;
};
