// field/displace.h: surfaces moved by noise or a formula, and terrain (internal to field/).
#pragma once

#include <vector>

#include "sdfgrid/core/lattice.h"
#include "sdfgrid/field/formula_code.h"
#include "sdfgrid/field/noise.h"
#include "sdfgrid/field/ops.h"
#include "sdfgrid/field/parameters.h"
#include "sdfgrid/field/texture.h"

namespace sdfgrid {
class Field;
struct Argument;
}  // namespace sdfgrid

namespace sdfgrid::ops {

struct NoiseDisplacement {
  static constexpr OpInfo info = {
      "noise_displace",
      OpRole::range,
      OpGuarantee::bound,
      "Moves the surface of a node in and out by noise of several octaves.",
      "noise_displace: {frequency: 2, amplitude: 0.08, octaves: 3, beta: 2, seed: 1, of: {sphere: "
      "{radius: 1}}}",
      "K. Perlin 2002; divided by 1 + 3.75 sum of amplitude times frequency"};
  static constexpr bool kTakesAway = true;
  static constexpr Parameter parameters[] = {
      number("frequency", 1, 1e-6, 1e6, "of the first octave", "1/length"),
      number("amplitude", 0.1, 0, 1e6, "of the first octave", "length"),
      whole("octaves", 1, 1, 12, "each of twice the frequency"),
      number("beta", 2, 0, 10,
             "power spectrum 1 / f^beta: an octave has 2^(-beta/2) of the last's amplitude"),
      whole("seed", 0, 0, 500, "another noise")};
  Octaves noise;
  float scale;

  void prepare(Data) { scale = static_cast<float>(1 / (1 + noise.slope() * 1.000001)); }
  template <class T>
  T value(const T& d, const Point<T>& p) const {
    return (d - noise.value(p)) * scale;
  }
  double slope(const Interval&, double slope, const Point<Interval>&) const {
    return (slope + noise.slope()) * scale;
  }
  double child_level(double level) const { return level / scale + noise.largest() * 1.0001; }
  Levels looks_at(const Levels& own) const {
    return own.scaled(1 / static_cast<double>(scale)).wider(noise.largest() * 1.0001);
  }
  Box bounds(const Box& a) const { return a; }
};

struct FormulaDisplacement {
  static constexpr OpInfo info = {
      "formula_displace",
      OpRole::range,
      OpGuarantee::computed,
      "Moves the surface of a node outwards by a formula of the position.",
      "formula_displace: {f: \"0.08 * sin(6*x) * sin(6*y) * sin(6*z)\", of: {sphere: {radius: 1}}}",
      "slope by intervals of the formula's gradient"};
  static constexpr bool kTakesAway = true;
  static constexpr Parameter parameters[] = {
      {"f", ParameterKind::text, "length", {kRequired, 0, 0}, 0, 0, "how far, of x, y, z and t"},
      size("largest", 0.5, "the solid may grow by this much; the formula is cut there"),
      number("t", 0, -kAny, kAny, "time; in scenes that of the frame unless said")};
  static constexpr bool kList = true;
  static std::vector<float> list_of(const std::vector<Argument>& arguments);
  float largest, time;

  template <class T>
  T value(const T& d, const Point<T>& p, Data code) const {
    return d - clamp(run_formula(code, p), -largest, largest);
  }
  double child_level(double level) const { return level + largest; }
  Levels looks_at(const Levels& own) const { return own.wider(largest); }
  Box bounds(const Box& a) const { return a; }
};

// A picture laid on x and y, or once around the z axis: there the displacement fades in proportion
// to the distance from the axis within `around`, which keeps its slope bounded.
struct TextureDisplacement {
  static constexpr OpInfo info = {
      "texture_displace",
      OpRole::range,
      OpGuarantee::bound,
      "Moves the surface of a node outwards by a picture: black not at all, white by `amplitude`. "
      "The picture lies on x and y, its middle at the origin, and repeats; or it goes once around "
      "the z axis.",
      "texture_displace: {width: 4, samples: [0, 1, 0, 0.3, 1, 0, 0.6, 0, 0, 0.2, 0, 1, 0.5, 0, 1, "
      "0], size: 0.8, amplitude: 0.15, of: {box: {size: [2, 1.4, 0.6]}}}",
      "quadratic B-spline over the samples; divided by 1 + the largest difference of neighbours "
      "per "
      "length"};
  static constexpr bool kTakesAway = true;
  static constexpr Parameter parameters[] = {
      {"file",
       ParameterKind::text,
       "",
       {0, 0, 0},
       0,
       0,
       "a picture, beside the scene; its grey values as they are stored"},
      {"samples",
       ParameterKind::numbers,
       "",
       {0, 0, 0},
       -1e6,
       1e6,
       "instead of a file: heights row by row from the top, 0 black, 1 white"},
      whole("width", 1, 1, 65536, "of `samples`: how many make a row"),
      number("amplitude", 0.1, -kAny, kAny, "how far white moves the surface", "length"),
      {"size",
       ParameterKind::pair,
       "length",
       {1, 1, 0},
       kSmall,
       kAny,
       "width and height of one copy; around an axis the height only"},
      number("around", 0, 0, kAny, "0, or the radius of the surface that it goes around",
             "length")};
  static constexpr bool kList = true;
  float width, amplitude;
  float size[2];
  float around;
  float height, least, most;  // of the picture
  float steepness;            // of the displacement
  float scale;

