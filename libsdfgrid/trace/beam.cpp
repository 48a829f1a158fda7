#include "sdfgrid/trace/beam.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace sdfgrid {
namespace {

constexpr int kBrick = Atlas::kBrick;
constexpr double kInfinity = std::numeric_limits<double>::infinity();
// Added to the beam's radius for the rounding of positions.
constexpr double kSlack = 1e-6;

// A border of the beam's box, which moves as at + speed * t with t >= 0.
struct Border {
  double at;
  double speed;

  [[nodiscard]] double place(double t) const { return at + speed * t; }
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
    if (place(t) > limit) return t;
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

// The cubes of bricks that Atlas::jumps has for the beam's octant.
class EmptyCubes {
 public:
  EmptyCubes(const Atlas& atlas, const Beam& beam) : atlas_(atlas), beam_(beam) {
    for (int a = 0; a < 3; ++a) {
      back_[a] = beam.axis[a] < 0;
      octant_ = 2 * octant_ + (back_[a] ? 1 : 0);
    }
  }

  // How far the beam, at t, stays in the cube that starts at its hindmost slot; t if it does not
  // fit. Beyond the tables all is empty, so at their ends a cube goes on for ever.
  [[nodiscard]] double leave(double t) const {
    glm::ivec3 slot;
    for (int a = 0; a < 3; ++a) {
      const double rear = back_[a] ? upper(beam_, a).place(t) : -lower(beam_, a).place(t);
      slot[a] = static_cast<int>(std::clamp(std::floor(rear / kBrick), 0.0, atlas_.dims[a] - 1.0));
    }
    const int jump = atlas_.jump(octant_, atlas_.place(slot));
    if (jump == 0) return t;
    double exit = kInfinity;
    for (int a = 0; a < 3; ++a) {
      const int first = back_[a] ? slot[a] - jump + 1 : slot[a];
      const int end = back_[a] ? slot[a] + 1 : slot[a] + jump;
      if (end < atlas_.dims[a]) exit = std::min(exit, upper(beam_, a).stays_below(kBrick * end, t));
      if (first > 0) exit = std::min(exit, lower(beam_, a).stays_below(-kBrick * first, t));
    }
    return exit;
  }

 private:
  const Atlas& atlas_;
  const Beam& beam_;
  bool back_[3]{};
  int octant_ = 0;
};

}  // namespace

double march(const Atlas& atlas, const Beam& beam, double from) {
  double to = kInfinity;
  clip(beam, glm::dvec3(atlas.dims * kBrick), from, to);
  const EmptyCubes cubes(atlas, beam);
  double t = from;
  while (t < to) {
    const double exit = cubes.leave(t);
    if (!(exit > t)) return t;
    t = exit;
  }
  return kInfinity;
}

}  // namespace sdfgrid
