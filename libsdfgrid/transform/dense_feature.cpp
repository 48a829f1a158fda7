#include "sdfgrid/transform/dense_feature.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <vector>

#include "sdfgrid/core/parallel.h"

namespace sdfgrid {
namespace {

constexpr int kLanes = 16;  // neighbouring columns that are copied out together: a line of cache

// The sites of one column, and which of them is nearest to each of its rows.
class Column {
 public:
  explicit Column(int rows) : parabolas_(static_cast<std::size_t>(rows)) {}

  void clear() { count_ = 0; }
  // A parabola over row `x`, not before the last one: `square` is how far its site is from the
  // column there.
  void add(double x, double square, double weight, std::uint32_t site) {
    const double raised = square + weight * x * x;
    double from = -1e300;
    while (count_ > 0) {
      const Parabola& last = parabolas_[count_ - 1];
      if (x > last.x) {
        from = (raised - last.raised) / (2 * weight * (x - last.x));
        if (from > last.from) break;
      } else if (raised >= last.raised) {
        return;
      }
      --count_;
      from = -1e300;
    }
    parabolas_[count_++] = {x, raised, from, site};
  }
  [[nodiscard]] bool empty() const { return count_ == 0; }
  // Calls put(row, site) for every row.
  template <class Put>
  void for_each(int rows, const Put& put) const {
    std::size_t at = 0;
    for (int row = 0; row < rows; ++row) {
      while (at + 1 < count_ && parabolas_[at + 1].from <= row) ++at;
      put(row, parabolas_[at].site);
    }
  }

 private:
  struct Parabola {
    double x;
    double raised;  // its value over the origin of rows
    double from;    // the row from which on it is the lowest
    std::uint32_t site;
  };
  std::vector<Parabola> parabolas_;
  std::size_t count_ = 0;
};

class DenseFeature {
 public:
  DenseFeature(const glm::ivec3& dims, const glm::dvec3& spacing, std::span<const Site> sites,
               std::span<std::uint32_t> nearest)
      : dims_(dims), weight_(spacing * spacing), sites_(sites), nearest_(nearest) {}

  void run(const Job& job) {
    std::fill(nearest_.begin(), nearest_.end(), kNoFeature);
    for (std::size_t i = 0; i < sites_.size(); ++i) {
      nearest_[number(sites_[i].at)] = static_cast<std::uint32_t>(i);
    }
    const auto nx = static_cast<std::size_t>(dims_.x);
    const auto ny = static_cast<std::size_t>(dims_.y);
    parallel_for(nx, 1, job, [&](std::size_t begin, std::size_t end) {
      for (std::size_t i = begin; i < end; ++i) {
        for (int j = 0; j < dims_.y; ++j) along_row({i, j, 0});
        columns<1>({i, 0, 0});
      }
    });
    parallel_for(ny, 1, job, [&](std::size_t begin, std::size_t end) {
      for (std::size_t j = begin; j < end; ++j) columns<0>({0, j, 0});
    });
  }

 private:
  [[nodiscard]] std::size_t number(const glm::ivec3& at) const {
    return (static_cast<std::size_t>(at.x) * static_cast<std::size_t>(dims_.y) +
            static_cast<std::size_t>(at.y)) *
               static_cast<std::size_t>(dims_.z) +
           static_cast<std::size_t>(at.z);
  }

  // Along z the nearest site is the last one before or the next one after a sample.
  void along_row(const glm::ivec3& at) {
    std::uint32_t* row = nearest_.data() + number(at);
    int before = -1;  // where the last site was
    for (int k = 0; k < dims_.z; ++k) {
      if (row[k] == kNoFeature) continue;
      const int middle = before < 0 ? 0 : border(row[before], row[k], before, k);
      std::fill(row + middle, row + k, row[k]);
      if (before >= 0) std::fill(row + before, row + middle, row[before]);
      before = k;
    }
    if (before >= 0) std::fill(row + before, row + dims_.z, row[before]);
  }

  // In a block of columns.
  static std::size_t place(int row, int lane) {
    return static_cast<std::size_t>(row) * kLanes + static_cast<std::size_t>(lane);
  }

  // The first sample that is nearer to site b, at sample `kb`, than to site a before it.
  [[nodiscard]] int border(std::uint32_t a, std::uint32_t b, int ka, int kb) const {
    const double middle =
        0.5 * (static_cast<double>(sites_[a].point.z) + static_cast<double>(sites_[b].point.z));
    return std::clamp(static_cast<int>(std::floor(middle)) + 1, ka + 1, kb);
  }

  // The columns along an axis from the samples (at.x, at.y, k) on, for all k. Along y sites differ
  // from their column in z only; along x in y and z.
  template <int kAxis>
  void columns(const glm::ivec3& at) {
    const int rows = dims_[kAxis];
    const std::size_t stride =
        kAxis == 0 ? static_cast<std::size_t>(dims_.y) * static_cast<std::size_t>(dims_.z)
                   : static_cast<std::size_t>(dims_.z);
    std::vector<std::uint32_t> block(static_cast<std::size_t>(rows) * kLanes);
    Column column(rows);
    for (int k = 0; k < dims_.z; k += kLanes) {
      const int lanes = std::min(kLanes, dims_.z - k);
      std::uint32_t* first = nearest_.data() + number({at.x, at.y, k});
      for (int row = 0; row < rows; ++row) {
        std::copy_n(first + static_cast<std::size_t>(row) * stride, lanes,
                    block.data() + place(row, 0));
      }
      for (int lane = 0; lane < lanes; ++lane) {
        column.clear();
        for (int row = 0; row < rows; ++row) {
          const std::uint32_t site = block[place(row, lane)];
          if (site == kNoFeature) continue;
          const glm::dvec3 point(sites_[site].point);
          const glm::dvec3 away = point - glm::dvec3(at.x, at.y, k + lane);
          double square = weight_.z * away.z * away.z;
          if (kAxis == 0) square += weight_.y * away.y * away.y;
          column.add(point[kAxis], square, weight_[kAxis], site);
        }
        if (column.empty()) continue;
        column.for_each(rows, [&](int row, std::uint32_t site) { block[place(row, lane)] = site; });
      }
      for (int row = 0; row < rows; ++row) {
        std::copy_n(block.data() + place(row, 0), lanes,
                    first + static_cast<std::size_t>(row) * stride);
      }
    }
  }

  glm::ivec3 dims_;
  glm::dvec3 weight_;
  std::span<const Site> sites_;
  std::span<std::uint32_t> nearest_;
};

}  // namespace

void find_nearest_sites(const glm::ivec3& dims, const glm::dvec3& spacing,
                        std::span<const Site> sites, std::span<std::uint32_t> nearest,
                        const Job& job) {
  DenseFeature(dims, spacing, sites, nearest).run(job);
}

}  // namespace sdfgrid
