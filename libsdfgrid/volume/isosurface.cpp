#include "sdfgrid/volume/isosurface.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <glm/common.hpp>
#include <glm/geometric.hpp>
#include <glm/matrix.hpp>

#include "sdfgrid/core/error.h"
#include "sdfgrid/core/parallel.h"
#include "sdfgrid/volume/isosurface_cell.h"

namespace sdfgrid {
namespace {

using cell::kCorners;

// Share of an edge that a crossing keeps between itself and the samples.
constexpr double kMargin = 1.0 / 4096;
// Marks a corner of a triangle as a point of the layer's own `centers`.
constexpr std::uint32_t kCenter = 0x80000000U;
constexpr std::uint32_t kNone = 0xffffffffU;

// How far inside the surface samples are: the volume's values less iso, or the negative of that.
// Layers have a border of one sample beyond the volume, which is outside.
class InsideField {
 public:
  InsideField(const Volume& volume, const IsosurfaceOptions& options)
      : volume_(volume), options_(options), width_(volume.dims.x + 2), rows_(volume.dims.y + 2) {}

  static constexpr float kBeyond = -1e30F;

  [[nodiscard]] int width() const { return width_; }
  [[nodiscard]] int rows() const { return rows_; }
  [[nodiscard]] std::size_t layer_size() const { return std::size_t(width_) * rows_; }
  // Layers -1 to dims.z; `out` gets layer_size() values.
  void layer(int k, std::vector<float>& out) const {
    out.assign(layer_size(), kBeyond);
    if (k < 0 || k >= volume_.dims.z) return;
    std::visit([&](const auto& samples) { copy(samples, k, out); }, volume_.samples);
  }
  [[nodiscard]] bool inside(float value) const {
    return options_.inside_above ? value >= 0 : value > 0;
  }

 private:
  template <class T>
  void copy(const std::vector<T>& samples, int k, std::vector<float>& out) const {
    const double sign = options_.inside_above ? 1 : -1;
    for (int j = 0; j < volume_.dims.y; ++j) {
      const T* row = samples.data() + volume_.place({0, j, k});
      float* to = out.data() + std::size_t(j + 1) * width_ + 1;
      for (int i = 0; i < volume_.dims.x; ++i) {
        to[i] = static_cast<float>(sign * (static_cast<double>(row[i]) - options_.iso));
      }
    }
  }

