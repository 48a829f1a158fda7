#include "sdfgrid/grid/convert_field.h"

#include <fmt/format.h>

#include <algorithm>
#include <atomic>
#include <bit>
#include <chrono>
#include <cmath>
#include <glm/common.hpp>
#include <iterator>
#include <optional>
#include <vector>

#include "sdfgrid/core/error.h"
#include "sdfgrid/core/memory.h"
#include "sdfgrid/core/parallel.h"
#include "sdfgrid/field/emptiness.h"
#include "sdfgrid/grid/level_set.h"

namespace sdfgrid {
namespace {

constexpr int kEdge = 8;        // samples of a brick
constexpr int kBlock = 4;       // samples of a block: a brick has 2^3
constexpr int kTaskEdge = 128;  // samples of what one thread takes at a time
constexpr double kMostVoxels = 1e8;

// What to look at in a solid that is empty.
Error nothing_in(const Field& field) {
  const std::vector<std::string> ops = ops_that_take_away(field);
  return {ErrorKind::input,
          "there is nothing in it: no point is inside; " +
              (ops.empty() ? "give it a shape, or a smaller voxel"
                           : fmt::format("look for what its `{}` leaves", fmt::join(ops, "`, `")))};
}

constexpr double kLeafBytes = sizeof(openvdb::FloatTree::LeafNodeType) + 512 * sizeof(float) + 64;

// A cube of lattice points: its lowest index and how many points a side.
struct Cube {
  glm::ivec3 lo;
  int edge;
};

Cube octant(const Cube& cube, int i) {
  const int half = cube.edge / 2;
  return {cube.lo + glm::ivec3(i >> 2 & 1, i >> 1 & 1, i & 1) * half, half};
}

// Points of the lattice as columns, and what the field is there.
struct Points {
  explicit Points(const Lattice& lattice) : lattice_(lattice) {}
  void clear() { n = 0; }
  void add(const glm::dvec3& index) {
    const glm::dvec3 p = lattice_.to_world(index);
    x[n] = static_cast<float>(p.x);
    y[n] = static_cast<float>(p.y);
    z[n] = static_cast<float>(p.z);
    ++n;
  }
  void evaluate(const Field& field) { field.evaluate(n, x, y, z, value); }

  static constexpr int kMost = kEdge * kEdge * kEdge;
  std::size_t n = 0;
  float x[kMost], y[kMost], z[kMost], value[kMost];

 private:
  Lattice lattice_;
};

// What one task makes.
struct Part {
  std::vector<LeafPointer> leaves;
  std::size_t evaluated = 0;
  std::size_t regions = 0;
  bool inside = false;  // whether it has a sample inside
};

class Subdivision {
 public:
  Subdivision(const Lattice& lattice, const Band& band, const Job& job)
      : lattice_(lattice),
        job_(job),
        out_(static_cast<float>(band.exwidth * lattice.voxel)),
        in_(static_cast<float>(-band.inwidth * lattice.voxel)),
        points_(lattice) {}

  void run(const Field& field, const Cube& cube) {
    ++made.regions;
    const std::optional<Field> here = within_band(field, cube);
    if (!here) return;
    if (cube.edge == 4 * kEdge) job_.checkpoint();
    if (cube.edge == kEdge) return run_brick(*here, cube);
    for (int i = 0; i < 8; ++i) run(*here, octant(cube, i));
  }

  // What is left of the field in the cube, if its values there may be in the band.
  [[nodiscard]] std::optional<Field> within_band(const Field& field, const Cube& cube) const {
    const Restricted here = *field.restricted(box_of(cube), kAnyLength, out_);
    if (here.range.lo < out_ && here.range.hi > in_) return here.field;
    return {};
  }

  // The cube's points, as they are rounded to float.
  [[nodiscard]] Box box_of(const Cube& cube) const {
    const glm::dvec3 lo = lattice_.to_world(glm::dvec3(cube.lo));
    const glm::dvec3 hi = lattice_.to_world(glm::dvec3(cube.lo + cube.edge - 1));
    const glm::dvec3 slack = 1e-7 * glm::max(glm::abs(lo), glm::abs(hi));
    return {lo - slack, hi + slack};
  }

  Part made;

