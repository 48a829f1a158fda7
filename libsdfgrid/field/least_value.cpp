#include "sdfgrid/field/least_value.h"

#include <algorithm>
#include <cmath>
#include <optional>
#include <queue>
#include <utility>
#include <vector>

#include "sdfgrid/field/interval.h"

namespace sdfgrid {
namespace {

// Halves of a box, across its longest side; where a side has no end, farther out the farther it
// begins beyond `content`. Nothing if it is a point.
std::optional<std::pair<Box, Box>> halves(const Box& box, const Box& content) {
  const glm::dvec3 size = box.size();
  const int axis = size.x >= size.y && size.x >= size.z ? 0 : (size.y >= size.z ? 1 : 2);
  const double lo = box.lo[axis];
  const double hi = box.hi[axis];
  if (!(hi > lo)) return {};
  const double lowest = std::isfinite(content.lo[axis]) ? content.lo[axis] : 0;
  const double highest = std::isfinite(content.hi[axis]) ? content.hi[axis] : 0;
  double at = 0.5 * (lo + hi);
  if (!std::isfinite(lo) && !std::isfinite(hi)) {
    at = 0.5 * (lowest + highest);
  } else if (!std::isfinite(hi)) {
    at = lo < highest ? highest : lo + (lo - highest) + (highest - lowest) + 1;
  } else if (!std::isfinite(lo)) {
    at = hi > lowest ? lowest : hi - (lowest - hi) - (highest - lowest) - 1;
  }
  std::pair<Box, Box> made{box, box};
  made.first.hi[axis] = made.second.lo[axis] = at;
  return made;
}

}  // namespace

LeastValue least_value(const Field& field, const Box& box, const Box& content, double known,
                       const std::function<bool(const LeastValue&)>& enough, const Job& job) {
  constexpr std::size_t kMostParts = 4000;
  constexpr std::size_t kMostInstructions = 1000000;
  using Part = std::pair<double, Box>;
  const auto later = [](const Part& a, const Part& b) { return a.first > b.first; };
  std::priority_queue<Part, std::vector<Part>, decltype(later)> parts(later);
  double met = ops::kInfinity;
  const auto add = [&](const Box& part, double least) {
    parts.push({std::fmax(least, field.range(part).lo), part});
    const glm::dvec3 middle = part.center();
    const bool finite =
        std::isfinite(middle.x) && std::isfinite(middle.y) && std::isfinite(middle.z);
    if (finite) met = std::fmin(met, field.range({middle, middle}).hi);
  };
  add(box, known);
  const std::size_t most = std::min(kMostParts, kMostInstructions / field.size());
  for (std::size_t i = 0; i < most && !enough({parts.top().first, met}); ++i) {
    job.checkpoint();
    const auto [least, part] = parts.top();
    const auto both = halves(part, content);
    if (!both) break;
    parts.pop();
    add(both->first, least);
    add(both->second, least);
  }
  return {parts.top().first, met};
}

}  // namespace sdfgrid
