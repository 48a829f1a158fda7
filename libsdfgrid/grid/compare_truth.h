// grid/compare_truth.h: what claims about distances are judged by. Internal to grid/compare.h and
// grid/survey.h; includes OpenVDB.
#pragma once

#include <cmath>
#include <cstddef>
#include <glm/geometric.hpp>
#include <numbers>
#include <optional>

#include "sdfgrid/grid/compare_claims.h"
#include "sdfgrid/grid/compare_summary.h"
#include "sdfgrid/mesh/reference.h"

namespace sdfgrid {

inline constexpr double kVoxelDoubt = 1e-4;  // voxels; see compare.h
inline constexpr double kInterpolatedDoubt = std::numbers::sqrt3 / 2;
inline constexpr double kWindingDoubt = 0.01;

// The truth from a mesh. One for each run of neighbouring samples: each answer makes the next
// quicker.
class MeshTruth {
 public:
  MeshTruth(const ReferenceDistance& mesh, bool signs) : mesh_(mesh), signs_(signs) {}

  // The signed distance at a place, without sign where it is at most `doubt` (world units).
  Claim at(const glm::dvec3& world, double doubt) {
    known_ = known_ ? mesh_.closest(world, *known_) : mesh_.closest(world);
    Claim truth{world, glm::length(*known_ - world), false, false};
    if (!signs_ || truth.value <= doubt) return truth;
    const double winding = mesh_.winding_number(world);
    truth.has_sign = mesh_.closed() || std::abs(winding - 0.5) > kWindingDoubt;
    undecided_ += truth.has_sign ? 0 : 1;
    if (winding > 0.5) truth.value = -truth.value;
    return truth;
  }
  // The surface's point nearest to the place asked about last.
  [[nodiscard]] const glm::dvec3& nearest() const { return *known_; }
  [[nodiscard]] std::size_t undecided() const { return undecided_; }

 private:
  const ReferenceDistance& mesh_;
  bool signs_;
  std::optional<glm::dvec3> known_;
  std::size_t undecided_ = 0;
};

// What a claim is off by. Where one side says "at least so far", more on the other side is no
// error.
inline SampleError judge(const Claim& claim, const Claim& truth) {
  const double claimed = std::abs(claim.value);
  const double actual = std::abs(truth.value);
  SampleError result{true, false, 0, claim.world};
  if (truth.has_sign && claim.has_sign && claim.value != 0 &&
      (claim.value < 0) != (truth.value < 0)) {
    result.sign_error = true;
    result.error = claimed + actual;
  } else if (!(claimed <= actual)) {  // also if it is not a number
    result.error = truth.at_least ? 0 : claimed - actual;
  } else {
    result.error = claim.at_least ? 0 : actual - claimed;
  }
  return result;
}

}  // namespace sdfgrid
