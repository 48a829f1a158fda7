#include "sdfgrid/trace/grid_sampler.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <glm/common.hpp>
#include <glm/geometric.hpp>
#include <limits>
#include <mutex>
#include <optional>
#include <vector>

#include "sdfgrid/core/error.h"
#include "sdfgrid/core/parallel.h"
#include "sdfgrid/grid/paint.h"
#include "sdfgrid/trace/trace.h"

namespace sdfgrid {
namespace {

// How a trilinear field becomes 1-Lipschitz: its values v go to phi(v), where phi(0) = 0 and phi'
// is one over the steepest gradient that the field has anywhere at that value. Between samples
// distances are steeper than 1 where two sides are equally near, which a cube has at every depth
// inside, and outside beside its edges only.
class Flattening {
 public:
  explicit Flattening(const Atlas& atlas) {
    double most = atlas.outside;
    cut_off_ = std::count(atlas.bricks.begin(), atlas.bricks.end(), Atlas::kInside) > 0;
    if (cut_off_) least_ = atlas.inside;
    for (const float v : atlas.samples) {
      if (!std::isfinite(v)) continue;
      least_ = std::min(least_, double(v));
      most = std::max(most, double(v));
    }
    bin_ = std::max(1.0 / 8, std::max(most, -least_) / kMostBins);
    sides_ = {std::vector<float>(bins(-least_), 1), std::vector<float>(bins(most), 1)};
  }

  // The values that are known inside, voxels: all, where no brick is without samples.
  [[nodiscard]] double reach_inside() const {
    return cut_off_ ? -(*this)(least_) : std::numeric_limits<double>::infinity();
  }

  void measure(const Atlas& atlas, const Job& job) {
    boxes_.resize(sides_[1].size() + 2);
    std::mutex merging;
    const auto columns = static_cast<std::size_t>(atlas.dims.x) * atlas.dims.y;
    parallel_for(columns, 8, job, [&](std::size_t begin, std::size_t end) {
      Sides steepest = sides_;
      std::vector<Box> boxes(boxes_.size());
      for (std::size_t i = begin; i < end; ++i) {
        const auto n = static_cast<int>(i);
        for (int z = 0; z < atlas.dims.z; ++z) {
          const glm::ivec3 slot(n / atlas.dims.y, n % atlas.dims.y, z);
          const std::int32_t brick = atlas.bricks[atlas.place(slot)];
          if (brick < 0) {
            if (brick == Atlas::kInside) add_box(slot, glm::ivec3(0), Atlas::kBrick, boxes[0]);
            continue;
          }
          const float* samples = atlas.samples.data() + std::size_t(brick) * Atlas::kSamples;
          add_brick(samples, slot, steepest, boxes);
        }
      }
      const std::scoped_lock lock(merging);
      for (std::size_t i = 0; i < boxes.size(); ++i) join(boxes[i], boxes_[i]);
      for (const int side : {0, 1}) {
        for (std::size_t i = 0; i < steepest[side].size(); ++i) {
          sides_[side][i] = std::max(sides_[side][i], steepest[side][i]);
        }
      }
    });
    for (std::size_t i = 1; i < boxes_.size(); ++i) join(boxes_[i - 1], boxes_[i]);
    for (const int side : {0, 1}) {
      sums_[side] = {0};
      for (const float square : sides_[side]) {
        constexpr double kRounding = 1 + 1e-6;
        sums_[side].push_back(sums_[side].back() + bin_ / (kRounding * std::sqrt(double(square))));
      }
    }
  }

  // In cells of the atlas a box of all where phi is below a level, if that is within the band.
  [[nodiscard]] Box cells_below(double level) const {
    if (level <= 0) return boxes_[0];
    const std::vector<double>& sums = sums_[1];
    const auto n = std::lower_bound(sums.begin(), sums.end(), level) - sums.begin();
    const bool beyond = static_cast<std::size_t>(n) >= sums.size();
    if (beyond) return {glm::dvec3(-1e300), glm::dvec3(1e300)};
    return boxes_[static_cast<std::size_t>(n)];
  }

  // Beyond the band of slope 1.
  [[nodiscard]] double operator()(double v) const {
    const std::vector<double>& sums = sums_[v > 0 ? 1 : 0];
    const double at = std::fabs(v) / bin_;
    const auto last = sums.size() - 1;
    if (!(at < static_cast<double>(last))) {
      return std::copysign(sums[last] + (at - static_cast<double>(last)) * bin_, v);
    }
    const auto n = static_cast<std::size_t>(at);
    return std::copysign(sums[n] + (at - static_cast<double>(n)) * (sums[n + 1] - sums[n]), v);
  }

