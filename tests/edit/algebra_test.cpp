// Strokes obey the algebra of sets: against the solids in closed form, against fresh conversions of
// them, and against each other. Over random strokes with every kind of brush.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <glm/common.hpp>
#include <glm/geometric.hpp>
#include <random>

#include "edit/grids.h"
#include "sdfgrid/edit/field_brush.h"
#include "sdfgrid/edit/sculptor.h"
#include "sdfgrid/grid/convert.h"
#include "sdfgrid/volume/isosurface.h"

namespace sdfgrid {
namespace {

using namespace sdfgrid::test;
constexpr int kExtent = 30;
constexpr double kVoxel = 0.1;
constexpr double kModel = 15;  // radius of the ball that strokes work on, voxels

using Solid = std::function<double(const glm::dvec3&)>;  // voxels, negative inside

struct Case {
  Stroke stroke;
  Solid solid;
  const char* kind;
  bool has_edges = false;
  double within = 0.1;  // voxels in which 98 of 100 samples of what was made in two ways agree
};

Solid ball(const glm::dvec3& at, double radius) {
  return [=](const glm::dvec3& p) { return glm::length(p - at) - radius; };
}
Solid box(const glm::dvec3& at, const glm::dvec3& half) {
  return [=](const glm::dvec3& p) {
    const glm::dvec3 q = glm::abs(p - at) - half;
    return glm::length(glm::max(q, glm::dvec3(0))) + std::min(std::max({q.x, q.y, q.z}), 0.0);
  };
}
Solid capsule(const glm::dvec3& a, const glm::dvec3& b, double radius) {
  return [=](const glm::dvec3& p) {
    const glm::dvec3 e = b - a;
    const double t = glm::clamp(glm::dot(p - a, e) / glm::dot(e, e), 0.0, 1.0);
    return glm::length(p - a - t * e) - radius;
  };
}

// Balls, swept balls and boxes in turn, around the surface of the model.
std::vector<Case> random_cases(int count, unsigned seed) {
  std::mt19937 random(seed);
  std::normal_distribution<double> direction;
  std::uniform_real_distribution<double> one(0, 1);
  std::vector<Case> cases;
  for (int i = 0; i < count; ++i) {
    const glm::dvec3 d =
        glm::normalize(glm::dvec3(direction(random), direction(random), direction(random)));
    const glm::dvec3 at = d * (11 + 7 * one(random));
    const double radius = 4 + 4 * one(random);
    Case c{ball_stroke(StrokeOp::unite, at, radius), ball(at, radius), "ball"};
    if (i % 3 == 1) {
      const glm::dvec3 to = at + 6.0 * glm::dvec3(one(random), one(random), -one(random));
      c.stroke.path.push_back({to * kVoxel});
      c.solid = capsule(at, to, radius);
      c.kind = "swept ball";
    } else if (i % 3 == 2) {
      const glm::dvec3 half = radius * glm::dvec3(0.5 + 0.5 * one(random), 0.7, 0.9);
      const glm::dvec3 size = 2.0 * kVoxel * half;
      c.stroke.brush.radius = 0;
      c.stroke.brush.shape =
          make_brush(make_field("box", {{"size", {size.x, size.y, size.z}}}), true);
      c.solid = box(at, half);
      c.kind = "box";
      c.has_edges = true;
    }
    cases.push_back(std::move(c));
  }
  return cases;
}

// Brushes whose values are only bounds of the distance to them: a ball as a formula, whose values
// are a fraction of the distance, and a twisted bar.
std::vector<Case> bound_cases(int count, unsigned seed) {
  std::vector<Case> cases = random_cases(count, seed);
  int number = 0;
  for (Case& c : cases) {
    const glm::dvec3 at = c.stroke.path[0].at / kVoxel;
    c.stroke = ball_stroke(StrokeOp::unite, at, 0);
    if (number++ % 2 == 0) {
      const double radius = 5.3 + 0.2 * number;
      const std::string f =
          "x^2 + y^2 + z^2 - " + std::to_string(radius * radius * kVoxel * kVoxel);
      c.stroke.brush.shape =
          make_brush(make_field("formula", {{"f", f}, {"bounds", {-1, -1, -1, 1, 1, 1}}}), false);
      c.solid = ball(at, std::sqrt(std::stod(std::to_string(radius * radius * 0.01)) * 100));
      c.kind = "formula";
      c.has_edges = false;
      // Beside its surface, too, samples are measured anew, to the trilinear surface (1 / (4 R)
      // from the ball's, R > 5) and what a kept value may be wrong by (0.03); each time anew.
      c.within = 2 * (0.05 + 0.03);
      continue;
    }
    constexpr double kTurns = 0.25;  // per unit of length
    const glm::dvec3 half(6, 2.5, 8);
    const Field bar = make_field("box", {{"size", {1.2, 0.5, 1.6}}});
    c.stroke.brush.shape = make_brush(make_field("twist", {{"turns", kTurns}}, {bar}), false);
    c.solid = [=, straight = box(glm::dvec3(0), half)](const glm::dvec3& p) {
      const glm::dvec3 q = p - at;
      const double angle = q.z * kVoxel * kTurns * 2 * 3.141592653589793;
      const double cosine = std::cos(angle);
      const double sine = std::sin(angle);
      return straight({cosine * q.x + sine * q.y, cosine * q.y - sine * q.x, q.z});
    };
    c.kind = "twist";
    c.has_edges = true;
  }
  return cases;
}

Stroke with(Stroke stroke, StrokeOp op) {
  stroke.op = op;
  return stroke;
}

Grid sculpted(const std::vector<Stroke>& strokes) {
  Grid grid = ball_grid(kModel, kVoxel);
  Sculptor sculptor(grid);
  for (const Stroke& stroke : strokes) (void)sculptor.apply(stroke, Job());
  return grid;
}

void for_samples(const std::function<void(const glm::ivec3&)>& visit) {
  for (int x = -kExtent; x <= kExtent; ++x) {
    for (int y = -kExtent; y <= kExtent; ++y) {
      for (int z = -kExtent; z <= kExtent; ++z) visit({x, y, z});
    }
  }
}

// The sign of every sample, but of those that lie on the solid's surface to single precision.
void expect_solid(const Grid& grid, const Solid& solid, const std::string& what) {
  int wrong = 0;
  for_samples([&](const glm::ivec3& p) {
    const double truth = solid(glm::dvec3(p));
    if (std::abs(truth) > 1e-4) wrong += (grid.value(p) < 0) != (truth < 0) ? 1 : 0;
  });
  EXPECT_EQ(wrong, 0) << what;
}

// Both hold the same solid, and nearly everywhere the same distances. What the two measured to a
// crease may differ: the grid's trilinear surface rounds it off within the cell that it goes
// through, by half of its diagonal at most, each time as it was made. A box's edges are nearest to
// much of its band.
void expect_same(const Grid& a, const Grid& b, const Case& c) {
  int wrong = 0;
  std::vector<double> differences;
  for_samples([&](const glm::ivec3& p) {
    const double va = a.value(p) / kVoxel;
    const double vb = b.value(p) / kVoxel;
    if (std::abs(va) > 1e-4 && std::abs(vb) > 1e-4) wrong += (va < 0) != (vb < 0) ? 1 : 0;
    if (std::min(std::abs(va), std::abs(vb)) < 2.99) differences.push_back(std::abs(va - vb));
  });
  EXPECT_EQ(wrong, 0) << c.kind;
  ASSERT_GT(differences.size(), 100U) << c.kind;
  std::sort(differences.begin(), differences.end());
  // A sliver between two samples may be there in the one and lost in the other.
  EXPECT_LT(differences[differences.size() * 999 / 1000], 0.87) << c.kind;
  if (c.has_edges) return;
  EXPECT_LT(differences[differences.size() * 98 / 100], c.within) << c.kind;
}

// The surface of a solid by marching cubes on a lattice twice as fine, converted anew.
Grid fresh_conversion(const Solid& solid) {
  constexpr int kFine = 2 * kExtent;
  Volume volume;
  volume.dims = glm::ivec3(2 * kFine + 1);
  volume.spacing = glm::dvec3(0.5 * kVoxel);
  volume.origin = glm::dvec3(-kFine * 0.5 * kVoxel);
  std::vector<float> samples(volume.size());
  for (int z = 0; z <= 2 * kFine; ++z) {
    for (int y = 0; y <= 2 * kFine; ++y) {
      for (int x = 0; x <= 2 * kFine; ++x) {
        const glm::dvec3 p = 0.5 * glm::dvec3(x - kFine, y - kFine, z - kFine);
        samples[volume.place({x, y, z})] = static_cast<float>(solid(p));
      }
    }
  }
  volume.samples = std::move(samples);
  ConvertOptions options;
  options.voxel = kVoxel;
  return convert_mesh(isosurface(volume, {0, false}, Job()), options, Job()).grid;
}

// Distances of the band against those of a fresh conversion, in voxels.
struct Deviation {
  double mean = 0, p99 = 0, share = 0;  // share: of samples more than half a voxel off
  int samples = 0, wrong_signs = 0;
};
Deviation deviation(const Grid& grid, const Grid& fresh) {
  Deviation d;
  std::vector<double> errors;
  for_samples([&](const glm::ivec3& p) {
    const double truth = fresh.value(p) / kVoxel;
    const double got = grid.value(p) / kVoxel;
    if (std::abs(truth) > 0.3) d.wrong_signs += (got < 0) != (truth < 0) ? 1 : 0;
    if (std::abs(truth) < 2.9) errors.push_back(std::abs(got - truth));
  });
  std::sort(errors.begin(), errors.end());
  d.samples = static_cast<int>(errors.size());
  for (const double e : errors) d.mean += e / d.samples;
  d.share =
      static_cast<double>(errors.end() - std::upper_bound(errors.begin(), errors.end(), 0.5)) /
      d.samples;
  d.p99 = errors[errors.size() * 99 / 100];
  return d;
}

// ((model u b) - c) u d ...: the solids in closed form, and the distances against those of fresh
// conversions. The bounds that min and max alone leave are seen.
TEST(Algebra, UnionThenDifferenceIsTheFreshConversion) {
  for (const unsigned seed : {1U, 2U, 3U}) {
    Solid solid = ball(glm::dvec3(0), kModel);
    std::vector<Stroke> strokes;
    int number = 0;
    for (const Case& c : random_cases(6, seed)) {
      const bool unite = number++ % 2 == 0;
      strokes.push_back(with(c.stroke, unite ? StrokeOp::unite : StrokeOp::subtract));
      solid = [unite, before = solid, other = c.solid](const glm::dvec3& p) {
        return unite ? std::min(before(p), other(p)) : std::max(before(p), -other(p));
      };
      expect_solid(sculpted(strokes), solid, c.kind);
    }
    const Grid fresh = fresh_conversion(solid);
    const Deviation local = deviation(sculpted(strokes), fresh);
    EXPECT_GT(local.samples, 10000);
    EXPECT_EQ(local.wrong_signs, 0);
    // Mostly at creases and boxes' edges: both round them off within a voxel, the fresh
    // conversion's marching cubes within half of one.
    EXPECT_LT(local.mean, 0.03);
    EXPECT_LT(local.p99, 0.5);
    const Grid bounds = ball_grid(kModel, kVoxel);
    SculptOptions off;
    off.redistance = Redistance::off;
    Sculptor plain(bounds, off);
    for (const Stroke& stroke : strokes) (void)plain.apply(stroke, Job());
    const Deviation unmeasured = deviation(bounds, fresh);
    EXPECT_LT(local.share, 0.005);
    EXPECT_GT(unmeasured.share, 4 * local.share) << unmeasured.share;
    RecordProperty("mean", std::to_string(local.mean));
    RecordProperty("p99", std::to_string(local.p99));
    RecordProperty("share", std::to_string(local.share));
    RecordProperty("share_off", std::to_string(unmeasured.share));
  }
}

TEST(Algebra, Idempotence) {
  for (const Case& c : random_cases(6, 4)) {
    for (const StrokeOp op : {StrokeOp::unite, StrokeOp::subtract, StrokeOp::intersect}) {
      const Stroke stroke = with(c.stroke, op);
      expect_same(sculpted({stroke}), sculpted({stroke, stroke}), c);
    }
  }
}

// (A - B) u B = A u B, (A u B) - B = A - B, (A u B) n B = B u (A n B) = B.
TEST(Algebra, Absorption) {
  for (const Case& c : random_cases(6, 5)) {
    const Stroke unite = with(c.stroke, StrokeOp::unite);
    const Stroke subtract = with(c.stroke, StrokeOp::subtract);
    const Stroke intersect = with(c.stroke, StrokeOp::intersect);
    expect_same(sculpted({subtract, unite}), sculpted({unite}), c);
    expect_same(sculpted({unite, subtract}), sculpted({subtract}), c);
    expect_same(sculpted({unite, intersect}), sculpted({intersect, unite}), c);
    expect_solid(sculpted({unite, intersect}), c.solid, c.kind);
  }
}

// The same of brushes that are only bounds, and against the solids: their values decide signs and
// nothing else, so that the surface lies between the right samples.
TEST(Algebra, BrushesThatAreBoundsObeyItToo) {
  const Solid model = ball(glm::dvec3(0), kModel);
  for (const Case& c : bound_cases(6, 8)) {
    const Stroke unite = with(c.stroke, StrokeOp::unite);
    const Stroke subtract = with(c.stroke, StrokeOp::subtract);
    const Stroke intersect = with(c.stroke, StrokeOp::intersect);
    for (const Stroke& stroke : {unite, subtract, intersect}) {
      const Solid solid = [&](const glm::dvec3& p) {
        const double a = model(p);
        const double b = c.solid(p);
        if (stroke.op == StrokeOp::unite) return std::min(a, b);
        return std::max(a, stroke.op == StrokeOp::subtract ? -b : b);
      };
      expect_solid(sculpted({stroke}), solid, c.kind);
      expect_same(sculpted({stroke}), sculpted({stroke, stroke}), c);
    }
    expect_same(sculpted({subtract, unite}), sculpted({unite}), c);
    expect_same(sculpted({unite, subtract}), sculpted({subtract}), c);
    expect_same(sculpted({unite, intersect}), sculpted({intersect, unite}), c);
  }
}

// A u B u C = A u C u B, A - B - C = A - C - B = A - (B u C).
TEST(Algebra, TheOrderOfUnionsAndOfDifferencesDoesNotMatter) {
  const std::vector<Case> cases = random_cases(6, 6);
  for (std::size_t i = 0; i + 1 < cases.size(); ++i) {
    for (const StrokeOp op : {StrokeOp::unite, StrokeOp::subtract}) {
      const Stroke b = with(cases[i].stroke, op);
      const Stroke c = with(cases[i + 1].stroke, op);
      expect_same(sculpted({b, c}), sculpted({c, b}), cases[i + 1 - i % 3 / 2]);
    }
  }
}

// Brushes whose middle or side lies on the borders of bricks, and on their corners.
TEST(Algebra, AcrossTheBordersOfBricks) {
  for (const glm::dvec3 at : {glm::dvec3(16, 0, 0), glm::dvec3(8, 8, 8), glm::dvec3(7, 8, 8),
                              glm::dvec3(-8, -8, 8), glm::dvec3(15.5, 7.5, -0.5)}) {
    for (const double radius : {4.0, 8.0, 7.999}) {
      const TwoBalls balls{glm::dvec3(0), at, kModel, radius};
      for (const StrokeOp op : {StrokeOp::unite, StrokeOp::subtract}) {
        const Grid grid = sculpted({ball_stroke(op, at, radius)});
        double worst = 0;
        for_samples([&](const glm::ivec3& s) {
          const glm::dvec3 p(s);
          const double truth = op == StrokeOp::unite ? balls.unite(p) : balls.subtract(p);
          const double got = grid.value(s) / kVoxel;
          ASSERT_TRUE(std::abs(truth) <= 1e-4 || (got < 0) == (truth < 0));
          if (balls.to_crease(p) < std::abs(truth) + 1.5) return;
          worst = std::max(worst, std::abs(got - glm::clamp(truth, -3.0, 3.0)));
        });
        // The trilinear surface is by 1 / (4 radius) off at most.
        EXPECT_LT(worst, 1 / (4 * radius)) << at.x << " " << at.y << " " << at.z << " " << radius;
      }
    }
  }
}

// The blend of two solids, min(a, b) - h^2 k / 4 with h = max(k - |a - b|, 0) / k (and its mirror
// image for differences), in double: its surface is where the engine's is, and what the engine
// leaves are distances to it, which the blend's values themselves are not.
TEST(Algebra, SmoothStrokesBlendAndLeaveDistances) {
  constexpr double kBlend = 2.5;  // voxels
  for (const StrokeOp op : {StrokeOp::unite, StrokeOp::subtract, StrokeOp::intersect}) {
    const Solid a = ball(glm::dvec3(0), kModel);
    const Solid b = ball({13, 4, 0}, 9);
    const Solid blend = [&](const glm::dvec3& p) {
      const double sign = op == StrokeOp::unite ? 1 : -1;
      const double x = sign * a(p);
      const double y = op == StrokeOp::intersect ? sign * b(p) : b(p);
      const double h = std::max(kBlend - std::abs(x - y), 0.0) / kBlend;
      return sign * (std::min(x, y) - h * h * kBlend / 4);
    };
    Stroke stroke = ball_stroke(op, {13, 4, 0}, 9);
    stroke.smooth = kBlend * kVoxel;
    const Grid grid = sculpted({stroke});
    const Grid sharp = sculpted({with(ball_stroke(op, {13, 4, 0}, 9), op)});
    const Grid fresh = fresh_conversion(blend);
    int moved = 0;
    for_samples([&](const glm::ivec3& p) {
      const double truth = blend(glm::dvec3(p));
      const double got = grid.value(p) / kVoxel;
      ASSERT_TRUE(std::abs(truth) <= 0.05 || (got < 0) == (truth < 0)) << stroke_op_word(op);
      moved += (grid.value(p) < 0) != (sharp.value(p) < 0) ? 1 : 0;
    });
    EXPECT_GT(moved, 20) << stroke_op_word(op);
    const Deviation d = deviation(grid, fresh);
    EXPECT_EQ(d.wrong_signs, 0);
    EXPECT_LT(d.p99, 1 / (4 * kBlend)) << stroke_op_word(op);  // of the blend's own radius
  }
}

// The lesson of fVDB: deep inside, beyond the band, a grid holds a constant that is no distance. No
// way of re-distancing takes it for the outside, whatever the band; the inner band is exact to the
// cavity's trilinear surface.
TEST(Algebra, InteriorBeyondTheBandIsNeverReadAsOutside) {
  for (const double width : {3.0, 8.0}) {
    for (const Redistance redistance : {Redistance::local, Redistance::full}) {
      const Grid grid = ball_grid(26, kVoxel, width);
      SculptOptions options;
      options.redistance = redistance;
      Sculptor sculptor(grid, options);
      (void)sculptor.apply(ball_stroke(StrokeOp::subtract, {0, 0, 0}, 7), Job());
      (void)sculptor.apply(ball_stroke(StrokeOp::subtract, {6, 0, 0}, 7), Job());
      const Solid truth = [](const glm::dvec3& p) {  // outside of a union min is exact
        return std::max(glm::length(p) - 26,
                        7 - std::min(glm::length(p), glm::length(p - glm::dvec3(6, 0, 0))));
      };
      double inner = 0;
      for_samples([&](const glm::ivec3& p) {
        const double t = truth(glm::dvec3(p));
        const double got = grid.value(p) / kVoxel;
        ASSERT_TRUE(std::abs(t) <= 1e-4 || (got < 0) == (t < 0)) << width;
        if (t < 0) inner = std::max(inner, std::abs(got - std::max(t, -width)));
      });
      // What a kept value may be wrong by, and the trilinear surface.
      EXPECT_LT(inner, 0.03 + 1.0 / (4 * 7)) << width;
      RecordProperty("inner", std::to_string(inner));
    }
  }
}

}  // namespace
}  // namespace sdfgrid
