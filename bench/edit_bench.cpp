// Sculpting: dabs and strokes of the Sculptor beside OpenVDB's in-place csgUnion and csgDifference,
// all in one run, repetitions interleaved, medians. Times are the process's CPU time, which other
// work on the machine hardly changes; those of strokes are given by the clock, too: of each stroke
// the least of five tries.
//
//   edit_bench MESH [--dims=512,1024] [--dabs=60]
//
// A dab is a ball of radius 10 voxels at a point of the surface. OpenVDB's time includes the making
// of the ball's level set; ours the refreshing of the atlas that rays are traced in. Dabs are taken
// at places far from each other, ours and OpenVDB's by turns, so that each finds its memory and its
// code out of the caches; and along paths, as a hand makes them, each program by itself.
#include <fmt/format.h>
#include <openvdb/tools/Composite.h>
#include <openvdb/tools/LevelSetSphere.h>

#include <algorithm>
#include <chrono>
#include <ctime>
#include <glm/geometric.hpp>
#include <numeric>
#include <random>
#include <sstream>
#include <string>
#include <vector>

#include "sdfgrid/core/isa.h"
#include "sdfgrid/core/parallel.h"
#include "sdfgrid/edit/field_brush.h"
#include "sdfgrid/edit/sculptor.h"
#include "sdfgrid/field/field.h"
#include "sdfgrid/grid/convert.h"
#include "sdfgrid/grid/live_atlas.h"
#include "sdfgrid/grid/vdb.h"
#include "sdfgrid/mesh/read.h"