  void prepare(Data samples);
  [[nodiscard]] Texture picture(Data samples) const {
    return {samples.values, static_cast<int>(width), static_cast<int>(height), least, most};
  }
  template <class T>
  T value(const T& d, const Point<T>& p, Data samples) const {
    const Texture t = picture(samples);
    if (around > 0) {
      // On the axis itself the angle has no derivative.
      const T beside = select(abs(p.x) + abs(p.y) > T(1e-12F), p.x, T(1e-12F));
      const T u = (atan2(p.y, beside) * 0.159154943F + 0.5F) * width;
      const T v = (T(0.5F) - p.z * (1 / size[1])) * height;
      const T fade = min(length(p.x, p.y) * (1 / around), T(1.0F));
      return (d - texture(t, u, v) * fade * amplitude) * scale;
    }
    const T u = (p.x * (1 / size[0]) + 0.5F) * width;
    const T v = (T(0.5F) - p.y * (1 / size[1])) * height;
    return (d - texture(t, u, v) * amplitude) * scale;
  }
  double slope(const Interval&, double slope, const Point<Interval>&) const {
    return (slope + steepness) * scale;
  }
  Levels looks_at(const Levels& own) const {
    const double furthest =
        static_cast<double>(std::fabs(amplitude)) * std::fmax(std::fabs(least), std::fabs(most));
    return own.scaled(1 / static_cast<double>(scale)).wider(furthest * 1.0001);
  }
  double child_level(double level) const {
    const double most_out =
        std::fmax(static_cast<double>(amplitude) * most, static_cast<double>(amplitude) * least);
    return level / scale + std::fmax(most_out, 0.0) * 1.0001;
  }
  Box bounds(const Box& a) const { return a; }
};

struct Terrain {
  static constexpr OpInfo info = {
      "terrain",
      OpRole::leaf,
      OpGuarantee::bound,
      "Ground below a fractal height over x and y: spectral synthesis by octaves of noise.",
      "terrain: {dimension: 2.2, seed: 3, size: 2, height: 0.4, octaves: 6}",
      "R. F. Voss 1985: fractal dimension D has amplitudes 2^-(3 - D) per octave; divided by the "
      "slope sqrt(1 + L^2)"};
  static constexpr Parameter parameters[] = {
      number("dimension", 2.2, 2, 3, "fractal dimension of the surface"),
      whole("seed", 0, 0, 500, "another landscape"), size("size", 1, "of its largest hills"),
      number("height", 0.3, 0, 1e6, "of its largest hills", "length"),
      whole("octaves", 7, 1, 12, "of detail")};
  float dimension, seed, extent, height, octaves;
  Octaves noise;
  float scale;

  void prepare(Data) {
    noise = {1 / extent, height, octaves, 2 * (3 - dimension), seed};
    const double slope = noise.slope();
    scale = static_cast<float>(1 / std::sqrt(1 + slope * slope * 1.000001));
  }
  template <class T>
  T distance(const Point<T>& p) const {
    return (p.z - noise.value(Point<T>{p.x, p.y, T(0.5F * extent)})) * scale;
  }
  Box bounds(Data, double level) const {
    const double top = noise.largest() * 1.0001 + std::fmax(level, 0.0) / scale;
    return {glm::dvec3(-kInfinity), glm::dvec3(kInfinity, kInfinity, top)};
  }
};

using Displacements = OpList<NoiseDisplacement, FormulaDisplacement, TextureDisplacement>;
using TerrainLeaves = OpList<Terrain>;

}  // namespace sdfgrid::ops
