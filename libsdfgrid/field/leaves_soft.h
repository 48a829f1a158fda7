// field/leaves_soft.h: soft objects: the sum of blobs around points (internal to field/).
#pragma once

#include <vector>

#include "sdfgrid/core/lattice.h"
#include "sdfgrid/field/ops.h"
#include "sdfgrid/field/parameters.h"

namespace sdfgrid {
class Field;
struct Argument;
}  // namespace sdfgrid

namespace sdfgrid::ops {

// How a blob falls off, from 1 at its centre (r = 0) to 0 at its radius (r = 1).
enum class Falloff { wyvill, linear, squared, cubed, gaussian, quadratic };

struct Metaballs {
  static constexpr OpInfo info = {
      "metaballs",
      OpRole::leaf,
      OpGuarantee::bound,
      "Where the sum of blobs around points is above a threshold. `falloff`: wyvill (cubic in the "
      "squared distance), linear, squared and cubed (heat), gaussian, quadratic (Diener's).",
      "metaballs: {points: [[-0.5, 0, 0], [0.5, 0.1, 0], [0, 0.6, 0.3]], radii: [1, 0.9, 0.8], "
      "threshold: 0.4}",
      "G. Wyvill, C. McPheeters, B. Wyvill 1986; divided by sum of slope / radius over the blobs "
      "that meet (Hart's (38) is too large)"};
  static constexpr Parameter parameters[] = {
      {"points",
       ParameterKind::points,
       "length",
       {0, 0, 0},
       -kAny,
       kAny,
       "centres; none: `count` random ones in a ball of radius `size`"},
      {"radii",
       ParameterKind::numbers,
       "length",
       {0, 0, 0},
       kSmall,
       kAny,
       "of the blobs, one or one each; 1 unless said"},
      number("threshold", 0.3, 0.001, 1000, "of the sum at the surface"),
      {"falloff", ParameterKind::text, "", {0, 0, 0}, 0, 0, "wyvill unless said"},
      whole("count", 12, 1, 2000, "of random points"),
      whole("seed", 1, 0, 1e6, "of random points"),
      size("size", 1, "radius of the ball of random points")};
  static constexpr bool kList = true;  // x, y, z, 1 / radius of each
  static Field make(const std::vector<Argument>& arguments);
  float threshold, falloff, scale;

  template <class T>
  T blob(const T& r) const {
    const T q = min(square(r), T(1.0F));
    switch (static_cast<Falloff>(static_cast<int>(falloff))) {
      case Falloff::wyvill:
        return T(1.0F) + q * (q * (q * (-4.0F / 9) + 17.0F / 9) - 22.0F / 9);
      case Falloff::linear:
        return T(1.0F) - min(r, T(1.0F));
      case Falloff::squared:
        return square(T(1.0F) - q);
      case Falloff::cubed:
        return square(T(1.0F) - q) * (T(1.0F) - q);
      case Falloff::gaussian:
        return (exp(q * -4.0F) - 0.0183156389F) * 1.01865736F;
      case Falloff::quadratic:
        break;
    }
    // 1 - 2 r^2 up to 1/2, 2 (1 - r)^2 beyond.
    const T s = min(r, T(1.0F));
    return select(s < T(0.5F), T(1.0F) - square(s) * 2.0F, square(T(1.0F) - s) * 2.0F);
  }
  // Beyond all blobs the distance to the nearest is the better bound.
  template <class T>
  T distance(const Point<T>& p, Data blobs) const {
    T sum(0.0F);
    T beyond(1e30F);
    for (int i = 0; i < blobs.count; i += 4) {
      const T r = length(minus(p, blobs.values + i));
      const float inverse = blobs.values[i + 3];
      sum = sum + blob(r * inverse);
      beyond = min(beyond, r - 1 / inverse);
    }
    return max((T(threshold) - sum) * scale, beyond);
  }
  Box bounds(Data blobs, double level) const;
};

using SoftLeaves = OpList<Metaballs>;

}  // namespace sdfgrid::ops