namespace sdfgrid::bench {
namespace {

double median(std::vector<double> values) {
  std::nth_element(values.begin(), values.begin() + static_cast<long>(values.size() / 2),
                   values.end());
  return values[values.size() / 2];
}

double sum(const std::vector<double>& values) {
  return std::accumulate(values.begin(), values.end(), 0.0);
}

// Of CPU time: of all threads, or (CLOCK_THREAD_CPUTIME_ID) of the one that calls.
template <class Work>
double milliseconds(const Work& work, clockid_t clock = CLOCK_PROCESS_CPUTIME_ID) {
  const auto now = [&] {
    timespec t{};
    clock_gettime(clock, &t);
    return 1e3 * static_cast<double>(t.tv_sec) + 1e-6 * static_cast<double>(t.tv_nsec);
  };
  const double start = now();
  work();
  return now() - start;
}

template <class Work>
double clock_milliseconds(const Work& work) {
  const auto start = std::chrono::steady_clock::now();
  work();
  return 1e3 * std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
}

// Points of the mesh, in a fixed order that looks random.
std::vector<glm::dvec3> places(const TriangleSoup& soup, int count) {
  std::mt19937 random(1);
  std::vector<glm::dvec3> points;
  points.reserve(static_cast<std::size_t>(count));
  for (int i = 0; i < count; ++i) {
    points.push_back(soup.origin + glm::dvec3(soup.points[random() % soup.points.size()]));
  }
  return points;
}

Stroke dab(StrokeOp op, const glm::dvec3& at, double radius) {
  Stroke stroke;
  stroke.op = op;
  stroke.brush.radius = radius;
  stroke.path = {{at}};
  return stroke;
}

void openvdb_dab(openvdb::FloatGrid& grid, StrokeOp op, const glm::dvec3& at, double radius) {
  const auto ball = openvdb::tools::createLevelSetSphere<openvdb::FloatGrid>(
      static_cast<float>(radius), openvdb::Vec3f(openvdb::Vec3d(at.x, at.y, at.z)),
      static_cast<float>(grid.voxelSize().x()));
  if (op == StrokeOp::unite) {
    openvdb::tools::csgUnion(grid, *ball);
  } else {
    openvdb::tools::csgDifference(grid, *ball);
  }
}

struct Times {
  std::vector<double> peer, edit, refresh, total, remeasured, remeasured_total, ratio;
};

// One dab each way, from the same model: ours is undone, OpenVDB works on.
void time_dab(Sculptor& plain, Sculptor& remeasuring, LiveAtlas& atlas, openvdb::FloatGrid& peer,
              const Stroke& stroke, Times& times) {
  const Job job;
  times.peer.push_back(
      milliseconds([&] { openvdb_dab(peer, stroke.op, stroke.path[0].at, stroke.brush.radius); }));
  times.edit.push_back(milliseconds([&] { (void)plain.apply(stroke, job); }));
  times.refresh.push_back(milliseconds([&] { atlas.refresh(plain.touched(), job); }));
  times.total.push_back(times.edit.back() + times.refresh.back());
  times.ratio.push_back(times.peer.back() / times.total.back());
  plain.undo();
  atlas.refresh(plain.touched(), job);
  times.remeasured.push_back(milliseconds([&] { (void)remeasuring.apply(stroke, job); }));
  times.remeasured_total.push_back(times.remeasured.back() + times.refresh.back());
  remeasuring.undo();
}

void measure_dabs(const Grid& grid, const TriangleSoup& soup, int dim, int dabs) {
  const ThreadLimit one(1);
  const double voxel = grid.lattice().voxel;
  SculptOptions off;
  off.redistance = Redistance::off;
  Sculptor plain(grid, off);
  Sculptor remeasuring(grid.clone());
  LiveAtlas atlas(grid, Job());
  const Grid peer = grid.clone();
  for (const StrokeOp op : {StrokeOp::unite, StrokeOp::subtract}) {
    Times times;
    for (const glm::dvec3& at : places(soup, dabs)) {
      time_dab(plain, remeasuring, atlas, *vdb(peer), dab(op, at, 10 * voxel), times);
    }
    fmt::print(
        "  dim {:5} {:10}: OpenVDB {:.3f} ms; edit {:.4f} + atlas {:.4f} = {:.4f} ms, ratio "
        "{:.1f}; with local re-distancing {:.3f} ms\n",
        dim, stroke_op_word(op), median(times.peer), median(times.edit), median(times.refresh),
        median(times.total), median(times.ratio), median(times.remeasured_total));
  }
}

struct FieldBrush {
  const char* name;
  Field field;  // as large as a ball of radius 1, or nearly
  bool exact;
};

std::vector<FieldBrush> field_brushes() {
  const Field star = make_field("union", {},
                                {make_field("box", {{"size", {1.8, 0.5, 1.8}}}),
                                 make_field("box", {{"size", {0.5, 1.8, 1.8}}})});
  const Field wavy =
      make_field("formula", {{"f", "x^2 + y^2 + z^2 + 0.1 * sin(5 * x) * cos(5 * y) - 0.8"},
                             {"bounds", {-1, -1, -1, 1, 1, 1}}});
  return {{"box", make_field("box", {{"size", {1.6, 1.6, 1.6}}}), true},
          {"twisted star", make_field("twist", {{"turns", 0.25}}, {star}), false},
          {"formula", wavy, false}};
}

// Brushes that are fields beside the ball: the same dabs, without re-distancing.
void measure_fields(const Grid& grid, const TriangleSoup& soup, int dim, int dabs) {
  const ThreadLimit one(1);
  const double radius = 10 * grid.lattice().voxel;
  SculptOptions off;
  off.redistance = Redistance::off;
  Sculptor sculptor(grid.clone(), off);
  const auto time = [&](const Stroke& stroke) {
    const double t = milliseconds([&] { (void)sculptor.apply(stroke, Job()); });
    sculptor.undo();
    return t;
  };
  for (const FieldBrush& brush : field_brushes()) {
    const auto shape =
        make_brush(make_field("scale", {{"by", radius}}, {brush.field}), brush.exact);
    std::vector<double> ball;
    std::vector<double> field;
    std::vector<double> ratio;
    for (const glm::dvec3& at : places(soup, dabs)) {
      Stroke stroke = dab(StrokeOp::subtract, at, radius);
      ball.push_back(time(stroke));
      stroke.brush.shape = shape;
      field.push_back(time(stroke));
      ratio.push_back(field.back() / ball.back());
    }
    fmt::print("  dim {:5} difference with a {:12}: {:.3f} ms, {:.1f} times a ball's {:.4f} ms\n",
               dim, brush.name, median(field), median(ratio), median(ball));
  }
}

// A path over the surface whose points are `step` apart: from vertex to vertex of the mesh, as a
// hand would go.
std::vector<PathPoint> walk(const TriangleSoup& soup, std::size_t start, double step, int points) {
  std::vector<PathPoint> path = {{soup.origin + glm::dvec3(soup.points[start])}};
  glm::dvec3 heading(1, 0.3, 0.2);
  while (static_cast<int>(path.size()) < points) {
    const glm::dvec3 goal = path.back().at + step * glm::normalize(heading);
    double best = 1e300;
    glm::dvec3 next = goal;
    for (const glm::vec3& p : soup.points) {
      const glm::dvec3 q = soup.origin + glm::dvec3(p);
      const double d = glm::length(q - goal);
      if (d < best && glm::length(q - path.back().at) > 0.5 * step) {
        best = d;
        next = q;
      }
    }
    heading = 0.8 * glm::normalize(heading) + 0.2 * glm::normalize(next - path.back().at);
    path.push_back({path.back().at + step * glm::normalize(next - path.back().at)});
  }
  return path;
}

// Dabs 5 voxels apart, one path after the other, from the same model; all are left standing.
void measure_paths(const Grid& grid, const TriangleSoup& soup, int dim, int dabs) {
  const ThreadLimit one(1);
  const double voxel = grid.lattice().voxel;
  constexpr int kOfPath = 60;
  for (const StrokeOp op : {StrokeOp::unite, StrokeOp::subtract}) {
    std::mt19937 random(7);
    std::vector<PathPoint> points;
    while (static_cast<int>(points.size()) < dabs) {
      const auto path = walk(soup, random() % soup.points.size(), 5 * voxel, kOfPath);
      points.insert(points.end(), path.begin(), path.end());
    }
    SculptOptions off;
    off.redistance = Redistance::off;
    Sculptor sculptor(grid.clone(), off);
    LiveAtlas atlas(sculptor.grid(), Job());
    std::vector<double> ours;
    for (const PathPoint& point : points) {
      const Stroke stroke = dab(op, point.at, 10 * voxel);
      ours.push_back(milliseconds([&] {
        (void)sculptor.apply(stroke, Job());
        atlas.refresh(sculptor.touched(), Job());
      }));
    }
    const Grid peer = grid.clone();
    std::vector<double> theirs;
    for (const PathPoint& point : points) {
      theirs.push_back(milliseconds([&] { openvdb_dab(*vdb(peer), op, point.at, 10 * voxel); }));
    }
    fmt::print(
        "  dim {:5} {:10} along paths: OpenVDB {:.3f} ms; edit and atlas {:.4f} ms, ratio of "
        "the medians {:.1f}, of the sums {:.1f}\n",
        dim, stroke_op_word(op), median(theirs), median(ours), median(theirs) / median(ours),
        sum(theirs) / sum(ours));
  }
}

void measure_strokes(const Grid& grid, const TriangleSoup& soup, int dim) {
  const double voxel = grid.lattice().voxel;
  Sculptor sculptor(grid.clone());
  LiveAtlas atlas(sculptor.grid(), Job());
  std::mt19937 random(7);
  constexpr int kStrokes = 15;
  constexpr int kClockTries = 5;  // of which the least counts: other work on the machine adds to it
  for (const int threads : {1, 2}) {
    const ThreadLimit limit(threads);
    for (const StrokeOp op : {StrokeOp::unite, StrokeOp::subtract}) {
      std::vector<double> clock;
      std::vector<double> apply;
      std::vector<double> caller;
      std::vector<double> refresh;
      std::vector<double> undo;
      double memory = 0;
      for (int i = 0; i < kStrokes; ++i) {
        Stroke stroke = dab(op, {}, 20 * voxel);
        stroke.path = walk(soup, random() % soup.points.size(), 5 * voxel, 60);
        StrokeReport report;
        double least = clock_milliseconds([&] {
          apply.push_back(milliseconds([&] {
            caller.push_back(milliseconds([&] { report = sculptor.apply(stroke, Job()); },
                                          CLOCK_THREAD_CPUTIME_ID));
          }));
        });
        for (int again = 1; again < kClockTries; ++again) {
          sculptor.undo();
          least = std::min(least, clock_milliseconds([&] { (void)sculptor.apply(stroke, Job()); }));
        }
        clock.push_back(least);
        const auto bytes = static_cast<double>(sculptor.history().bytes());  // of this stroke alone
        memory = std::max(memory, bytes / (static_cast<double>(report.bricks_touched) * 2112));
        refresh.push_back(milliseconds([&] { atlas.refresh(sculptor.touched(), Job()); }));
        undo.push_back(milliseconds([&] { sculptor.undo(); }));
        atlas.refresh(sculptor.touched(), Job());
      }
      fmt::print(
          "  dim {:5} stroke of 60 dabs, radius 20, {:10}, {} thread(s): with local re-distancing "
          "{:.2f} ms of CPU ({:.2f} of them the calling thread's), {:.2f} ms by the clock; atlas "
          "{:.2f} ms of CPU, undo {:.2f} ms, "
          "memory "
          "{:.2f} x the bricks\n",
          dim, stroke_op_word(op), threads, median(apply), median(caller), median(clock),
          median(refresh), median(undo), memory);
    }
  }
}

}  // namespace
}  // namespace sdfgrid::bench

