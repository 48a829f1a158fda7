// Evaluation of a CSG scene of 127 ops (64 solids, 63 combinations) at 128^3 points, one thread:
//   tree    a tree of virtual nodes, point by point, as most programs do it
//   batch   Field::evaluate
//   pruned  the same after pruning for 64^3, 32^3, 16^3 and 8^3 points in turn; must give the bits
//   of batch field_bench [REPETITIONS]
#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdlib>
#include <cstring>
#include <ctime>
#include <functional>
#include <random>

#include "csg_scene.h"
#include "sdfgrid/field/field.h"

namespace {

using sdfgrid::Box;
using sdfgrid::Field;
using sdfgrid::make_field;

constexpr int kSide = 128;

struct Samples {
  std::vector<float> x, y, z, value;
};

// The points of a cube of the lattice, z fastest; cubes of 8^3 points are contiguous when pruned.
float coordinate(int i) { return -2 + 4 * (static_cast<float>(i) + 0.5F) / kSide; }

Samples cube(int x0, int y0, int z0, int side) {
  Samples s;
  for (int x = 0; x < side; ++x) {
    for (int y = 0; y < side; ++y) {
      for (int z = 0; z < side; ++z) {
        s.x.push_back(coordinate(x0 + x));
        s.y.push_back(coordinate(y0 + y));
        s.z.push_back(coordinate(z0 + z));
      }
    }
  }
  s.value.resize(s.x.size());
  return s;
}

Box box_of(const glm::ivec3& at, int side) {
  return {glm::dvec3(coordinate(at.x), coordinate(at.y), coordinate(at.z)),
          glm::dvec3(coordinate(at.x + side - 1), coordinate(at.y + side - 1),
                     coordinate(at.z + side - 1))};
}

// Values brick by brick, as a sparse grid keeps them: 512 a brick, z fastest.
struct Pruned {
  std::vector<float> value = std::vector<float>(kSide * kSide * kSide);
  std::size_t ops = 0;
  std::size_t bricks = 0;
};

std::size_t brick_start(const glm::ivec3& at) {
  constexpr int kBricks = kSide / 8;
  return static_cast<std::size_t>(((at.x / 8) * kBricks + at.y / 8) * kBricks + at.z / 8) * 512;
}

void brick(const Field& field, const glm::ivec3& at, Pruned& out) {
  out.ops += field.size();
  ++out.bricks;
  float axis[3][8];
  for (int a = 0; a < 3; ++a) {
    for (int i = 0; i < 8; ++i) axis[a][i] = coordinate(at[a] + i);
  }
  std::array<float, 512> x;
  std::array<float, 512> y;
  std::array<float, 512> z;
  for (int i = 0; i < 64; ++i) {
    for (int k = 0; k < 8; ++k) {
      x[i * 8 + k] = axis[0][i / 8];
      y[i * 8 + k] = axis[1][i % 8];
      z[i * 8 + k] = axis[2][k];
    }
  }
  field.evaluate(512, x.data(), y.data(), z.data(), &out.value[brick_start(at)]);
}

// Whether the bricks hold the bits of the lattice.
bool same_bits(const std::vector<float>& bricks, const std::vector<float>& lattice) {
  for (int x = 0; x < kSide; ++x) {
    for (int y = 0; y < kSide; ++y) {
      for (int z = 0; z < kSide; z += 8) {
        const std::size_t from = brick_start({x, y, z}) + (x % 8) * 64 + (y % 8) * 8;
        const std::size_t to = (static_cast<std::size_t>(x) * kSide + y) * kSide + z;
        if (std::memcmp(&bricks[from], &lattice[to], 8 * sizeof(float)) != 0) return false;
      }
    }
  }
  return true;
}

void descend(const Field& field, const glm::ivec3& at, int side, Pruned& out) {
  if (side == 8) return brick(field, at, out);
  const int half = side / 2;
  for (int i = 0; i < 8; ++i) {
    const glm::ivec3 part = at + glm::ivec3(i >> 2 & 1, i >> 1 & 1, i & 1) * half;
    descend(field.pruned(box_of(part, half)), part, half, out);
  }
}

double seconds(const std::function<void()>& work) {
  const std::clock_t start = std::clock();
  work();
  return static_cast<double>(std::clock() - start) / CLOCKS_PER_SEC;
}

double median(std::vector<double> t) {
  std::sort(t.begin(), t.end());
  return t[t.size() / 2];
}

// The exact ellipsoid against the cheap bound: time, and how much of the distance the bound gives.
void ellipsoids(const Samples& at) {
  std::vector<float> value(at.x.size());
  for (const double thin : {1.0, 0.5, 0.2, 0.1, 0.05}) {
    const Field exact = make_field("ellipsoid", {{"radii", {1, 1, thin}}});
    const Field bound = make_field("ellipsoid_bound", {{"radii", {1, 1, thin}}});
    const auto time = [&](const Field& f, std::vector<float>& out) {
      return seconds(
          [&] { f.evaluate(at.x.size(), at.x.data(), at.y.data(), at.z.data(), out.data()); });
    };
    std::vector<float> cheap(at.x.size());
    const double n = static_cast<double>(value.size()) * 1e-9;
    const double t_exact = time(exact, value) / n;
    const double t_bound = time(bound, cheap) / n;
    double least = 1;
    double sum = 0;
    std::size_t outside = 0;
    for (std::size_t i = 0; i < value.size(); ++i) {
      if (value[i] < 0.01F) continue;
      const double ratio = static_cast<double>(cheap[i]) / value[i];
      least = std::min(least, ratio);
      sum += ratio;
      ++outside;
    }
    fmt::print(
        "ellipsoid 1:1:{:<4} exact {:5.2f} ns/point, bound {:5.2f} ns/point, of the distance "
        "it gives {:.3f} on average, {:.3f} at least\n",
        thin, t_exact, t_bound, sum / static_cast<double>(outside), least);
  }
}

}  // namespace

