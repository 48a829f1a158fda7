#include "sdfgrid/mesh/orient.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cstdint>
#include <glm/geometric.hpp>
#include <map>
#include <span>
#include <tuple>
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

// Which neighbours each triangle has, and whether they face the other way.
class Neighbours {
 public:
  explicit Neighbours(const TriangleSoup& soup) : links_(soup.triangles.size()) {
    std::vector<Use> uses;
    uses.reserve(3 * soup.triangles.size());
    for (std::uint32_t t = 0; t < soup.triangles.size(); ++t) {
      const glm::uvec3& v = soup.triangles[t];
      if (v.x == v.y || v.y == v.z || v.z == v.x) continue;  // has no edges
      for (int k = 0; k < 3; ++k) {
        const std::uint32_t from = v[k];
        const std::uint32_t to = v[(k + 1) % 3];
        uses.push_back({std::min(from, to), std::max(from, to), t, from < to});
      }
    }
    std::sort(uses.begin(), uses.end(), [](const Use& a, const Use& b) {
      return std::tie(a.lo, a.hi, a.triangle) < std::tie(b.lo, b.hi, b.triangle);
    });
    for (std::size_t first = 0, last = 0; first < uses.size(); first = last) {
      while (last < uses.size() && uses[last].lo == uses[first].lo &&
             uses[last].hi == uses[first].hi) {
        ++last;
      }
      if (last - first > 2) crowded_.push_back(uses[first].triangle);
      if (last - first == 2) join(uses[first], uses[first + 1]);
    }
  }

  struct Link {
    std::uint32_t triangle;
    bool against;  // it runs along the common edge in the same direction
  };
  [[nodiscard]] std::span<const Link> of(std::uint32_t t) const {
    return {links_[t].link.data(), links_[t].count};
  }
  // A triangle at each edge of more than two.
  [[nodiscard]] const std::vector<std::uint32_t>& crowded() const { return crowded_; }

 private:
  struct Use {
    std::uint32_t lo, hi, triangle;
    bool forward;
  };
  void join(const Use& a, const Use& b) {
    const bool against = a.forward == b.forward;
    links_[a.triangle].add({b.triangle, against});
    links_[b.triangle].add({a.triangle, against});
  }

  struct Three {
    std::array<Link, 3> link;
    std::size_t count = 0;
    void add(const Link& one) { link[count++] = one; }
  };
  std::vector<Three> links_;
  std::vector<std::uint32_t> crowded_;
};

// The triangles that neighbours reach from `first`, and whether each must be turned for all to
// agree with it; nothing if they cannot.
struct Agreement {
  std::vector<std::uint32_t> triangles;
  std::size_t turned = 0;
  bool possible = true;
};

Agreement agree_from(std::uint32_t first, const Neighbours& neighbours,
                     std::vector<std::int8_t>& turned) {
  Agreement part{{first}, 0, true};
  turned[first] = 0;
  for (std::size_t i = 0; i < part.triangles.size(); ++i) {
    const std::uint32_t t = part.triangles[i];
    for (const Neighbours::Link& link : neighbours.of(t)) {
      const auto wanted = static_cast<std::int8_t>(turned[t] != (link.against ? 1 : 0) ? 1 : 0);
      if (turned[link.triangle] < 0) {
        turned[link.triangle] = wanted;
        part.turned += static_cast<std::size_t>(wanted);
        part.triangles.push_back(link.triangle);
      }
      part.possible = part.possible && turned[link.triangle] == wanted;
    }
  }
  return part;
}

}  // namespace

std::size_t agree_with_neighbours(TriangleSoup& soup, const MeshDiagnosis& diagnosis) {
  const Neighbours neighbours(soup);
  std::vector<bool> left_alone(diagnosis.components, false);
  for (const std::uint32_t t : neighbours.crowded()) left_alone[diagnosis.component[t]] = true;
  std::vector<std::int8_t> turned(soup.triangles.size(), -1);
  std::size_t count = 0;
  for (std::uint32_t first = 0; first < soup.triangles.size(); ++first) {
    if (turned[first] >= 0 || left_alone[diagnosis.component[first]]) continue;
    const Agreement part = agree_from(first, neighbours, turned);
    if (!part.possible || part.turned == 0) continue;
    const bool fewer = 2 * part.turned <= part.triangles.size();
    for (const std::uint32_t t : part.triangles) {
      if ((turned[t] == 1) != fewer) continue;
      std::swap(soup.triangles[t].y, soup.triangles[t].z);
      ++count;
    }
  }
  return count;
}

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

Orientation orient_mesh(TriangleSoup& soup) {
  Orientation result{diagnose(soup), {}};
  MeshDiagnosis& diagnosis = result.diagnosis;
  std::vector<std::string>& warnings = result.warnings;
  if (!diagnosis.consistently_oriented()) {
    const std::size_t turned = agree_with_neighbours(soup, diagnosis);
    if (turned > 0) {
      diagnosis = diagnose(soup);
      warnings.push_back(
          fmt::format("{} triangles faced against their neighbours and were turned", turned));
    }
    if (!diagnosis.consistently_oriented()) {
      warnings.push_back(
          fmt::format("{} edges have triangles that face opposite ways and cannot "
                      "agree: inside is where the mesh winds around by more than "
                      "half, which may be wrong beside them",
                      diagnosis.flipped_neighbours));
    }
  }
  if (diagnosis.closed() && diagnosis.consistently_oriented()) {
    const std::vector<std::string> more = orient_closed_components(soup, diagnosis);
    warnings.insert(warnings.end(), more.begin(), more.end());
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
  return result;
}

}  // namespace sdfgrid