 private:
  // Blocks that lie beyond the band, as their middle tells, are not looked at closer.
  void run_brick(const Field& field, const Cube& brick) {
    constexpr double kMiddle = 0.5 * (kBlock - 1);
    const Box box = box_of(brick);
    const glm::dvec3 far = glm::max(glm::abs(box.lo), glm::abs(box.hi));
    const auto reach = static_cast<float>(std::sqrt(3.0) * kMiddle * lattice_.voxel * 1.0001 +
                                          1e-6 * (far.x + far.y + far.z));
    points_.clear();
    for (int b = 0; b < 8; ++b) {
      points_.add(glm::dvec3(octant(brick, b).lo) + glm::dvec3(kMiddle));
    }
    points_.evaluate(field);
    made.evaluated += points_.n;
    float probe[8];
    std::copy_n(points_.value, 8, probe);
    const auto beyond = [&](int b) { return probe[b] - reach >= out_ || probe[b] + reach <= in_; };

    points_.clear();
    for (int b = 0; b < 8; ++b) {
      if (!beyond(b)) add_block(octant(brick, b));
    }
    if (points_.n == 0) return;
    points_.evaluate(field);
    made.evaluated += points_.n;
    alignas(64) float values[kEdge * kEdge * kEdge];
    std::uint64_t active[8] = {};
    const float* next = points_.value;
    for (int b = 0; b < 8; ++b) {
      const bool skip = beyond(b);
      fill_block(b, skip ? nullptr : next, probe[b], values, active);
      if (!skip) next += kBlock * kBlock * kBlock;
    }
    const bool any = std::any_of(active, active + 8, [](std::uint64_t word) { return word != 0; });
    if (any) made.leaves.push_back(make_leaf(brick.lo, values, active));
    made.inside =
        made.inside || std::any_of(values, std::end(values), [](float v) { return v <= 0; });
  }

  void add_block(const Cube& block) {
    for (int x = 0; x < kBlock; ++x) {
      for (int y = 0; y < kBlock; ++y) {
        for (int z = 0; z < kBlock; ++z) points_.add(glm::dvec3(block.lo + glm::ivec3(x, y, z)));
      }
    }
  }

  // Block b of a brick from its values, or, without them, from the sign of its middle.
  void fill_block(int b, const float* from, float middle, float* values,
                  std::uint64_t* active) const {
    for (int i = 0; i < kBlock * kBlock * kBlock; ++i) {
      const float v = from != nullptr ? from[i] : middle;
      const bool outside = from != nullptr ? v >= out_ : middle > 0;
      const bool inside = from != nullptr ? v <= in_ : middle <= 0;
      const int x = (b >> 2 & 1) * kBlock + i / (kBlock * kBlock);
      const int y = (b >> 1 & 1) * kBlock + i / kBlock % kBlock;
      const int z = (b & 1) * kBlock + i % kBlock;
      const int place = (x * kEdge + y) * kEdge + z;
      values[place] = outside ? out_ : (inside ? in_ : v);
      if (!outside && !inside) active[place >> 6] |= std::uint64_t{1} << (place & 63);
    }
  }

  Lattice lattice_;
  const Job& job_;
  float out_, in_;
  Points points_;
};

// Where values may be within the band. Far from its surface a bound may be small: then the band
// ends at its width from the solid's box.
Box band_box(const Field& field, double width) {
  const Box solid = field.bounds();
  Box box = field.bounds(width);
  for (int a = 0; a < 3; ++a) {
    if (!std::isfinite(box.lo[a])) box.lo[a] = solid.lo[a] - width;
    if (!std::isfinite(box.hi[a])) box.hi[a] = solid.hi[a] + width;
  }
  return box;
}

// What a thread takes: a cube, with what is left of the program there.
struct Task {
  Field field;
  Cube cube;
};

// A cube of bricks that holds the box.
Cube cube_around(const Lattice& lattice, const Box& box) {
  const glm::dvec3 lo = glm::floor(lattice.to_index(box.lo) / double(kEdge));
  const glm::dvec3 size = lattice.to_index(box.hi) - lo * double(kEdge);
  Cube cube{glm::ivec3(lo) * kEdge, kTaskEdge};
  while (cube.edge <= std::max({size.x, size.y, size.z})) cube.edge *= 2;
  return cube;
}

// Divides space among tasks and puts together what they make.
class FieldConverter {
 public:
  FieldConverter(const Lattice& lattice, const FieldConvertOptions& options, const Job& job)
      : lattice_(lattice),
        options_(options),
        job_(job),
        allowed_(allowed_memory(options.max_memory)) {}