int main(int argc, char** argv) {
  const int repetitions = argc > 1 ? std::max(1, std::atoi(argv[1])) : 5;
  std::mt19937 random(42);
  const Both both = csg_scene(0, kSolids, random);
  Samples all = cube(0, 0, 0, kSide);
  std::vector<float> tree(all.x.size());
  Pruned pruned;
  std::vector<double> t_tree;
  std::vector<double> t_batch;
  std::vector<double> t_pruned;
  for (int r = 0; r < repetitions; ++r) {
    t_tree.push_back(seconds([&] {
      for (std::size_t i = 0; i < tree.size(); ++i) {
        tree[i] = both.node->at(all.x[i], all.y[i], all.z[i]);
      }
    }));
    t_batch.push_back(seconds([&] {
      both.field.evaluate(all.x.size(), all.x.data(), all.y.data(), all.z.data(), all.value.data());
    }));
    pruned.ops = pruned.bricks = 0;
    t_pruned.push_back(seconds([&] { descend(both.field, glm::ivec3(0), kSide, pruned); }));
  }
  double difference = 0;
  for (std::size_t i = 0; i < tree.size(); ++i) {
    difference = std::max(difference, std::fabs(static_cast<double>(tree[i]) - all.value[i]));
  }
  const bool same = same_bits(pruned.value, all.value);
  const double n = static_cast<double>(tree.size()) * 1e-9;
  fmt::print("program of {} instructions, {:.1f} left a brick\n", both.field.size(),
             static_cast<double>(pruned.ops) / static_cast<double>(pruned.bricks));
  fmt::print("tree   {:7.2f} ns/point\n", median(t_tree) / n);
  fmt::print("batch  {:7.2f} ns/point  {:5.1f} times  largest difference {:.2g}\n",
             median(t_batch) / n, median(t_tree) / median(t_batch), difference);
  fmt::print("pruned {:7.2f} ns/point  {:5.1f} times  {}\n", median(t_pruned) / n,
             median(t_tree) / median(t_pruned), same ? "the same bits as batch" : "OTHER BITS");
  ellipsoids(all);
  return same ? 0 : 1;
}
