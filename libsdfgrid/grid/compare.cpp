#include "sdfgrid/grid/compare.h"

#include <fmt/format.h>

#include <algorithm>
#include <atomic>
#include <cmath>
#include <glm/geometric.hpp>
#include <optional>
#include <string_view>

#include "sdfgrid/core/error.h"
#include "sdfgrid/core/parallel.h"
#include "sdfgrid/grid/compare_claims.h"
#include "sdfgrid/grid/compare_summary.h"
#include "sdfgrid/grid/compare_truth.h"
#include "sdfgrid/mesh/diagnose.h"
#include "sdfgrid/mesh/orient.h"
#include "sdfgrid/mesh/reference.h"

namespace sdfgrid {
namespace {

// The truth from another grid.
class GridTruth {
 public:
  GridTruth(const GridClaims& grid, bool signs) : grid_(grid), signs_(signs) {}

  Claim at(const glm::dvec3& world, double doubt) const {
    Claim truth = grid_.at(world);
    truth.has_sign = signs_ && std::abs(truth.value) > doubt;
    return truth;
  }
  [[nodiscard]] static std::size_t undecided() { return 0; }

 private:
  const GridClaims& grid_;
  bool signs_;
};

struct Kind {
  std::string_view name;  // for progress
  std::size_t count;
  double doubt;  // world units
};

// Judges samples 0 to kind.count of `draw(i)` (an optional claim) against what `make_truth()`
// makes.
template <class Draw, class MakeTruth>
std::vector<SampleError> measure(const Kind& kind, const Draw& draw, const MakeTruth& make_truth,
                                 std::atomic<std::size_t>& undecided, const Job& job) {
  constexpr std::size_t kRun = 512;
  std::vector<SampleError> errors(kind.count);
  parallel_for(kind.name, kind.count, kRun, job, [&](std::size_t begin, std::size_t end) {
    auto truth = make_truth();
    for (std::size_t i = begin; i < end; ++i) {
      const std::optional<Claim> claim = draw(i);
      if (claim) errors[i] = judge(*claim, truth.at(claim->world, kind.doubt));
    }
    undecided += truth.undecided();
  });
  return errors;
}

// All errors of one grid against a truth, by kind.
struct Errors {
  std::vector<SampleError> voxels, interpolated, inactive;
  std::size_t wrong_constants = 0;
  std::size_t undecided = 0;

  void append(const Errors& other) {
    voxels.insert(voxels.end(), other.voxels.begin(), other.voxels.end());
    interpolated.insert(interpolated.end(), other.interpolated.begin(), other.interpolated.end());
    inactive.insert(inactive.end(), other.inactive.begin(), other.inactive.end());
    wrong_constants += other.wrong_constants;
    undecided += other.undecided;
  }
};

template <class MakeTruth>
Errors measure_all(const GridClaims& grid, const MakeTruth& make_truth,
                   const CompareOptions& options, const Job& job) {
  const std::size_t samples = std::max<std::size_t>(options.samples, 1);
  const double near = kVoxelDoubt * grid.voxel();
  const Kind voxels{"compare voxels", std::min(samples, grid.active_voxels()), near};
  const Kind cells{"compare cells", samples, kInterpolatedDoubt * grid.voxel()};
  const Kind inactive{"compare beyond the band", samples / 4 + 1, near};
  std::atomic<std::size_t> undecided{0};
  std::atomic<std::size_t> wrong_constants{0};
  Errors errors;
  errors.voxels = measure(
      voxels,
      [&](std::size_t i) { return std::optional(grid.at_voxel(i, voxels.count, options.seed)); },
      make_truth, undecided, job);
  errors.interpolated = measure(
      cells, [&](std::size_t i) { return grid.in_cell(i, cells.count, options.seed + 1); },
      make_truth, undecided, job);
  errors.inactive = measure(
      inactive,
      [&](std::size_t i) {
        const auto claim = grid.beyond_band(i, inactive.count, options.seed + 2);
        if (claim && !grid.is_background(claim->value)) ++wrong_constants;
        return claim;
      },
      make_truth, undecided, job);
  errors.undecided = undecided;
  errors.wrong_constants = wrong_constants;
  return errors;
}

void fill(Comparison& comparison, const Errors& errors) {
  comparison.voxels = summarize(errors.voxels);
  comparison.interpolated = summarize(errors.interpolated);
  comparison.inactive = summarize(errors.inactive);
  comparison.wrong_constants = errors.wrong_constants;
  comparison.undecided_signs = errors.undecided;
}

void warn_of_tiles(Comparison& comparison, const GridClaims& grid) {
  if (grid.active_tiles() == 0) return;
  comparison.warnings.push_back(fmt::format(
      "{} active tiles hold one value for many voxels and were not measured", grid.active_tiles()));
}

}  // namespace

Comparison compare(const Grid& grid, const TriangleSoup& mesh, const CompareOptions& options,
                   const Job& job) {
  const GridClaims claims(grid);
  Comparison comparison;
  comparison.voxel = claims.voxel();
  comparison.signs = claims.is_signed();
  TriangleSoup turned = mesh;
  if (comparison.signs) comparison.warnings = orient_mesh(turned).warnings;
  job.checkpoint();
  warn_of_tiles(comparison, claims);
  const ReferenceDistance reference(turned);
  fill(comparison,
       measure_all(
           claims, [&] { return MeshTruth(reference, comparison.signs); }, options, job));
  return comparison;
}

Comparison compare(const Grid& a, const Grid& b, const CompareOptions& options, const Job& job) {
  const GridClaims first(a);
  const GridClaims second(b);
  Comparison comparison;
  comparison.voxel = first.voxel();
  comparison.signs = first.is_signed() && second.is_signed();
  warn_of_tiles(comparison, first);
  warn_of_tiles(comparison, second);
  const auto truth = [&](const GridClaims& grid) {
    return [&grid, signs = comparison.signs] { return GridTruth(grid, signs); };
  };
  Errors errors = measure_all(first, truth(second), options, job);
  errors.append(measure_all(second, truth(first), options, job));
  fill(comparison, errors);
  return comparison;
}

}  // namespace sdfgrid
