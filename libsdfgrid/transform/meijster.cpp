#include "sdfgrid/transform/meijster.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstring>
#include <limits>
#include <memory>
#include <type_traits>
#include <vector>

#include "sdfgrid/core/parallel.h"
#include "sdfgrid/transform/parabola_kernel.h"

namespace sdfgrid {
namespace {

constexpr double kDirectReach = 24;  // rows; up to here a window is searched without a range

// squares[d + rows + 2] = weight * d^2 for |d| <= rows + 2.
template <class Number>
std::vector<Number> square_table(int rows, Number weight) {
  std::vector<Number> table(2 * static_cast<std::size_t>(rows) + 5);
  for (int d = -rows - 2; d <= rows + 2; ++d) {
    table[static_cast<std::size_t>(d + rows + 2)] =
        static_cast<Number>(d) * static_cast<Number>(d) * weight;
  }
  return table;
}

// What one thread needs for columns of `rows`.
template <class Number>
class Scratch {
 public:
  explicit Scratch(int rows)
      : numbers_((kColumns + 48) * static_cast<std::size_t>(rows) + 64 / sizeof(Number)),
        range_(2 * static_cast<std::size_t>(rows)) {}

  ParabolaScratch get() {
    void* p = numbers_.data();
    std::size_t room = numbers_.size() * sizeof(Number);
    std::align(64, 64, p, room);
    return {p, range_.data()};
  }

 private:
  std::vector<Number> numbers_;
  std::vector<std::int32_t> range_;
};

template <class Number>
class Meijster {
 public:
  Meijster(const MeijsterOptions& options, std::span<float> distance)
      : options_(options), dims_(options.dims), distance_(distance.data()) {
    const double unit = std::min({options.spacing.x, options.spacing.y, options.spacing.z});
    for (int a = 0; a < 3; ++a) {
      const double ratio = options.spacing[a] / unit;
      squares_[a] = square_table<Number>(dims_[a], static_cast<Number>(ratio * ratio));
    }
    finish_.wanted = true;
    finish_.inside_sign = options.side == TransformSide::both ? -1.0F : 1.0F;
    finish_.scale = static_cast<float>(unit);
    finish_.shift = static_cast<float>(options.shift);
    finish_.cut = static_cast<float>(options.window > 0 ? options.window * unit
                                                        : std::numeric_limits<double>::infinity());
    set_window(unit);
  }

  void run(const InsideRow& inside, const Job& job) {
    const auto slabs = static_cast<std::size_t>(dims_.x);
    parallel_for(slabs, 1, job, [&](std::size_t begin, std::size_t end) {
      for (std::size_t i = begin; i < end; ++i) slab(inside, static_cast<int>(i));
    });
    parallel_for(static_cast<std::size_t>(dims_.y), 1, job,
                 [&](std::size_t begin, std::size_t end) {
                   for (std::size_t j = begin; j < end; ++j) across_slabs(static_cast<int>(j));
                 });
  }

 private:
  void set_window(double unit) {
    const double window = options_.window;
    far_ = std::is_integral_v<Number> ? static_cast<Number>(1 << 30) : static_cast<Number>(1e30F);
    finish_.limit = far_;
    if (window <= 0) return;
    // The first square beyond the window: for integers the next one.
    const auto beyond = static_cast<Number>(
        std::is_integral_v<Number> ? std::floor(window * window) + 1
                                   : std::nextafter(static_cast<float>(window * window), 1e30F));
    finish_.limit = std::min(beyond, far_);
    windowed_ = window < kDirectReach;
    if (windowed_) far_ = finish_.limit;
    for (int a = 0; a < 3; ++a) {
      reach_[a] = static_cast<int>(std::min(window * unit / options_.spacing[a], 1e9));
    }
  }

  [[nodiscard]] ParabolaPass<Number> pass(int axis, std::ptrdiff_t stride) const {
    ParabolaPass<Number> p{};
    p.rows = dims_[axis];
    p.stride = stride;
    p.sides = options_.side == TransformSide::both      ? Sides::both
              : options_.side == TransformSide::outside ? Sides::outside
                                                        : Sides::inside;
    p.square = squares_[axis].data() + p.rows + 2;
    p.far = far_;
    p.windowed = windowed_;
    p.reach = windowed_ ? std::min(reach_[axis], p.rows) : p.rows;
    return p;
  }

  // Along z and y, in one plane that fits the cache.
  void slab(const InsideRow& inside, int i) {
    const auto& kernel = parabola_kernel<Number>();
    const ParabolaPass<Number> along_z = pass(2, 1);
    std::vector<std::uint8_t> bytes(static_cast<std::size_t>(dims_.z));
    // A row is written with up to 15 numbers more: into the next row, but for the last one.
    std::vector<Number> last(static_cast<std::size_t>(dims_.z) + 16);
    for (int j = 0; j < dims_.y; ++j) {
      inside(i, j, bytes.data());
      const bool fits = (dims_.y - 1 - j) * static_cast<std::ptrdiff_t>(dims_.z) >= 16;
      kernel.row(along_z, bytes.data(), fits ? static_cast<Number*>(at(i, j, 0)) : last.data());
      if (!fits) {
        std::memcpy(at(i, j, 0), last.data(), sizeof(Number) * static_cast<std::size_t>(dims_.z));
      }
    }
    Scratch<Number> scratch(dims_.y);
    const ParabolaPass<Number> along_y = pass(1, dims_.z);
    for (int k = 0; k < dims_.z; k += kColumns) {
      kernel.columns(along_y, std::min(kColumns, dims_.z - k), at(i, 0, k), scratch.get());
    }
  }

  void across_slabs(int j) {
    Scratch<Number> scratch(dims_.x);
    ParabolaPass<Number> along_x = pass(0, static_cast<std::ptrdiff_t>(dims_.y) * dims_.z);
    along_x.finish = finish_;
    for (int k = 0; k < dims_.z; k += kColumns) {
      parabola_kernel<Number>().columns(along_x, std::min(kColumns, dims_.z - k), at(0, j, k),
                                        scratch.get());
    }
  }

  // The squares live where the distances will be.
  void* at(int i, int j, int k) {
    return distance_ + (static_cast<std::ptrdiff_t>(i) * dims_.y + j) * dims_.z + k;
  }

  MeijsterOptions options_;
  glm::ivec3 dims_;
  float* distance_;
  std::array<std::vector<Number>, 3> squares_;
  Number far_{};
  bool windowed_ = false;
  std::array<int, 3> reach_{};
  ParabolaFinish<Number> finish_{};
};

}  // namespace

void meijster(const InsideRow& inside, const MeijsterOptions& options, std::span<float> distance,
              const Job& job) {
  const glm::dvec3& s = options.spacing;
  const glm::dvec3 d(options.dims);
  const double diagonal = d.x * d.x + d.y * d.y + d.z * d.z;
  if (s.x == s.y && s.y == s.z && diagonal < (1 << 30)) {
    Meijster<std::int32_t>(options, distance).run(inside, job);
  } else {
    Meijster<float>(options, distance).run(inside, job);
  }
}

}  // namespace sdfgrid
