#include "sdfgrid/mesh/orient.h"

#include <fmt/format.h>

#include <algorithm>
#include <glm/geometric.hpp>
#include <map>
#include <utility>

#include "sdfgrid/mesh/piercing.h"

namespace sdfgrid {
namespace {

// Triangles of a component whose centres are tried against other components.
constexpr std::size_t kSamples = 8;

struct Components {
  std::vector<std::vector<std::uint32_t>> samples;  // triangles of each, evenly spaced
  std::vector<double> volume;                       // signed
};

glm::dvec3 middle(const TriangleSoup& soup, const glm::uvec3& t) {
  return (soup.local(t.x) + soup.local(t.y) + soup.local(t.z)) / 3.0;
}

Components measure(const TriangleSoup& soup, const MeshDiagnosis& diagnosis) {
  Components result;
  result.samples.resize(diagnosis.components);
  result.volume.resize(diagnosis.components, 0.0);
  std::vector<std::size_t> size(diagnosis.components, 0);
  std::vector<std::size_t> seen(diagnosis.components, 0);
  std::vector<glm::dvec3> base(diagnosis.components);
  for (std::size_t t = 0; t < soup.triangles.size(); ++t) {
    const std::uint32_t c = diagnosis.component[t];
    if (size[c]++ == 0) base[c] = soup.local(soup.triangles[t].x);
  }
  for (std::size_t t = 0; t < soup.triangles.size(); ++t) {
    const std::uint32_t c = diagnosis.component[t];
    const glm::uvec3& corner = soup.triangles[t];
    const glm::dvec3 p = soup.local(corner.x) - base[c];
    result.volume[c] +=
        glm::dot(p, glm::cross(soup.local(corner.y) - base[c], soup.local(corner.z) - base[c])) /
        6.0;
    const std::size_t step = (size[c] + kSamples - 1) / kSamples;
    if (seen[c]++ % step == 0) result.samples[c].push_back(static_cast<std::uint32_t>(t));
  }
  return result;
}

// How many components wind round every sample of component c.
std::size_t depth_of(const TriangleSoup& soup, const MeshDiagnosis& diagnosis,
                     const Piercing& piercing, const Components& components, std::uint32_t c) {
  std::map<std::uint32_t, std::size_t> around;  // component: samples that it winds round
  for (const std::uint32_t sample : components.samples[c]) {
    const glm::dvec3 p = middle(soup, soup.triangles[sample]);
    std::map<std::uint32_t, int> winding;
    piercing.along_x(p.y, p.z, [&](std::uint32_t t, double x, int direction) {
      const std::uint32_t other = diagnosis.component[t];
      if (other != c && x > p.x) winding[other] += direction;
    });
    for (const auto& [other, turns] : winding) {
      if (turns != 0) ++around[other];
    }
  }
  return static_cast<std::size_t>(std::count_if(around.begin(), around.end(), [&](const auto& a) {
    return a.second == components.samples[c].size();
  }));
}

// Whether each component must be turned.
std::vector<bool> find_turned(const TriangleSoup& soup, const MeshDiagnosis& diagnosis) {
  const Components components = measure(soup, diagnosis);
  std::vector<bool> turned(diagnosis.components, false);
  if (diagnosis.components == 1) {
    turned[0] = components.volume[0] < 0.0;
    return turned;
  }
  const Piercing piercing(soup);
  for (std::uint32_t c = 0; c < diagnosis.components; ++c) {
    const bool inward = depth_of(soup, diagnosis, piercing, components, c) % 2 == 1;
    turned[c] = inward ? components.volume[c] > 0.0 : components.volume[c] < 0.0;
  }
  return turned;
}

// Six times the volume under the triangles, seen from the centre of the bounds: its sign says which
// way most of a nearly closed mesh faces.
double facing(const TriangleSoup& soup) {
  const glm::dvec3 center = bounds(soup).center() - soup.origin;
  double sum = 0;
  for (const glm::uvec3& t : soup.triangles) {
    sum += glm::dot(soup.local(t.x) - center,
                    glm::cross(soup.local(t.y) - center, soup.local(t.z) - center));
  }
  return sum;
}

void turn(TriangleSoup& soup) {
  for (glm::uvec3& t : soup.triangles) std::swap(t.y, t.z);
}

}  // namespace

std::vector<std::string> orient_closed_components(TriangleSoup& soup,
                                                  const MeshDiagnosis& diagnosis) {
  if (!diagnosis.closed() || !diagnosis.consistently_oriented()) return {};
  const std::vector<bool> turned = find_turned(soup, diagnosis);
  const auto count = static_cast<std::size_t>(std::count(turned.begin(), turned.end(), true));
  if (count == 0) return {};
  for (std::size_t t = 0; t < soup.triangles.size(); ++t) {
    if (turned[diagnosis.component[t]]) std::swap(soup.triangles[t].y, soup.triangles[t].z);
  }
  if (diagnosis.components == 1) return {"turned the mesh: it was inside out"};
  return {
      fmt::format("turned {} of {} closed components, so that outer shells face outward and "
                  "shells in shells inward",
                  count, diagnosis.components)};
}

std::vector<std::string> orient_mesh(TriangleSoup& soup, const MeshDiagnosis& diagnosis) {
  std::vector<std::string> warnings;
  if (diagnosis.closed() && diagnosis.consistently_oriented()) {
    warnings = orient_closed_components(soup, diagnosis);
  } else if (facing(soup) < 0) {
    turn(soup);
    warnings.emplace_back("most of the mesh faces inward; it was turned inside out");
  }
  if (diagnosis.boundary_edges > 0) {
    warnings.push_back(
        fmt::format("the mesh is open ({} boundary edges): inside is where it winds around by more "
                    "than half, and wide holes get a rough cap; of an open sheet or terrain only "
                    "unsigned distances make sense",
                    diagnosis.boundary_edges));
  }
  return warnings;
}

}  // namespace sdfgrid
