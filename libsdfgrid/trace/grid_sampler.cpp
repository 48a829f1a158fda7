#include "sdfgrid/trace/grid_sampler.h"

#include <algorithm>
#include <cmath>
#include <glm/common.hpp>
#include <glm/geometric.hpp>

#include "sdfgrid/core/error.h"
#include "sdfgrid/grid/atlas.h"
#include "sdfgrid/trace/trace.h"

namespace sdfgrid {
namespace {

class GridSampler : public Sampler {
 public:
  GridSampler(Atlas atlas, const Box& box)
      : atlas_(std::move(atlas)), box_(box), scale_(1.0 / std::max(1.0F, atlas_.slope)) {}

  void evaluate(int n, const float* x, const float* y, const float* z, float* out) const override {
    for (int i = 0; i < n; ++i) {
      const glm::dvec3 p(x[i], y[i], z[i]);
      const double to_box = glm::length(p - glm::clamp(p, box_.lo, box_.hi));
      // Samples beyond the box are all background.
      const bool far = to_box > 2 * atlas_.lattice.voxel;
      const double sampled =
          far ? double(atlas_.outside) * atlas_.lattice.voxel : double(distance_at(atlas_, p));
      const double value = sampled * scale_;
      out[i] = static_cast<float>(to_box > 0 ? std::max(value, to_box) : value);
    }
  }
  [[nodiscard]] Box bounds() const override { return box_; }

 private:
  Atlas atlas_;
  Box box_;
  double scale_;
};

}  // namespace

std::shared_ptr<const Sampler> make_sampler(const Grid& grid, const Job& job) {
  if (!grid.is_level_set()) {
    throw Error(ErrorKind::input,
                "the grid's distances have no sign, so that it has no value; convert the mesh "
                "with --sign winding");
  }
  const Box box = grid.bounds();
  if (box.empty()) throw Error(ErrorKind::input, "the grid has no voxels");
  return std::make_shared<GridSampler>(make_atlas(grid, job), box);
}

}  // namespace sdfgrid
