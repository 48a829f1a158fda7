// transform/cell_sites.h: the cells of 2^3 samples beside a mesh and the triangles known there: the
// sites of its feature transform (not installed).
#pragma once

#include <array>
#include <cstdint>
#include <glm/vec3.hpp>
#include <span>
#include <vector>

#include "sdfgrid/transform/mesh_seeds.h"
#include "sdfgrid/transform/nearest_sites.h"

namespace sdfgrid {

inline constexpr int kCell = 2;        // samples
inline constexpr int kBrickCells = 4;  // kBrickEdge / kCell
inline constexpr int kBlockCells = 8;  // a block is 2^3 bricks

// The triangles nearest to the seeds in each cell of a brick, and those so small that several may
// be between seeds, in the cell of their middle: evenly chosen ones where a cell has very many.
// Each once a cell.
struct CellTriangles {
  std::uint64_t with_seeds;  // which cells have any: bit (x * 4 + y) * 4 + z
  std::array<std::uint16_t, kBrickCells * kBrickCells * kBrickCells + 1> first{};
  std::vector<std::uint32_t> triangles;

  explicit CellTriangles(const Brick& brick);

  struct Small {
    std::size_t cell;
    std::uint32_t triangle;
  };
  // By cell, ascending. Cells without seeds are passed over.
  void add(std::span<const Small> small);
};

struct CellSites {
  MeshSeeds<CellTriangles> seeds;
  BrickTable blocks;
  std::vector<SiteBits> bits;  // the cells with seeds of each block

  CellSites(const SignedMesh& mesh, const Lattice& lattice, const Job& job);

 private:
  void add_small_triangles(const TriangleSoup& soup, const Lattice& lattice, const Job& job);
};

// A list of triangles, each once.
class TriangleSet {
 public:
  explicit TriangleSet(std::size_t triangles) : last_list_(triangles, 0) {}

  void begin() {
    ++list_;
    triangles_.clear();
  }
  void add(std::uint32_t triangle) {
    if (last_list_[triangle] == list_) return;
    last_list_[triangle] = list_;
    triangles_.push_back(triangle);
  }
  [[nodiscard]] const std::vector<std::uint32_t>& triangles() const { return triangles_; }

 private:
  std::vector<std::uint32_t> last_list_;  // that had the triangle
  std::uint32_t list_ = 0;
  std::vector<std::uint32_t> triangles_;
};

// Cells around one block as bits, rows along z: the nearest cells of a brick's samples are marked,
// and the triangles in and beside those collected.
class CellsAround {
 public:
  // Marked cells are within `reach` cells of the block.
  CellsAround(const CellSites& sites, int reach);

  void begin_block(const glm::ivec3& block);

  // A cell, counted from the block's first one, as one number.
  [[nodiscard]] std::int32_t place(const glm::ivec3& cell) const {
    const glm::ivec3 at = cell + halo_;
    return at.x << 12 | at.y << 6 | at.z;
  }
  // With those beside it, or the cell alone.
  void mark(std::int32_t place, bool with_beside) {
    auto& rows = with_beside ? marked_ : alone_;
    rows[static_cast<std::size_t>(place >> 6)] |= 1ULL << (place & 63);
    lowest_ = std::min(lowest_, place >> 12);
    highest_ = std::max(highest_, place >> 12);
  }
  // Adds the triangles of the marked cells, and unmarks them.
  void collect(TriangleSet& set);

  static constexpr int kLargestReach = 26;

 private:
  static constexpr std::int32_t kUnknown = -2;
  static constexpr int kRows = 64;

  void add_block(const glm::ivec3& block, const glm::ivec3& offset);
  void add_triangles(const glm::ivec3& cell, TriangleSet& set);

  const CellSites& sites_;
  int halo_;  // cells; one around the marked ones is free
  int side_;
  std::vector<std::uint64_t> marked_;  // kRows * x + y
  std::vector<std::uint64_t> alone_;
  std::vector<std::uint64_t> with_seeds_;
  int lowest_ = kRows;  // x of marked cells
  int highest_ = 0;
  int brick_halo_;
  int brick_side_;
  std::vector<std::int32_t> bricks_;  // numbers of the bricks with seeds, as they are asked for
  glm::ivec3 first_brick_{0};
};

}  // namespace sdfgrid
