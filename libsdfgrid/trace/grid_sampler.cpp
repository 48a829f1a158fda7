#include "sdfgrid/trace/grid_sampler.h"

#include <algorithm>
#include <cmath>
#include <glm/common.hpp>
#include <glm/geometric.hpp>

#include "sdfgrid/core/error.h"
#include "sdfgrid/trace/trace.h"

namespace sdfgrid {
namespace {

// The trilinear field times `scale`.
double scaled_distance(const Atlas& atlas, const Box& box, const glm::dvec3& p, double scale) {
  const double to_box = glm::length(p - glm::clamp(p, box.lo, box.hi));
  // Samples beyond the box are all background.
  const bool far = to_box > 2 * atlas.lattice.voxel;
  const double sampled =
      far ? double(atlas.outside) * atlas.lattice.voxel : double(distance_at(atlas, p));
  const double value = sampled * scale;
  return to_box > 0 ? std::max(value, to_box) : value;
}

class GridSampler : public Sampler {
 public:
  GridSampler(Atlas atlas, const Box& box)
      : atlas_(std::move(atlas)), box_(box), scale_(1.0 / std::max(1.0F, atlas_.slope)) {}

  void evaluate(int n, const float* x, const float* y, const float* z, float* out) const override {
    for (int i = 0; i < n; ++i) {
      out[i] = static_cast<float>(scaled_distance(atlas_, box_, {x[i], y[i], z[i]}, scale_));
    }
  }
  [[nodiscard]] Box bounds() const override { return box_; }

 private:
  Atlas atlas_;
  Box box_;
  double scale_;
};

}  // namespace

double trilinear_distance(const Atlas& atlas, const Box& box, const glm::dvec3& p) {
  return scaled_distance(atlas, box, p, 1);
}

void check_has_inside(const Grid& grid) {
  if (!grid.is_level_set()) {
    throw Error(ErrorKind::input,
                "the grid's distances have no sign, so that it has no value; convert the mesh "
                "with --sign winding");
  }
  if (grid.bounds().empty()) throw Error(ErrorKind::input, "the grid has no voxels");
}

std::shared_ptr<const Sampler> make_sampler(const Grid& grid, const Job& job) {
  check_has_inside(grid);
  return std::make_shared<GridSampler>(make_atlas(grid, job), grid.bounds());
}

}  // namespace sdfgrid