  const Volume& volume_;
  IsosurfaceOptions options_;
  int width_;
  int rows_;
};

// Which edges that start at a sample are crossed, one bit an axis.
unsigned crossed(const InsideField& field, const std::vector<float>& layer,
                 const std::vector<float>& above, int column, int row) {
  const std::size_t at = std::size_t(row) * field.width() + column;
  const bool inside = field.inside(layer[at]);
  unsigned axes = 0;
  if (column + 1 < field.width() && field.inside(layer[at + 1]) != inside) axes |= 1U;
  if (row + 1 < field.rows() && field.inside(layer[at + field.width()]) != inside) axes |= 2U;
  if (!above.empty() && field.inside(above[at]) != inside) axes |= 4U;
  return axes;
}

// Where on the edge from a to b the surface is.
double crossing(float a, float b) {
  if (a == InsideField::kBeyond) return 1 - kMargin;
  if (b == InsideField::kBeyond) return kMargin;
  const double t = double(a) / (double(a) - double(b));
  return std::clamp(t, kMargin, 1 - kMargin);
}

// The numbers of the crossings of all edges that start in one layer, in the order of the samples.
struct LayerEdges {
  std::array<std::vector<std::uint32_t>, 3> number;  // by axis and sample; kNone without crossing
};

// Calls take(axis, column, row) for each crossing in its order.
template <class Take>
void for_crossings(const InsideField& field, const std::vector<float>& layer,
                   const std::vector<float>& above, const Take& take) {
  for (int row = 0; row < field.rows(); ++row) {
    for (int column = 0; column < field.width(); ++column) {
      const unsigned axes = crossed(field, layer, above, column, row);
      if (axes == 0) continue;
      for (unsigned axis = 0; axis < 3; ++axis) {
        if ((axes >> axis & 1U) != 0) take(axis, column, row);
      }
    }
  }
}

void number_edges(const InsideField& field, const std::vector<float>& layer,
                  const std::vector<float>& above, std::uint32_t first, LayerEdges& edges) {
  for (auto& numbers : edges.number) numbers.assign(field.layer_size(), kNone);
  for_crossings(field, layer, above, [&](unsigned axis, int column, int row) {
    edges.number[axis][std::size_t(row) * field.width() + column] = first++;
  });
}

// What one layer of cells adds to the mesh. Points are index coordinates.
struct LayerMesh {
  std::vector<glm::dvec3> crossings;  // of the edges that start in the layer below the cells
  std::vector<glm::dvec3> centers;
  std::vector<glm::uvec3> triangles;  // of numbers of crossings, or kCenter and a place in centers
};

void add_crossings(const InsideField& field, const std::vector<float>& layer,
                   const std::vector<float>& above, int k, LayerMesh& mesh) {
  for_crossings(field, layer, above, [&](unsigned axis, int column, int row) {
    const std::size_t at = std::size_t(row) * field.width() + column;
    const float end = axis == 0 ? layer[at + 1] : axis == 1 ? layer[at + field.width()] : above[at];
    glm::dvec3 point(column - 1, row - 1, k);
    point[static_cast<int>(axis)] += crossing(layer[at], end);
    mesh.crossings.push_back(point);
  });
}

// One cell at work.
struct Cell {
  std::array<float, kCorners> values;
  std::array<std::uint32_t, cell::kEdges> number;  // of each crossed edge
  glm::ivec3 index;                                // of its first corner
};

glm::dvec3 point_of(const Cell& c, int edge) {
  const auto& [from, axis] = cell::kEdgeStart[edge];
  glm::dvec3 p(from & 1, from >> 1 & 1, from >> 2 & 1);
  p[axis] += crossing(c.values[from], c.values[from | 1 << axis]);
  return p;
}

void add_triangle(LayerMesh& mesh, std::uint32_t a, std::uint32_t b, std::uint32_t c) {
  mesh.triangles.emplace_back(a, b, c);
}

void fill_loop(const Cell& c, const cell::Loop& loop, LayerMesh& mesh) {
  std::array<glm::dvec3, cell::kEdges> p;
  for (int i = 0; i < loop.size; ++i) p[i] = point_of(c, loop.edges[i]);
  const auto number = [&](int i) { return c.number[loop.edges[i]]; };
  if (loop.size == 3) return add_triangle(mesh, number(0), number(1), number(2));
  if (loop.size == 4) {
    // The two ends of either diagonal share no face of the cell, so no other cell uses it.
    const int turn = glm::distance(p[0], p[2]) <= glm::distance(p[1], p[3]) ? 0 : 1;
    add_triangle(mesh, number(turn), number(turn + 1), number(turn + 2));
    return add_triangle(mesh, number(turn), number(turn + 2), number((turn + 3) % 4));
  }
  glm::dvec3 center(0.0);
  for (int i = 0; i < loop.size; ++i) center += p[i];
  center = cell::pull_to_surface(c.values, center / double(loop.size));
  const auto at = kCenter | static_cast<std::uint32_t>(mesh.centers.size());
  mesh.centers.push_back(glm::dvec3(c.index) + center);
  for (int i = 0; i < loop.size; ++i) {
    add_triangle(mesh, at, number(i), number((i + 1) % loop.size));
  }
}

// The layer of cells between two layers of samples, whose edges are numbered.
void add_cells(const InsideField& field, const std::array<std::vector<float>, 2>& layers,
               const std::array<LayerEdges, 2>& edges, int k, LayerMesh& mesh) {
  Cell c{};
  for (int row = 0; row + 1 < field.rows(); ++row) {
    for (int column = 0; column + 1 < field.width(); ++column) {
      unsigned inside = 0;
      for (unsigned corner = 0; corner < kCorners; ++corner) {
        const std::size_t at =
            std::size_t(row + (corner >> 1 & 1)) * field.width() + column + (corner & 1);
        c.values[corner] = layers[corner >> 2][at];
        inside |= static_cast<unsigned>(field.inside(c.values[corner])) << corner;
      }
      if (inside == 0 || inside == 0xff) continue;
      for (int edge = 0; edge < cell::kEdges; ++edge) {
        const auto& [from, axis] = cell::kEdgeStart[edge];
        const std::size_t at =
            std::size_t(row + (from >> 1 & 1)) * field.width() + column + (from & 1);
        c.number[edge] = edges[from >> 2].number[axis][at];
      }
      c.index = {column - 1, row - 1, k};
      cell::for_loops(c.values, inside, [&](const cell::Loop& loop) { fill_loop(c, loop, mesh); });
    }
  }
}

// How many crossings start in each layer, from layer -1 on.
std::vector<std::uint64_t> count_crossings(const InsideField& field, int layers, const Job& job) {
  std::vector<std::uint64_t> counts(layers);
  parallel_for(counts.size(), 1, job, [&](std::size_t begin, std::size_t end) {
    std::vector<float> layer, above;
    for (std::size_t n = begin; n < end; ++n) {
      field.layer(static_cast<int>(n) - 1, layer);
      above.clear();
      if (static_cast<int>(n) + 1 < layers) field.layer(static_cast<int>(n), above);
      for_crossings(field, layer, above, [&](unsigned, int, int) { ++counts[n]; });
    }
  });
  return counts;
}

std::vector<LayerMesh> make_layers(const InsideField& field,
                                   const std::vector<std::uint64_t>& counts, const Job& job) {
  const std::size_t samples = counts.size();  // layers of them
  std::vector<std::uint32_t> first(samples + 1, 0);
  for (std::size_t n = 0; n < samples; ++n) {
    first[n + 1] = first[n] + static_cast<std::uint32_t>(counts[n]);
  }
  std::vector<LayerMesh> meshes(samples - 1);
  parallel_for("isosurface", meshes.size(), 1, job, [&](std::size_t begin, std::size_t end) {
    std::array<std::vector<float>, 2> layers;
    std::vector<float> next;
    std::array<LayerEdges, 2> edges;
    for (std::size_t n = begin; n < end; ++n) {
      if (counts[n] + counts[n + 1] > 0) {
        const int k = static_cast<int>(n) - 1;
        field.layer(k, layers[0]);
        field.layer(k + 1, layers[1]);
        next.clear();
        if (n + 2 < samples) field.layer(k + 2, next);
        number_edges(field, layers[0], layers[1], first[n], edges[0]);
        number_edges(field, layers[1], next, first[n + 1], edges[1]);
        add_crossings(field, layers[0], layers[1], k, meshes[n]);
        add_cells(field, layers, edges, k, meshes[n]);
      }
    }
  });
  return meshes;
}

// Index coordinates to the soup's own, around the volume's middle, so that float keeps them.
class ToSoup {
 public:
  explicit ToSoup(const Volume& volume) : volume_(volume) {
    origin_ = volume.to_world(glm::dvec3(volume.dims - 1) * 0.5);
  }
  [[nodiscard]] glm::dvec3 origin() const { return origin_; }
  [[nodiscard]] glm::vec3 operator()(const glm::dvec3& index) const {
    return glm::vec3(volume_.to_world(index) - origin_);
  }