int main(int count, char** words) {
  using namespace sdfgrid;
  std::string mesh;
  std::vector<int> dims = {512, 1024};
  int dabs = 60;
  for (int i = 1; i < count; ++i) {
    const std::string word = words[i];
    const auto value = word.substr(word.find('=') + 1);
    if (word.starts_with("--dims=")) {
      dims.clear();
      std::stringstream list(value);
      for (std::string dim; std::getline(list, dim, ',');) dims.push_back(std::stoi(dim));
    } else if (word.starts_with("--dabs=")) {
      dabs = std::stoi(value);
    } else {
      mesh = word;
    }
  }
  if (mesh.empty()) {
    fmt::print(stderr, "usage: edit_bench MESH [--dims=512,1024] [--dabs=60]\n");
    return 2;
  }
  fmt::print("instruction set: {}\n", isa_name(active_isa()));
  const TriangleSoup soup = read_mesh(mesh, Job()).soup;
  for (const int dim : dims) {
    ConvertOptions options;
    options.dim = dim;
    const Grid grid = convert_mesh(soup, options, Job()).grid;
    bench::measure_dabs(grid, soup, dim, dabs);
    bench::measure_paths(grid, soup, dim, 3 * dabs);
    bench::measure_fields(grid, soup, dim, dabs);
    bench::measure_strokes(grid, soup, dim);
  }
  return 0;
}
