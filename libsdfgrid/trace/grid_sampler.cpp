#include "sdfgrid/trace/grid_sampler.h"

#include <algorithm>
#include <cmath>
#include <glm/common.hpp>
#include <glm/geometric.hpp>
#include <optional>

#include "sdfgrid/core/error.h"
#include "sdfgrid/grid/paint.h"
#include "sdfgrid/trace/band_distance.h"
#include "sdfgrid/trace/flattening.h"
#include "sdfgrid/trace/trace.h"
#include "sdfgrid/trace/walk.h"

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

// A lower bound on the distance to the surface that knows more than the band does. Where the band
// ends, phi of the trilinear field is at least `outside` of it; a way from beyond the band to the
// surface first leads to the band, and from there is at least that long. So beyond the band it is
// that and the distance to the band, and inside likewise. Beyond the tables it is the length of the
// way to them and of that from there on, at right angles: see ops::Region.
class GridSampler : public Sampler {
 public:
  GridSampler(Atlas atlas, const Grid& grid, std::map<int, int> paint_tags, const Job& job)
      : atlas_(std::move(atlas)),
        phi_(atlas_, job),
        band_(atlas_, job),
        outside_(phi_(atlas_.outside)),
        inside_(phi_(atlas_.inside)),
        first_(atlas_.lo * Atlas::kBrick),
        end_(atlas_.dims * Atlas::kBrick),
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
    const glm::dvec3 place = atlas_.lattice.to_index(p) - first_;
    glm::dvec3 nearest;
    for (int a = 0; a < 3; ++a) {
      nearest[a] = place[a] > 0 ? std::min(place[a], end_[a]) : 0;  // of what is no number, too
    }
    double voxels = in_tables(nearest);
    if (nearest != place) {
      const double there = std::max(voxels, 0.0);
      const glm::dvec3 away = place - nearest;
      voxels = std::sqrt(glm::dot(away, away) + there * there);
    }
    const double value = voxels * atlas_.lattice.voxel;
    const double to_box = distance_to(box_, p);
    return to_box > 0 ? std::max(value, to_box) : value;
  }
  [[nodiscard]] double step() const override { return 0.1 * atlas_.lattice.voxel; }
  [[nodiscard]] double value_at(double distance) const override {
    return phi_(distance / atlas_.lattice.voxel) * atlas_.lattice.voxel;
  }
  [[nodiscard]] double reach_inside() const override {
    return phi_.reach_inside() * atlas_.lattice.voxel;
  }
  [[nodiscard]] double reach_outside() const override { return outside_ * atlas_.lattice.voxel; }
  [[nodiscard]] int tag(const glm::dvec3& p) const override {
    if (!painted_) return -1;
    const auto known = paint_tags_.find(PaintReader(*painted_).at(p));
    return known != paint_tags_.end() ? known->second : -1;
  }

 private:
  // At a place in cells from the tables' first, voxels.
  [[nodiscard]] double in_tables(const glm::dvec3& place) const {
    constexpr int kBrick = Atlas::kBrick;
    const glm::ivec3 slot = glm::min(glm::ivec3(place) / kBrick, atlas_.dims - 1);
    const std::size_t i = atlas_.place(slot);
    const glm::dvec3 at = place - glm::dvec3(slot * kBrick);
    const std::int32_t brick = atlas_.bricks[i];
    if (band_.in_band(i)) {
      return phi_(brick >= 0 ? in_brick(brick, at) : sdfgrid::value_at(atlas_, place));
    }
    const double far = band_(i, at);
    // The last cells of a slot without a brick have samples of the slots after it, which may be
    // beyond the background, too.
    const bool last_cells = std::max({at.x, at.y, at.z}) > kBrick - 1;
    if (brick < 0 && !last_cells) return brick == Atlas::kInside ? inside_ - far : outside_ + far;
    const double flat = phi_(brick >= 0 ? in_brick(brick, at) : sdfgrid::value_at(atlas_, place));
    return flat < 0 ? std::min(flat, inside_ - far) : std::max(flat, outside_ + far);
  }

  [[nodiscard]] double in_brick(std::int32_t brick, const glm::dvec3& at) const {
    constexpr int kEdge = Atlas::kEdge;
    const glm::ivec3 cell = glm::min(glm::ivec3(at), Atlas::kBrick - 1);
    const glm::dvec3 part = at - glm::dvec3(cell);
    const float* const v = atlas_.samples.data() + std::size_t(brick) * Atlas::kSamples +
                           (cell.x * kEdge + cell.y) * kEdge + cell.z;
    const auto along = [](double a, double b, double t) { return a + t * (b - a); };
    const auto along_z = [&](int i) { return along(v[i], v[i + 1], part.z); };
    const auto along_y = [&](int i) { return along(along_z(i), along_z(i + kEdge), part.y); };
    return along(along_y(0), along_y(kEdge * kEdge), part.x);
  }

  // Of a box in cells of the atlas.
  [[nodiscard]] Box world_box(const Box& cells) const {
    if (cells.empty()) return cells;
    return {atlas_.lattice.to_world(first_ + cells.lo), atlas_.lattice.to_world(first_ + cells.hi)};
  }

  Atlas atlas_;
  Flattening phi_;
  BandDistance band_;
  double outside_, inside_;  // where the atlas has no samples, voxels
  glm::dvec3 first_, end_;   // index of the tables' first cell, and how many they have
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
