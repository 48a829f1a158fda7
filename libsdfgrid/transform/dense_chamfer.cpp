#include "sdfgrid/transform/dense_chamfer.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <vector>

#include "sdfgrid/core/parallel.h"
#include "sdfgrid/transform/chamfer.h"
#include "sdfgrid/transform/chamfer_kernel.h"
#include "sdfgrid/transform/chamfer_mask.h"
#include "sdfgrid/transform/dense_seeds.h"

namespace sdfgrid {
namespace {

constexpr float kFar = 1e30F;
constexpr int kMargin = 3;      // rows around a plane: the longest step
constexpr int kRowMargin = 16;  // numbers around a row, for the kernel

// The last planes of a pass, with far-away margins all around.
class Planes {
 public:
  explicit Planes(const glm::ivec3& dims)
      : stride_(static_cast<std::size_t>(dims.z + 15) / 16 * 16 + 2 * kRowMargin),
        rows_(dims.y + 2 * kMargin),
        numbers_(stride_ * static_cast<std::size_t>(rows_) * kKept, kFar) {}

  // Row j of plane i, j in [-kMargin, ny + kMargin).
  float* row(int i, int j) {
    const int plane = (i % kKept + kKept) % kKept;
    return numbers_.data() + static_cast<std::size_t>(plane * rows_ + j + kMargin) * stride_ +
           kRowMargin;
  }
  void clear(int i) {
    float* first = row(i, -kMargin) - kRowMargin;
    std::fill_n(first, stride_ * static_cast<std::size_t>(rows_), kFar);
  }

 private:
  static constexpr int kKept = kMargin + 1;
  std::size_t stride_;
  int rows_;
  std::vector<float> numbers_;
};

// Both passes for one side of the surface.
class ChamferPasses {
 public:
  ChamferPasses(const std::vector<MaskStep>& steps, const glm::ivec3& dims)
      : dims_(dims), planes_(dims) {
    for (const MaskStep& step : steps) {
      const glm::ivec3& o = step.offset;
      const auto length = static_cast<float>(step.length);
      if (o == glm::ivec3(0, 0, 1)) along_ = length;
      if (o.x < 0 || (o.x == 0 && o.y < 0)) steps_.push_back({o, length});
    }
    terms_.resize(steps_.size());
  }

  // load(i, j, row) writes what is known of a row before the pass, store(i, j, row) takes it after.
  template <class Load, class Store>
  void run(bool forward, const Load& load, const Store& store, const Job& job) {
    const ChamferKernel& kernel = chamfer_kernel();
    const int sign = forward ? 1 : -1;
    for (int i = -kMargin; i < 0; ++i) planes_.clear(i);
    for (int n = 0; n < dims_.x; ++n) {
      job.checkpoint();
      const int i = forward ? n : dims_.x - 1 - n;
      for (int m = 0; m < dims_.y; ++m) {
        const int j = forward ? m : dims_.y - 1 - m;
        float* row = planes_.row(n, j);
        load(i, j, row);
        for (std::size_t s = 0; s < steps_.size(); ++s) {
          const glm::ivec3& o = steps_[s].offset;
          terms_[s] = {planes_.row(n + o.x, j + sign * o.y) + sign * o.z, steps_[s].length};
        }
        kernel.relax(terms_.data(), static_cast<int>(terms_.size()), dims_.z, row);
        // The kernel works on whole vectors: what it put behind the row must stay far away.
        std::fill_n(row + dims_.z, kRowMargin, kFar);
        kernel.run_along(along_, forward, dims_.z, row);
        std::fill_n(row + dims_.z, kRowMargin, kFar);
        store(i, j, row);
      }
    }
  }

 private:
  struct Step {
    glm::ivec3 offset;
    float length;
  };
  glm::ivec3 dims_;
  Planes planes_;
  std::vector<Step> steps_;  // to rows that a forward pass has seen
  std::vector<ChamferTerm> terms_;
  float along_ = 1;
};

class DenseChamfer {
 public:
  DenseChamfer(const DenseSeeds& seeds, const TransformOptions& options, std::span<float> distance)
      : samples_(seeds), options_(options), distance_(distance) {}

  void run(const Job& job) {
    const std::vector<MaskStep> steps = expand_steps(chamfer_steps(options_), samples_.spacing());
    ChamferPasses passes(steps, samples_.dims());
    if (options_.side != TransformSide::inside) run_side(passes, 0, job);
    if (options_.side != TransformSide::outside) run_side(passes, 1, job);
    parallel_for(rows(), 64, job, [&](std::size_t begin, std::size_t end) {
      std::vector<std::uint8_t> side(row_samples());
      for (std::size_t row = begin; row < end; ++row) finish_row(row, side.data());
    });
  }

 private:
  [[nodiscard]] std::size_t row_samples() const {
    return static_cast<std::size_t>(samples_.dims().z);
  }
  [[nodiscard]] std::size_t rows() const { return distance_.size() / row_samples(); }

  // Distances of the samples of one side, to the nearest sample of the other; those of the other
  // side are left alone.
  void run_side(ChamferPasses& passes, int side, const Job& job) {
    const ChamferKernel& kernel = chamfer_kernel();
    const int count = samples_.dims().z;
    std::vector<std::uint8_t> inside(row_samples());
    for (const bool forward : {true, false}) {
      const auto load = [&](int i, int j, float* row) {
        const std::size_t first = samples_.number({i, j, 0});
        samples_.inside_row(first, inside.data());
        const float* known = forward ? nullptr : distance_.data() + first;
        kernel.take_side(inside.data(), side, count, known, kFar, row);
      };
      const auto store = [&](int i, int j, const float* row) {
        float* to = distance_.data() + samples_.number({i, j, 0});
        kernel.put_side(inside.data(), side, count, row, to);
      };
      passes.run(forward, load, store, job);
    }
  }

  // Sides, window and world units.
  void finish_row(std::size_t row, std::uint8_t* is_inside) {
    const std::size_t count = row_samples();
    samples_.inside_row(row * count, is_inside);
    const auto unit = static_cast<float>(samples_.unit());
    const bool both = options_.side == TransformSide::both;
    const float half = both ? 0.5F : 0.0F;
    const float limit = options_.window > 0 ? static_cast<float>(options_.window) : kFar;
    const float cut = options_.window > 0 ? limit * unit : std::numeric_limits<float>::infinity();
    const float outside_sign = options_.side == TransformSide::inside ? 0.0F : 1.0F;
    const float inside_sign = both ? -1.0F : 1.0F - outside_sign;
    float* values = distance_.data() + row * count;
    for (std::size_t k = 0; k < count; ++k) {
      const float sign = is_inside[k] != 0 ? inside_sign : outside_sign;
      const float d = values[k] >= limit ? cut : (values[k] - half) * unit;
      values[k] = sign == 0 ? 0.0F : sign * d;
    }
  }

  SignedSamples samples_;
  TransformOptions options_;
  std::span<float> distance_;
};

}  // namespace

void chamfer_dense(const DenseSeeds& seeds, const TransformOptions& options,
                   std::span<float> distance, const Job& job) {
  DenseChamfer(seeds, options, distance).run(job);
}

}  // namespace sdfgrid