 private:
  using Sides = std::array<std::vector<float>, 2>;  // inside and outside, by the size of the value
  static constexpr double kMostBins = 2048;

  [[nodiscard]] std::size_t bins(double width) const {
    return static_cast<std::size_t>(std::ceil(std::max(width, 0.0) / bin_)) + 1;
  }

  // Each of the gradient's components is linear in each of the other coordinates, so that the
  // square of its length is convex in each: it is largest at a corner of a cell.
  void add_brick(const float* samples, const glm::ivec3& slot, Sides& steepest,
                 std::vector<Box>& boxes) const {
    constexpr int kEdge = Atlas::kEdge;
    for (int i = 0; i < Atlas::kBrick * Atlas::kBrick * Atlas::kBrick; ++i) {
      const glm::ivec3 at(i >> 6, i >> 3 & 7, i & 7);
      const float* cell = samples + (at.x * kEdge + at.y) * kEdge + at.z;
      float v[8];
      for (int n = 0; n < 8; ++n) v[n] = cell[((n >> 2) * kEdge + (n >> 1 & 1)) * kEdge + (n & 1)];
      float most_square = 0;
      for (int n = 0; n < 8; ++n) {
        const float a = v[n ^ 4] - v[n];
        const float b = v[n ^ 2] - v[n];
        const float c = v[n ^ 1] - v[n];
        most_square = std::max(most_square, a * a + b * b + c * c);
      }
      const auto [least, most] = std::minmax_element(std::begin(v), std::end(v));
      if (!(std::isfinite(*least) && std::isfinite(*most) && most_square < 1e30F)) continue;
      const double bin = *least < 0 ? 0 : 1 + *least / bin_;
      if (bin < static_cast<double>(boxes.size())) add_box(slot, at, 1, boxes[std::size_t(bin)]);
      if (!(most_square > 1)) continue;
      raise(steepest[0], -*most, -*least, most_square);
      raise(steepest[1], *least, *most, most_square);
    }
  }

  static void join(const Box& from, Box& box) {
    if (from.empty()) return;
    box.add(from.lo);
    box.add(from.hi);
  }
  // Cells, `edge` a side, from `at` of a slot on.
  static void add_box(const glm::ivec3& slot, const glm::ivec3& at, int edge, Box& box) {
    const glm::dvec3 lo(slot * Atlas::kBrick + at);
    box.add(lo);
    box.add(lo + double(edge));
  }

  // In the bins from one value to another, as far as they are positive.
  void raise(std::vector<float>& side, double from, double to, float square) const {
    if (to < 0) return;
    const std::size_t first =
        std::min(side.size(), static_cast<std::size_t>(std::max(from, 0.0) / bin_));
    const std::size_t end = std::min(side.size(), static_cast<std::size_t>(to / bin_) + 1);
    for (std::size_t n = first; n < end; ++n) side[n] = std::max(side[n], square);
  }

  bool cut_off_ = false;
  double least_ = 0;                         // voxels
  double bin_ = 1;                           // voxels
  Sides sides_;                              // squares of the steepest gradients
  std::array<std::vector<double>, 2> sums_;  // of phi at the ends of the bins
  // Of the cells with negative samples, then with such below the start of bin 0, 1, ... too.
  std::vector<Box> boxes_;
};

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
        box_(grid.bounds()),
        phi_(atlas_),
        paint_tags_(std::move(paint_tags)) {
    phi_.measure(atlas_, job);
    if (!paint_tags_.empty()) painted_ = grid;
  }

  void evaluate(int n, const float* x, const float* y, const float* z, float* out) const override {
    for (int i = 0; i < n; ++i) out[i] = static_cast<float>(value({x[i], y[i], z[i]}));
  }
  [[nodiscard]] Box hull() const override { return box_; }
  [[nodiscard]] Box bounds(double level) const override {
    const Box near = phi_.cells_below(level / atlas_.lattice.voxel);
    const Box far = Sampler::bounds(level);
    if (near.empty()) return near;
    const glm::dvec3 base(atlas_.lo * Atlas::kBrick);
    // One cell more: those before a brick's first samples belong to a slot that may have no brick.
    const Box box{atlas_.lattice.to_world(base + near.lo - 1.0),
                  atlas_.lattice.to_world(base + near.hi)};
    return {glm::max(box.lo, far.lo), glm::min(box.hi, far.hi)};
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
  Atlas atlas_;
  Box box_;
  Flattening phi_;
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
