#include "sdfgrid/transform/chamfer.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <fstream>
#include <glm/geometric.hpp>
#include <numeric>
#include <sstream>

#include "sdfgrid/core/error.h"
#include "sdfgrid/transform/chamfer_mask.h"

namespace sdfgrid {
namespace {

// The best real lengths for masks of 3^3 and 5^3: the largest relative error is least, found by
// minimizing chamfer_ratio()'s (tests/transform holds them to it).
constexpr double kThird = 1.0 / 3;
const std::vector<ChamferStep> kSteps345 = {
    {{1, 0, 0}, 3 * kThird}, {{1, 1, 0}, 4 * kThird}, {{1, 1, 1}, 5 * kThird}};
const std::vector<ChamferStep> kSteps3 = {
    {{1, 0, 0}, 0.93980}, {{1, 1, 0}, 1.32909}, {{1, 1, 1}, 1.62779}};
const std::vector<ChamferStep> kSteps5 = {{{1, 0, 0}, 0.9759}, {{1, 1, 0}, 1.4019},
                                          {{1, 1, 1}, 1.7244}, {{2, 1, 0}, 2.1822},
                                          {{2, 1, 1}, 2.3904}, {{2, 2, 1}, 3.0018}};

constexpr const char* kStepRule =
    "a chamfer step needs an offset with 3 >= x >= y >= z >= 0 and no common factor, and a "
    "length within half and twice its true one, in voxels (3, 4 and 5 are 1, 1.33 and 1.67)";
constexpr const char* kUnitRule = "a chamfer mask needs a step of (1, 0, 0)";

bool is_step(const ChamferStep& step) {
  const glm::ivec3& o = step.offset;
  const bool ordered = o.x >= o.y && o.y >= o.z && o.z >= 0 && o.x >= 1 && o.x <= 3;
  const double stretch = step.length / glm::length(glm::dvec3(o));
  return ordered && std::gcd(o.x, std::gcd(o.y, o.z)) == 1 && stretch >= 0.5 && stretch <= 2;
}

bool has_unit(std::span<const ChamferStep> steps) {
  return std::any_of(steps.begin(), steps.end(),
                     [](const ChamferStep& step) { return step.offset == glm::ivec3(1, 0, 0); });
}

void check_steps(std::span<const ChamferStep> steps) {
  if (!std::all_of(steps.begin(), steps.end(), is_step)) throw Error(ErrorKind::usage, kStepRule);
  if (!has_unit(steps)) throw Error(ErrorKind::usage, kUnitRule);
}

}  // namespace

std::vector<ChamferStep> chamfer_steps(const TransformOptions& options) {
  switch (options.method) {
    case TransformMethod::chamfer345:
      return kSteps345;
    case TransformMethod::chamfer3:
      return kSteps3;
    case TransformMethod::chamfer5:
      return kSteps5;
    default:
      check_steps(options.steps);
      return options.steps;
  }
}

std::vector<ChamferStep> read_chamfer_steps(const std::string& path) {
  std::ifstream in(path);
  if (!in) throw input_error(path, "", "it cannot be read", "check the path");
  std::vector<ChamferStep> steps;
  int number = 0;
  for (std::string line; std::getline(in, line);) {
    ++number;
    line.resize(std::min(line.find('#'), line.size()));
    if (line.find_first_not_of(" \t\r") == std::string::npos) continue;
    std::istringstream words(line);
    ChamferStep step{};
    std::string rest;
    words >> step.offset.x >> step.offset.y >> step.offset.z >> step.length;
    if (!words || words >> rest || !is_step(step)) {
      throw input_error(path, fmt::format("line {}", number), kStepRule,
                        "write `x y z length`, as in 1 1 0 1.41");
    }
    steps.push_back(step);
  }
  if (!has_unit(steps)) throw input_error(path, "", kUnitRule, "add a line 1 0 0 1");
  return steps;
}

std::vector<MaskStep> expand_steps(std::span<const ChamferStep> steps, const glm::dvec3& spacing) {
  std::vector<MaskStep> all;
  for (const ChamferStep& step : steps) {
    std::array<int, 3> digits = {step.offset.z, step.offset.y, step.offset.x};
    const double ratio = step.length / glm::length(glm::dvec3(step.offset));
    do {
      for (int signs = 0; signs < 8; ++signs) {
        glm::ivec3 offset(digits[0], digits[1], digits[2]);
        bool repeated = false;
        for (int a = 0; a < 3; ++a) {
          if ((signs >> a & 1) == 0) continue;
          repeated = repeated || offset[a] == 0;
          offset[a] = -offset[a];
        }
        if (repeated) continue;
        all.push_back({offset, ratio * glm::length(glm::dvec3(offset) * spacing)});
      }
    } while (std::next_permutation(digits.begin(), digits.end()));
  }
  return all;
}

// Far away a chamfer distance is a norm; its unit ball is the convex hull of the steps, each
// divided by its length. The largest ratio belongs to the face that is nearest to the centre, the
// smallest to the furthest corner.
ChamferRatio chamfer_ratio(std::span<const ChamferStep> steps, const glm::dvec3& spacing) {
  std::vector<glm::dvec3> corners;
  ChamferRatio ratio{1e300, 0};
  for (const MaskStep& step : expand_steps(steps, spacing)) {
    corners.push_back(glm::dvec3(step.offset) * spacing / step.length);
    ratio.smallest = std::min(ratio.smallest, 1 / glm::length(corners.back()));
  }
  // By symmetry the faces that touch the positive octant are enough.
  std::vector<glm::dvec3> octant;
  std::copy_if(corners.begin(), corners.end(), std::back_inserter(octant),
               [](const glm::dvec3& c) { return c.x >= 0 && c.y >= 0 && c.z >= 0; });
  for (std::size_t i = 0; i < octant.size(); ++i) {
    for (std::size_t j = 0; j < i; ++j) {
      for (std::size_t k = 0; k < j; ++k) {
        const glm::dvec3 n = glm::cross(octant[j] - octant[i], octant[k] - octant[i]);
        const double height = glm::dot(n, octant[i]);
        if (std::abs(height) < 1e-12) continue;
        const glm::dvec3 plane = n / height;  // plane . x = 1 on the three corners
        const bool face = std::all_of(corners.begin(), corners.end(), [&](const glm::dvec3& c) {
          return glm::dot(plane, c) <= 1 + 1e-9;
        });
        if (face) ratio.largest = std::max(ratio.largest, glm::length(plane));
      }
    }
  }
  return ratio;
}

}  // namespace sdfgrid
