// The winding number: points a second on one thread beside the direct sum over all triangles, in
// the same run, with its worst and rms difference from it.
//
//   winding_bench [MESH...] [--points=20000] [--direct=300]
//
// Without a mesh it runs on soups of its own. Points come in three clouds: "near", at most four
// samples of a lattice of 512 off the surface, sorted by place as a converter visits them; "box",
// anywhere in the bounding box and a tenth around; "far", half to a hundred sizes away.
#include <fmt/format.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <functional>
#include <string>
#include <tuple>
#include <vector>

#include "../tests/property/random_meshes.h"
#include "../tests/winding/direct_sum.h"
#include "sdfgrid/core/isa.h"
#include "sdfgrid/core/parallel.h"
#include "sdfgrid/mesh/read.h"
#include "sdfgrid/mesh/winding.h"

namespace sdfgrid::bench {
namespace {

struct Settings {
  std::vector<std::string> meshes;
  std::size_t points = 20000;
  std::size_t direct = 300;
};

Settings parse(int count, char** words) {
  Settings settings;
  for (int i = 1; i < count; ++i) {
    const std::string word = words[i];
    const std::string value = word.substr(word.find('=') + 1);
    if (word.starts_with("--points=")) {
      settings.points = std::stoul(value);
    } else if (word.starts_with("--direct=")) {
      settings.direct = std::stoul(value);
    } else {
      settings.meshes.push_back(word);
    }
  }
  return settings;
}

double seconds(const std::function<void()>& work) {
  const auto start = std::chrono::steady_clock::now();
  work();
  return std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
}

struct Cloud {
  const char* name;
  std::vector<glm::dvec3> points;
};

glm::dvec3 near_point(const TriangleSoup& soup, double spacing, shapes::Random& random) {
  const int last = static_cast<int>(soup.triangles.size()) - 1;
  const glm::uvec3 t = soup.triangles[static_cast<std::size_t>(random.integer(0, last))];
  const double u = std::sqrt(random.unit());
  const double v = u * random.unit();
  const glm::dvec3 p =
      (1.0 - u) * soup.local(t.x) + (u - v) * soup.local(t.y) + v * soup.local(t.z);
  return p + random.range(0.1, 4.0) * spacing * random.direction();
}

// By bricks of eight samples, as a converter goes.
void sort_by_place(std::vector<glm::dvec3>& points, const glm::dvec3& lo, double spacing) {
  const auto brick = [&](const glm::dvec3& p) { return glm::ivec3((p - lo) / (8.0 * spacing)); };
  std::sort(points.begin(), points.end(), [&](const glm::dvec3& p, const glm::dvec3& q) {
    const glm::ivec3 a = brick(p);
    const glm::ivec3 b = brick(q);
    return std::tie(a.x, a.y, a.z) < std::tie(b.x, b.y, b.z);
  });
}

std::vector<Cloud> clouds(const TriangleSoup& soup, std::size_t count) {
  shapes::Random random(1);
  Box box = bounds(soup);
  box.lo -= soup.origin;
  box.hi -= soup.origin;
  const double size = std::max({box.size().x, box.size().y, box.size().z});
  std::vector<Cloud> result = {{"near", {}}, {"box", {}}, {"far", {}}};
  for (std::size_t i = 0; i < count; ++i) {
    result[0].points.push_back(near_point(soup, size / 512.0, random));
    result[1].points.push_back(random.in_box(box.lo - 0.1 * size, box.hi + 0.1 * size));
    const double away = size * std::pow(10.0, random.range(-0.3, 2.0));
    result[2].points.push_back(box.center() + away * random.direction());
  }
  sort_by_place(result[0].points, box.lo - 0.1 * size, size / 512.0);
  return result;
}

void measure(const std::string& name, const TriangleSoup& soup, const Settings& settings) {
  WindingNumber winding(soup);
  const double build = seconds([&] { winding = WindingNumber(soup); });
  const Box box = bounds(soup);
  const double spacing = std::max({box.size().x, box.size().y, box.size().z}) / 512.0;
  for (const Cloud& cloud : clouds(soup, settings.points)) {
    std::vector<double> values(cloud.points.size());
    double fast = 1e300;  // the least disturbed of five
    for (int i = 0; i < 5; ++i) {
      fast = std::min(fast, seconds([&] { winding.at(cloud.points, values); }));
    }
    const std::size_t step = std::max<std::size_t>(cloud.points.size() / settings.direct, 1);
    double worst = 0.0;
    double squares = 0.0;
    std::size_t sampled = 0;
    const double direct = seconds([&] {
      for (std::size_t i = 0; i < cloud.points.size(); i += step, ++sampled) {
        const double error = std::abs(values[i] - direct_winding(soup, cloud.points[i]));
        worst = std::max(worst, error);
        squares += error * error;
      }
    });
    // What a converter asks: may the winding number change by a half within 20 samples?
    std::size_t yes = 0;
    const double bound = seconds([&] {
      for (std::size_t i = 0; i < cloud.points.size(); i += step) {
        yes +=
            winding.gradient_below(cloud.points[i], 7.0 * spacing, 0.5 / (20.0 * spacing)) ? 1 : 0;
      }
    });
    const double n = static_cast<double>(sampled);
    const double points_a_second = static_cast<double>(cloud.points.size()) / fast;
    fmt::print(
        "{:<26} {:>9} {:>8.1f} {:>5} {:>9.3f} {:>11.0f} {:>8.0f} {:>9.1e} {:>9.1e} {:>8.2f} "
        "{:>5.0f}\n",
        name, soup.triangles.size(), 1e3 * build, cloud.name, 1e-6 * points_a_second, n / direct,
        points_a_second * direct / n, worst, std::sqrt(squares / n), 1e6 * bound / n,
        100.0 * static_cast<double>(yes) / n);
  }
}

int run(const Settings& settings) {
  const ThreadLimit one(1);
  fmt::print("winding number, one thread, {}; tolerance {}\n", isa_name(active_isa()),
             WindingNumber::tolerance());
  fmt::print("{:<26} {:>9} {:>8} {:>5} {:>9} {:>11} {:>8} {:>9} {:>9} {:>8} {:>5}\n", "soup",
             "triangles", "build ms", "cloud", "Mpoint/s", "direct p/s", "times", "worst", "rms",
             "below us", "% yes");
  for (const std::string& path : settings.meshes) {
    measure(path.substr(path.find_last_of('/') + 1), read_mesh(path, Job()).soup, settings);
  }
  if (!settings.meshes.empty()) return 0;
  const TriangleSoup sphere = shapes::icosphere(6, 1.0);
  measure("sphere", sphere, settings);
  measure("sphere with a hole", shapes::with_hole(sphere, 1000, 3000), settings);
  measure("nested shells", shapes::nested_shells(5, 1.0, 0.5), settings);
  measure("1000 random triangles", shapes::random_triangles(1000, 1), settings);
  measure("100000 random triangles", shapes::random_triangles(100000, 2, 0.02), settings);
  return 0;
}

}  // namespace
}  // namespace sdfgrid::bench

int main(int count, char** words) {
  return sdfgrid::bench::run(sdfgrid::bench::parse(count, words));
}