 private:
  const Volume& volume_;
  glm::dvec3 origin_;
};

TriangleSoup join(const Volume& volume, const std::vector<LayerMesh>& layers) {
  const ToSoup to_soup(volume);
  TriangleSoup soup;
  soup.origin = to_soup.origin();
  std::size_t crossings = 0, centers = 0, triangles = 0;
  for (const LayerMesh& layer : layers) {
    crossings += layer.crossings.size();
    centers += layer.centers.size();
    triangles += layer.triangles.size();
  }
  soup.points.reserve(crossings + centers);
  soup.triangles.reserve(triangles);
  for (const LayerMesh& layer : layers) {
    for (const glm::dvec3& p : layer.crossings) soup.points.push_back(to_soup(p));
  }
  const bool mirrored = glm::determinant(volume.axes) < 0;
  for (const LayerMesh& layer : layers) {
    const auto base = static_cast<std::uint32_t>(soup.points.size());
    for (const glm::dvec3& p : layer.centers) soup.points.push_back(to_soup(p));
    for (glm::uvec3 t : layer.triangles) {
      for (int a = 0; a < 3; ++a) {
        if ((t[a] & kCenter) != 0) t[a] = base + (t[a] & ~kCenter);
      }
      if (mirrored) std::swap(t.y, t.z);
      soup.triangles.push_back(t);
    }
  }
  return soup;
}

}  // namespace

TriangleSoup isosurface(const Volume& volume, const IsosurfaceOptions& options, const Job& job) {
  const InsideField field(volume, options);
  const std::vector<std::uint64_t> counts = count_crossings(field, volume.dims.z + 2, job);
  std::uint64_t crossings = 0;
  for (const std::uint64_t count : counts) crossings += count;
  if (crossings == 0) {
    throw Error(ErrorKind::input,
                fmt::format("no sample is {} {}: there is no surface; look at the range that "
                            "'sdfgrid info' prints and choose another --iso",
                            options.inside_above ? "at or above" : "below", options.iso));
  }
  constexpr std::uint64_t kMost = 1U << 30U;  // centres come on top, fewer than half as many
  if (crossings > kMost) {
    throw Error(ErrorKind::input,
                fmt::format("the surface at {} has {} points, more than 2^30; it looks like noise: "
                            "smooth the volume or choose another --iso",
                            options.iso, crossings));
  }
  return join(volume, make_layers(field, counts, job));
}

}  // namespace sdfgrid
