#include "sdfgrid/voxelize/node_bins.h"

#include <algorithm>
#include <cmath>
#include <glm/common.hpp>
#include <glm/geometric.hpp>
#include <unordered_map>

#include "sdfgrid/core/error.h"
#include "sdfgrid/core/parallel.h"

namespace sdfgrid {
namespace {

constexpr double kSlack = 1e-3;  // voxels; culling must not fail by rounding
constexpr double kFlat = 1e-6;   // voxels
constexpr double kLargestIndex = 1e8;

// From the centre of a block of `edge` samples a side to its furthest sample.
double block_radius(int edge) { return 0.5 * (edge - 1) * std::sqrt(3.0); }

glm::dvec3 any_perpendicular(const glm::dvec3& u) {
  const glm::dvec3 axis = std::abs(u.x) < 0.6 ? glm::dvec3(1, 0, 0) : glm::dvec3(0, 1, 0);
  return glm::normalize(glm::cross(u, axis));
}

void set_function(TriangleRecord& r, int f, const glm::dvec3& g, const glm::dvec3& zero) {
  r.gx[f] = g.x;
  r.gy[f] = g.y;
  r.gz[f] = g.z;
  r.k[f] = -glm::dot(g, zero);
}

void set_edge(TriangleRecord& r, int edge, const glm::dvec3& from, const glm::dvec3& along,
              double length, const glm::dvec3& normal) {
  set_function(r, 1 + edge, along, from);
  set_function(r, 4 + edge, glm::cross(normal, along), from);
  r.length[edge] = length;
}

// The triangle is its longest edge, run forth, back and forth: no point is inside all three.
void set_segment(TriangleRecord& r, const glm::dvec3& from, const glm::dvec3& to) {
  const double length = glm::distance(from, to);
  const glm::dvec3 along = length > 0 ? (to - from) / length : glm::dvec3(1, 0, 0);
  const glm::dvec3 normal = any_perpendicular(along);
  set_function(r, 0, normal, from);
  set_edge(r, 0, from, along, length, normal);
  set_edge(r, 1, to, -along, length, normal);
  set_edge(r, 2, from, along, length, normal);
}

struct Extent {
  glm::dvec3 lo, hi;
};

Extent extent(const glm::dvec3 c[3]) {
  return {glm::min(c[0], glm::min(c[1], c[2])), glm::max(c[0], glm::max(c[1], c[2]))};
}

struct BlockRange {
  glm::ivec3 lo, hi;  // inclusive
};

// Blocks of `edge` samples a side whose samples can be within reach of the box of the corners.
BlockRange block_range(const Extent& triangle, double reach, int edge) {
  const glm::dvec3 lo = triangle.lo - reach;
  const glm::dvec3 hi = triangle.hi + reach;
  BlockRange range;
  for (int a = 0; a < 3; ++a) {
    // The first sample at or after lo and the last at or before hi.
    range.lo[a] = static_cast<int>(std::floor(std::ceil(lo[a]) / edge));
    range.hi[a] = static_cast<int>(std::floor(std::floor(hi[a]) / edge));
  }
  return range;
}

template <class Visit>
void for_each_block(const BlockRange& range, const Visit& visit) {
  for (int x = range.lo.x; x <= range.hi.x; ++x) {
    for (int y = range.lo.y; y <= range.hi.y; ++y) {
      for (int z = range.lo.z; z <= range.hi.z; ++z) visit(glm::ivec3(x, y, z));
    }
  }
}

// Whether a sample of the block can be within reach of the triangle (never wrongly false).
bool reaches(const BrickKernel& kernel, const TriangleRecord& record, const Extent& triangle,
             const glm::ivec3& block, int edge, double reach) {
  const double half = 0.5 * (edge - 1);
  double center[3];
  double support = 0;  // of the block along the triangle's normal
  double apart = 0;    // squared, between the boxes of triangle and block
  const double normal[3] = {record.gx[0], record.gy[0], record.gz[0]};
  double height = record.k[0];
  for (int a = 0; a < 3; ++a) {
    center[a] = static_cast<double>(block[a]) * edge + half;
    support += half * std::abs(normal[a]);
    height += normal[a] * center[a];
    const double gap =
        std::max({triangle.lo[a] - (center[a] + half), center[a] - half - triangle.hi[a], 0.0});
    apart += gap * gap;
  }
  if (std::abs(height) > reach + support + kSlack) return false;
  if (apart > (reach + kSlack) * (reach + kSlack)) return false;
  // The box and the plane of a triangle no larger than a block leave little more to cull.
  const glm::dvec3 size = triangle.hi - triangle.lo;
  if (std::max({size.x, size.y, size.z}) <= edge) return true;
  const double limit = reach + block_radius(edge) + kSlack;
  return kernel.squared_distance(record, center) <= limit * limit;
}

// Orders nodes by x, then y, then z. Node coordinates fit 21 bits each: kLargestIndex / 128 < 2^20.
std::uint64_t node_key(const glm::ivec3& node) {
  const auto part = [](int v) { return static_cast<std::uint64_t>(v + (1 << 20)); };
  return part(node.x) << 42U | part(node.y) << 21U | part(node.z);
}

glm::ivec3 node_of(std::uint64_t key) {
  const auto part = [key](unsigned shift) {
    return static_cast<int>(key >> shift & 0x1fffff) - (1 << 20);
  };
  return {part(42), part(21), part(0)};
}

}  // namespace

TriangleRecord make_record(const glm::dvec3 corners[3]) {
  TriangleRecord r{};
  int longest = 0;
  double length[3];
  for (int k = 0; k < 3; ++k) {
    length[k] = glm::distance(corners[k], corners[(k + 1) % 3]);
    if (length[k] > length[longest]) longest = k;
  }
  const glm::dvec3 a = corners[longest];
  const glm::dvec3 b = corners[(longest + 1) % 3];
  const glm::dvec3 c = corners[(longest + 2) % 3];
  const glm::dvec3 cross = glm::cross(b - a, c - a);
  const double doubled_area = glm::length(cross);
  if (!(doubled_area > kFlat * length[longest])) {
    set_segment(r, a, b);
    return r;
  }
  const glm::dvec3 normal = cross / doubled_area;
  set_function(r, 0, normal, a);
  const glm::dvec3 from[4] = {a, b, c, a};
  for (int k = 0; k < 3; ++k) {
    const double l = length[(longest + k) % 3];
    const glm::dvec3 along = l > 0 ? (from[k + 1] - from[k]) / l : any_perpendicular(normal);
    set_edge(r, k, from[k], along, l, normal);
  }
  return r;
}

void index_corners(const TriangleSoup& soup, const Lattice& lattice, std::uint32_t t,
                   glm::dvec3 corners[3]) {
  const glm::dvec3 shift = soup.origin - lattice.origin;
  for (int k = 0; k < 3; ++k) {
    corners[k] = (shift + soup.local(soup.triangles[t][k])) / lattice.voxel;
  }
}

namespace {

// Which nodes a run of triangles reaches, in the order of the triangles.
struct NodePairs {
  std::vector<std::uint64_t> keys;       // of the nodes, in order of first appearance
  std::vector<std::uint32_t> node;       // for each pair the number of its key
  std::vector<std::uint32_t> triangles;  // for each pair
};

// For the triangles from `begin` to `end`.
NodePairs find_nodes(const TriangleSoup& soup, const Lattice& lattice, double reach,
                     std::size_t begin, std::size_t end) {
  const BrickKernel& kernel = brick_kernel();
  NodePairs pairs;
  std::unordered_map<std::uint64_t, std::uint32_t> numbers;
  std::uint64_t last_key = ~0ULL;
  std::uint32_t last = 0;
  for (auto t = static_cast<std::uint32_t>(begin); t < end; ++t) {
    glm::dvec3 corners[3];
    index_corners(soup, lattice, t, corners);
    for (const glm::dvec3& c : corners) {
      if (!(std::abs(c.x) < kLargestIndex && std::abs(c.y) < kLargestIndex &&
            std::abs(c.z) < kLargestIndex)) {
        throw Error(ErrorKind::usage, "the voxel size is too small for the mesh; use a larger one");
      }
    }
    const Extent box = extent(corners);
    const BlockRange range = block_range(box, reach, kNodeEdge);
    const glm::ivec3 span = range.hi - range.lo;
    const bool many = span.x + span.y + span.z > 3;  // else culling costs more than it saves
    const TriangleRecord record = many ? make_record(corners) : TriangleRecord{};
    for_each_block(range, [&](const glm::ivec3& node) {
      if (many && !reaches(kernel, record, box, node, kNodeEdge, reach)) return;
      const std::uint64_t key = node_key(node);
      if (key != last_key) {
        const auto [found, is_new] =
            numbers.try_emplace(key, static_cast<std::uint32_t>(pairs.keys.size()));
        if (is_new) pairs.keys.push_back(key);
        last_key = key;
        last = found->second;
      }
      pairs.node.push_back(last);
      pairs.triangles.push_back(t);
    });
  }
  return pairs;
}

}  // namespace

NodeBins::NodeBins(const TriangleSoup& soup, const Lattice& lattice, double reach, const Job& job) {
  constexpr std::size_t kRun = 8192;  // triangles
  std::vector<NodePairs> runs((soup.triangles.size() + kRun - 1) / kRun);
  parallel_for(runs.size(), 1, job, [&](std::size_t run, std::size_t) {
    const std::size_t begin = run * kRun;
    runs[run] =
        find_nodes(soup, lattice, reach, begin, std::min(begin + kRun, soup.triangles.size()));
  });
  std::vector<std::uint64_t> keys;
  for (const NodePairs& run : runs) keys.insert(keys.end(), run.keys.begin(), run.keys.end());
  std::sort(keys.begin(), keys.end());
  keys.erase(std::unique(keys.begin(), keys.end()), keys.end());
  origins_.reserve(keys.size());
  for (const std::uint64_t key : keys) origins_.push_back(node_of(key) * kNodeEdge);
  first_.assign(keys.size() + 1, 0);
  for (NodePairs& run : runs) {
    for (std::uint64_t& key : run.keys) {  // from here on the node's number among all
      key = static_cast<std::uint64_t>(std::lower_bound(keys.begin(), keys.end(), key) -
                                       keys.begin());
    }
    for (const std::uint32_t n : run.node) ++first_[run.keys[n] + 1];
  }
  for (std::size_t i = 1; i < first_.size(); ++i) first_[i] += first_[i - 1];
  triangles_.resize(first_.back());
  std::vector<std::size_t> next(first_.begin(), first_.end() - 1);
  for (const NodePairs& run : runs) {
    for (std::size_t i = 0; i < run.node.size(); ++i) {
      triangles_[next[run.keys[run.node[i]]]++] = run.triangles[i];
    }
  }
}

BrickBins::BrickBins(const TriangleSoup& soup, const Lattice& lattice, double reach,
                     const glm::ivec3& origin, std::span<const std::uint32_t> triangles) {
  const BrickKernel& kernel = brick_kernel();
  const glm::ivec3 first_brick = origin / kBrickEdge;
  std::vector<std::uint32_t> count(kNodeBricks * kNodeBricks * kNodeBricks, 0);
  std::vector<std::pair<std::uint16_t, std::uint32_t>> pairs;  // slot, local number
  records_.reserve(triangles.size());
  pairs.reserve(12 * triangles.size());
  for (std::uint32_t local = 0; local < triangles.size(); ++local) {
    glm::dvec3 corners[3];
    index_corners(soup, lattice, triangles[local], corners);
    records_.push_back(make_record(corners));
    const Extent box = extent(corners);
    BlockRange range = block_range(box, reach, kBrickEdge);
    range.lo = glm::max(range.lo, first_brick);
    range.hi = glm::min(range.hi, first_brick + (kNodeBricks - 1));
    for_each_block(range, [&](const glm::ivec3& brick) {
      if (!reaches(kernel, records_.back(), box, brick, kBrickEdge, reach)) return;
      const glm::ivec3 at = brick - first_brick;
      const auto slot =
          static_cast<std::uint16_t>((at.x * kNodeBricks + at.y) * kNodeBricks + at.z);
      ++count[slot];
      pairs.emplace_back(slot, local);
    });
  }
  std::vector<std::size_t> next(count.size());
  std::size_t total = 0;
  for (std::size_t slot = 0; slot < count.size(); ++slot) {
    next[slot] = total;
    if (count[slot] == 0) continue;
    slots_.push_back(static_cast<std::uint16_t>(slot));
    first_.push_back(total);
    total += count[slot];
  }
  first_.push_back(total);
  locals_.resize(total);
  for (const auto& [slot, local] : pairs) locals_[next[slot]++] = local;
}

}  // namespace sdfgrid
