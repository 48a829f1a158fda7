#include "sdfgrid/trace/grid_sampler.h"

#include <algorithm>
#include <glm/common.hpp>
#include <glm/geometric.hpp>
#include <optional>

#include "sdfgrid/core/error.h"
#include "sdfgrid/grid/paint.h"
#include "sdfgrid/trace/flattening.h"
#include "sdfgrid/trace/trace.h"

namespace sdfgrid {
namespace {

// The trilinear field in voxels, as far as the grid has one.
double sampled_voxels(const Atlas& atlas, const glm::dvec3& p, double to_box) {
  // Samples beyond the box are all background.
  const bool far = to_box > 2 * atlas.lattice.voxel;
  return far ? double(atlas.outside) : double(distance_at(atlas, p)) / atlas.lattice.voxel;
}

double distance_to(const Box& box, const glm::dvec3& p) {
  return glm::length(p - glm::clamp(p, box.lo, box.hi));
}

class GridSampler : public Sampler {
 public:
  GridSampler(Atlas atlas, const Grid& grid, std::map<int, int> paint_tags, const Job& job)
      : atlas_(std::move(atlas)),
        phi_(atlas_, job),
        box_(grid.bounds()),
        paint_tags_(std::move(paint_tags)) {
    // Caps on holes may lie beyond all active voxels, and so does where the outermost of them end.
    const Box inside = world_box(phi_.cells_below(0));
    if (!inside.empty()) box_ = {glm::min(box_.lo, inside.lo), glm::max(box_.hi, inside.hi)};
    if (!paint_tags_.empty()) painted_ = grid;
  }

  void evaluate(int n, const float* x, const float* y, const float* z, float* out) const override {
    for (int i = 0; i < n; ++i) out[i] = static_cast<float>(value({x[i], y[i], z[i]}));
  }
  [[nodiscard]] Box hull() const override { return box_; }
  [[nodiscard]] Box bounds(double level) const override {
    const Box near = world_box(phi_.cells_below(level / atlas_.lattice.voxel));
    if (near.empty()) return near;
    const Box far = Sampler::bounds(level);
    return {glm::max(near.lo, far.lo), glm::min(near.hi, far.hi)};
  }
  [[nodiscard]] double value(const glm::dvec3& p) const override {
    const double to_box = distance_to(box_, p);
    const double flat = phi_(sampled_voxels(atlas_, p, to_box)) * atlas_.lattice.voxel;
    return to_box > 0 ? std::max(flat, to_box) : flat;
  }
  [[nodiscard]] double step() const override { return 0.1 * atlas_.lattice.voxel; }
  [[nodiscard]] double value_at(double distance) const override {
    return phi_(distance / atlas_.lattice.voxel) * atlas_.lattice.voxel;
  }
  [[nodiscard]] double reach_inside() const override {
    return phi_.reach_inside() * atlas_.lattice.voxel;
  }
  [[nodiscard]] double reach_outside() const override {
    return phi_(atlas_.outside) * atlas_.lattice.voxel;
  }
  [[nodiscard]] int tag(const glm::dvec3& p) const override {
    if (!painted_) return -1;
    const auto known = paint_tags_.find(PaintReader(*painted_).at(p));
    return known != paint_tags_.end() ? known->second : -1;
  }

 private:
  // Of a box in cells of the atlas.
  [[nodiscard]] Box world_box(const Box& cells) const {
    if (cells.empty()) return cells;
    const glm::dvec3 base(atlas_.lo * Atlas::kBrick);
    return {atlas_.lattice.to_world(base + cells.lo), atlas_.lattice.to_world(base + cells.hi)};
  }

  Atlas atlas_;
  Flattening phi_;
  Box box_;
  std::map<int, int> paint_tags_;
  std::optional<Grid> painted_;
};

}  // namespace

double trilinear_distance(const Atlas& atlas, const Box& box, const glm::dvec3& p) {
  const double to_box = distance_to(box, p);
  const double value = sampled_voxels(atlas, p, to_box) * atlas.lattice.voxel;
  return to_box > 0 ? std::max(value, to_box) : value;
}

void check_has_inside(const Grid& grid) {
  if (!grid.is_level_set()) {
    throw Error(ErrorKind::input,
                "the grid's distances have no sign, so that it has no value; convert the mesh "
                "with --sign winding");
  }
  if (grid.bounds().empty()) throw Error(ErrorKind::input, "the grid has no voxels");
}

std::shared_ptr<const Sampler> make_sampler(const Grid& grid, const Job& job,
                                            const std::map<int, int>& paint_tags) {
  check_has_inside(grid);
  return std::make_shared<GridSampler>(make_atlas(grid, job), grid, paint_tags, job);
}

}  // namespace sdfgrid
