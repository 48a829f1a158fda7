#include "sdfgrid/mesh/diagnose.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <functional>
#include <glm/geometric.hpp>
#include <iterator>
#include <limits>
#include <numeric>

#include "sdfgrid/core/parallel.h"

namespace sdfgrid {
namespace {

bool collapsed(const glm::uvec3& t) { return t.x == t.y || t.y == t.z || t.z == t.x; }

// Items in groups by a small number, in their order within a group (a counting sort).
template <class Item>
class Groups {
 public:
  // for_each(visit) must call visit(group, item) for every item, the same way each time it is
  // called.
  template <class ForEach>
  Groups(std::size_t groups, ForEach for_each) : first_(groups + 1, 0) {
    for_each([&](std::uint32_t group, const Item&) { ++first_[group + 1]; });
    std::partial_sum(first_.begin(), first_.end(), first_.begin());
    items_.resize(first_.back());
    std::vector<std::size_t> next(first_.begin(), first_.end() - 1);
    for_each([&](std::uint32_t group, const Item& item) { items_[next[group]++] = item; });
  }
  [[nodiscard]] std::size_t size() const { return first_.size() - 1; }
  Item* begin(std::size_t group) { return items_.data() + first_[group]; }
  Item* end(std::size_t group) { return items_.data() + first_[group + 1]; }

 private:
  std::vector<std::size_t> first_;
  std::vector<Item> items_;
};

// One triangle's use of an edge; the group is the edge's lower point.
struct EdgeUse {
  std::uint32_t high;  // the edge's higher point
  std::uint32_t triangle;
  bool upward;  // whether the triangle runs from the lower point to the higher
};

class UnionFind {
 public:
  explicit UnionFind(std::size_t size) : parent_(size) {
    std::iota(parent_.begin(), parent_.end(), 0U);
  }
  std::uint32_t find(std::uint32_t i) {
    while (parent_[i] != i) {
      parent_[i] = parent_[parent_[i]];
      i = parent_[i];
    }
    return i;
  }
  // The lower number stays the root, so that roots come in the order of first appearance.
  void join(std::uint32_t a, std::uint32_t b) {
    a = find(a);
    b = find(b);
    parent_[std::max(a, b)] = std::min(a, b);
  }

 private:
  std::vector<std::uint32_t> parent_;
};

void count_edge(const EdgeUse* first, const EdgeUse* last, MeshDiagnosis& result) {
  ++result.edges;
  const auto uses = last - first;
  if (uses == 1) ++result.boundary_edges;
  if (uses > 2) ++result.nonmanifold_edges;
  if (uses == 2 && first[0].upward == first[1].upward) ++result.flipped_neighbours;
}

UnionFind count_edges(const TriangleSoup& soup, MeshDiagnosis& result) {
  Groups<EdgeUse> uses(soup.points.size(), [&](auto visit) {
    for (std::uint32_t t = 0; t < soup.triangles.size(); ++t) {
      const glm::uvec3& corner = soup.triangles[t];
      if (collapsed(corner)) continue;
      for (int k = 0; k < 3; ++k) {
        const std::uint32_t a = corner[k];
        const std::uint32_t b = corner[(k + 1) % 3];
        visit(std::min(a, b), EdgeUse{std::max(a, b), t, a < b});
      }
    }
  });
  UnionFind connected(soup.triangles.size());
  for (std::size_t low = 0; low < uses.size(); ++low) {
    EdgeUse* const end = uses.end(low);
    std::sort(uses.begin(low), end, [](const EdgeUse& a, const EdgeUse& b) {
      return a.high != b.high ? a.high < b.high : a.triangle < b.triangle;
    });
    for (EdgeUse* first = uses.begin(low); first != end;) {
      EdgeUse* last = first + 1;
      while (last != end && last->high == first->high) {
        connected.join(first->triangle, last->triangle);
        ++last;
      }
      count_edge(first, last, result);
      first = last;
    }
  }
  return connected;
}

void number_components(UnionFind& connected, MeshDiagnosis& result) {
  result.component.resize(result.triangles);
  for (std::uint32_t t = 0; t < result.triangles; ++t) {
    const std::uint32_t root = connected.find(t);
    result.component[t] =
        root == t ? static_cast<std::uint32_t>(result.components++) : result.component[root];
  }
}

void count_duplicates(const TriangleSoup& soup, MeshDiagnosis& result) {
  using Pair = std::pair<std::uint32_t, std::uint32_t>;  // a triangle's middle and highest point
  Groups<Pair> faces(soup.points.size(), [&](auto visit) {
    for (const glm::uvec3& t : soup.triangles) {
      std::array<std::uint32_t, 3> corner{t.x, t.y, t.z};
      std::sort(corner.begin(), corner.end());
      visit(corner[0], Pair{corner[1], corner[2]});
    }
  });
  std::size_t duplicates = 0;
  for (std::size_t low = 0; low < faces.size(); ++low) {
    std::sort(faces.begin(low), faces.end(low));
    for (const Pair* face = faces.begin(low); face != faces.end(low); ++face) {
      if (face != faces.begin(low) && face[0] == face[-1]) ++duplicates;
    }
  }
  result.duplicate_faces = duplicates;
}

void measure(const TriangleSoup& soup, MeshDiagnosis& result) {
  // Volume is summed from the middle of the box, where the terms are smallest.
  const glm::dvec3 middle =
      result.bounds.empty() ? glm::dvec3(0.0) : result.bounds.center() - soup.origin;
  std::size_t flat = 0;
  double area = 0;
  double volume = 0;
  for (const glm::uvec3& t : soup.triangles) {
    const glm::dvec3 a = soup.local(t.x) - middle;
    const glm::dvec3 b = soup.local(t.y) - middle;
    const glm::dvec3 c = soup.local(t.z) - middle;
    const glm::dvec3 normal = glm::cross(b - a, c - a);
    const double doubled = glm::length(normal);
    const double longest =
        std::max({glm::dot(b - a, b - a), glm::dot(c - b, c - b), glm::dot(a - c, a - c)});
    if (doubled <= 8.0 * std::numeric_limits<double>::epsilon() * longest) ++flat;
    area += 0.5 * doubled;
    volume += glm::dot(a, normal) / 6.0;
  }
  result.zero_area_faces = flat;
  result.area = area;
  result.volume = volume;
}

std::size_t used_points(const TriangleSoup& soup) {
  std::vector<bool> used(soup.points.size(), false);
  for (const glm::uvec3& t : soup.triangles) {
    for (int k = 0; k < 3; ++k) used[t[k]] = true;
  }
  return static_cast<std::size_t>(std::count(used.begin(), used.end(), true));
}

}  // namespace

MeshDiagnosis diagnose(const TriangleSoup& soup) {
  MeshDiagnosis result;
  result.triangles = soup.triangles.size();
  result.points = used_points(soup);
  result.bounds = bounds(soup);
  // Each pass has members of the result to itself; the first takes as long as the others together.
  const std::function<void()> passes[] = {
      [&] {
        UnionFind connected = count_edges(soup, result);
        number_components(connected, result);
      },
      [&] { count_duplicates(soup, result); },
      [&] { measure(soup, result); },
  };
  parallel_for(std::size(passes), 1, Job(), [&](std::size_t pass, std::size_t) { passes[pass](); });
  return result;
}

}  // namespace sdfgrid