  FieldConversion run(const Field& field) {
    const Box box = band_box(field, options_.band.exwidth * lattice_.voxel);
    collect({field, cube_around(lattice_, box)});
    parts_.resize(tasks_.size());
    parallel_for("convert", tasks_.size(), 1, job_,
                 [&](std::size_t task, std::size_t) { run_task(task); });
    return assemble(field);
  }

 private:
  void collect(const Task& task) {
    if (task.cube.edge == kTaskEdge) {
      tasks_.push_back(task);
      return;
    }
    const Subdivision probe(lattice_, options_.band, job_);
    for (int i = 0; i < 8; ++i) {
      const Cube part = octant(task.cube, i);
      ++result_.regions;
      if (auto here = probe.within_band(task.field, part)) collect({std::move(*here), part});
    }
  }

  void run_task(std::size_t i) {
    Subdivision subdivision(lattice_, options_.band, job_);
    subdivision.run(tasks_[i].field, tasks_[i].cube);
    parts_[i] = std::move(subdivision.made);
    const double bytes = kLeafBytes * static_cast<double>(bricks_ += parts_[i].leaves.size());
    if (bytes <= allowed_) return;
    throw Error(ErrorKind::failed,
                fmt::format("the grid would take more than the {:.0f} MB that are allowed; use a "
                            "larger voxel, a narrower band, or a higher --max-memory",
                            1e-6 * allowed_));
  }

  FieldConversion assemble(const Field& field) {
    // What is thin may pass between the samples.
    const bool inside =
        std::any_of(parts_.begin(), parts_.end(), [](const Part& part) { return part.inside; });
    if (bricks_ == 0 || (!inside && is_surely_empty(field, job_))) throw nothing_in(field);
    const auto vdb = make_level_set(lattice_, options_.band);
    openvdb::tree::ValueAccessor<openvdb::FloatTree> accessor(vdb->tree());
    for (Part& part : parts_) {
      for (LeafPointer& leaf : part.leaves) accessor.addLeaf(leaf.release());
      result_.evaluated += part.evaluated;
      result_.regions += part.regions;
    }
    flood_interior(*vdb, static_cast<float>(options_.band.inwidth * lattice_.voxel));
    result_.grid = from_vdb(vdb);
    return std::move(result_);
  }

  Lattice lattice_;
  FieldConvertOptions options_;
  const Job& job_;
  double allowed_;
  std::vector<Task> tasks_;
  std::vector<Part> parts_;
  std::atomic<std::size_t> bricks_{0};
  FieldConversion result_;
};

}  // namespace

Lattice choose_lattice(const Field& field, const FieldConvertOptions& options) {
  const Box box = field.bounds();
  if (box.empty()) throw nothing_in(field);
  for (int a = 0; a < 3; ++a) {
    if (std::isfinite(box.lo[a]) && std::isfinite(box.hi[a])) continue;
    throw Error(ErrorKind::input, fmt::format("the solid has no end along {}; intersect it with a "
                                              "box",
                                              "xyz"[a]));
  }
  Lattice lattice;
  lattice.voxel = options.voxel;
  const glm::dvec3 size = box.size();
  if (lattice.voxel == 0) {
    if (options.dim < 1) throw Error(ErrorKind::usage, "--dim must be at least 1");
    lattice.voxel = std::max({size.x, size.y, size.z}) / options.dim;
  }
  if (!(std::isfinite(lattice.voxel) && lattice.voxel > 1e-30)) {
    throw Error(ErrorKind::usage, "the voxel size must be a positive number");
  }
  const glm::dvec3 far = glm::max(glm::abs(box.lo), glm::abs(box.hi)) / lattice.voxel;
  if (!(std::max({far.x, far.y, far.z}) < kMostVoxels)) {
    throw Error(ErrorKind::usage, "the voxel size is too small for the scene; use a larger one");
  }
  return lattice;
}

FieldConversion convert_field(const Field& field, const FieldConvertOptions& options,
                              const Job& job) {
  if (!(options.band.exwidth >= 1 && options.band.inwidth >= 1)) {
    throw Error(ErrorKind::usage, "a band must be at least 1 voxel wide");
  }
  const auto start = std::chrono::steady_clock::now();
  const Lattice lattice = choose_lattice(field, options);
  FieldConversion result = FieldConverter(lattice, options, job).run(field);
  result.seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
  return result;
}

}  // namespace sdfgrid
