#include "sdfgrid/trace/beam.h"

#include <algorithm>
#include <glm/common.hpp>
#include <limits>

namespace sdfgrid {
namespace {

constexpr double kInfinity = std::numeric_limits<double>::infinity();
// Added to the beam's radius for the rounding of positions.
constexpr double kSlack = 1e-6;

// A border of the beam's box, which moves as at + speed * t with t >= 0.
struct Border {
  double at;
  double speed;

  // From and until when it is above `limit`.
  [[nodiscard]] double first_above(double limit) const {
    if (at > limit) return 0;
    return speed > 0 ? (limit - at) / speed : kInfinity;
  }
  [[nodiscard]] double last_above(double limit) const {
    if (speed < 0) return (limit - at) / speed;
    return speed > 0 || at > limit ? kInfinity : 0;
  }
  // How long it stays at `limit` or below, from t on; t if it is above there.
  [[nodiscard]] double stays_below(double limit, double t) const {
    if (at + speed * t > limit) return t;
    return speed > 0 ? (limit - at) / speed : kInfinity;
  }
};

Border upper(const Beam& beam, int a) {
  return {beam.origin[a] + kSlack, beam.axis[a] + beam.spread};
}
// The lower border mirrored about 0.
Border lower(const Beam& beam, int a) {
  return {kSlack - beam.origin[a], beam.spread - beam.axis[a]};
}

// Clips [from, to] to where the beam's box touches that of the tables.
void clip(const Beam& beam, const glm::dvec3& size, double& from, double& to) {
  for (int a = 0; a < 3; ++a) {
    from = std::max({from, upper(beam, a).first_above(0), lower(beam, a).first_above(-size[a])});
    to = std::min({to, upper(beam, a).last_above(0), lower(beam, a).last_above(-size[a])});
  }
}

// How far the beam, at t, stays in the box; t if it is not in it.
double leave(const Beam& beam, double t, const glm::dvec3& lo, const glm::dvec3& hi) {
  double exit = kInfinity;
  for (int a = 0; a < 3; ++a) {
    exit = std::min(
        {exit, upper(beam, a).stays_below(hi[a], t), lower(beam, a).stays_below(-lo[a], t)});
  }
  return exit;
}

}  // namespace

double march(const Atlas& atlas, const Beam& beam, double from) {
  double to = kInfinity;
  clip(beam, glm::dvec3(atlas.dims * Atlas::kBrick), from, to);
  double t = from;
  while (t < to) {
    const glm::dvec3 place = (beam.origin + t * beam.axis) / double(Atlas::kBrick);
    const glm::dvec3 last(atlas.dims - 1);
    const glm::ivec3 slot(glm::clamp(glm::floor(place), glm::dvec3(0.0), last));
    const std::int32_t jump = atlas.jumps[atlas.place(slot)];
    if (jump >= 0) return t;
    // The empty cube, which goes on for ever where it reaches the end of the tables.
    glm::dvec3 lo;
    glm::dvec3 hi;
    for (int a = 0; a < 3; ++a) {
      const int first = slot[a] + jump + 1;
      const int end = slot[a] - jump;
      lo[a] = first <= 0 ? -kInfinity : first * double(Atlas::kBrick);
      hi[a] = end >= atlas.dims[a] ? kInfinity : end * double(Atlas::kBrick);
    }
    const double exit = leave(beam, t, lo, hi);
    if (!(exit > t)) return t;
    t = exit;
  }
  return kInfinity;
}

}  // namespace sdfgrid
