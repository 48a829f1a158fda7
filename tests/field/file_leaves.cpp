#include "field/file_leaves.h"

#include <cmath>
#include <memory>

#include "property/random_meshes.h"
#include "sdfgrid/grid/convert.h"
#include "sdfgrid/scene/words.h"
#include "sdfgrid/trace/grid_sampler.h"

namespace {

using namespace sdfgrid;

const OpEntry& word(std::string_view name) {
  for (const OpEntry& each : scene_words()) {
    if (each.info->name == name) return each;
  }
  throw std::runtime_error("no such word of scenes");
}

// The solid is where the samples, interpolated in double, are negative: the leaf itself is pressed
// together where that is steeper than a distance.
Example leaf(std::string_view name, const std::string& text, const TriangleSoup& soup,
             const ConvertOptions& options) {
  const Grid grid = convert_mesh(soup, options, Job()).grid;
  const auto atlas = std::make_shared<const Atlas>(make_atlas(grid, Job()));
  Example made{
      &word(name), {std::string(name), {}, {}}, make_field(make_sampler(grid, Job())), text};
  made.sampled = true;
  made.solid = [atlas, box = grid.bounds()](const glm::dvec3& p) {
    return trilinear_distance(*atlas, box, p) < 0;
  };
  return made;
}

}  // namespace

std::vector<Example> file_leaves() {
  ConvertOptions narrow;
  narrow.dim = 24;
  ConvertOptions uneven = narrow;
  uneven.band = {2, 9};
  ConvertOptions dense = narrow;
  dense.band = {40, 40};
  const TriangleSoup torus = shapes::torus_mesh(1, 0.4);
  const TriangleSoup box = shapes::box_mesh(glm::dvec3(-1, -0.7, -0.5), glm::dvec3(1, 0.7, 0.5));
  std::vector<Example> all;
  all.push_back(leaf("grid", "grid: a torus with a band of 3 voxels", torus, narrow));
  all.push_back(leaf("grid", "grid: a box with a band of 2 and 9 voxels", box, uneven));
  all.push_back(leaf("grid", "grid: a torus with samples everywhere", torus, dense));
  all.push_back(leaf("mesh", "mesh: a box", box, narrow));
  // In space that is stretched, and with another leaf.
  Example moved = all.front();
  moved.text = "grid: a torus turned, scaled and joined";
  const Field turned = make_field("rotate", {{"by", {20, 30, 40}}}, {moved.field});
  const Field scaled = make_field("scale", {{"by", {1, 0.5, 0.7}}}, {turned});
  const Field ball = make_field("sphere", {{"radius", 0.4}});
  moved.field = make_field("smooth_union", {{"k", 0.2}}, {scaled, ball});
  moved.solid = [field = moved.field](const glm::dvec3& p) { return field.gradient(p).value < 0; };
  all.push_back(moved);
  return all;
}
