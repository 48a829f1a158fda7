#include "sdfgrid/grid/paint_field.h"

#include <algorithm>
#include <cstdint>
#include <glm/common.hpp>
#include <optional>
#include <vector>

#include "sdfgrid/core/parallel.h"
#include "sdfgrid/field/marks.h"
#include "sdfgrid/grid/bricks.h"

namespace sdfgrid {
namespace {

constexpr std::size_t kGrain = 16;  // bricks a thread takes at a time

// The materials of a brick's samples: one of all, or each its own.
struct BrickPaint {
  std::uint8_t all = 0;
  std::vector<std::uint8_t> each;
};

class FieldPaint {
 public:
  FieldPaint(const Lattice& lattice, const Field& field, std::span<const int> materials)
      : lattice_(lattice), field_(field), materials_(materials) {}

  [[nodiscard]] BrickPaint of(const glm::ivec3& brick, const std::uint64_t* active) const {
    const glm::dvec3 lo = lattice_.to_world(glm::dvec3(8 * brick));
    const glm::dvec3 hi = lattice_.to_world(glm::dvec3(8 * brick + 7));
    const glm::dvec3 slack = 1e-7 * glm::max(glm::abs(lo), glm::abs(hi));
    const Field here = field_.pruned({lo - slack, hi + slack});
    if (const std::optional<int> mark = only_mark(here)) return {material_of(*mark), {}};
    BrickPaint paint;
    paint.each.resize(kBrickSamples);
    for (int i = 0; i < kBrickSamples; ++i) {
      if ((active[i >> 6] >> (i & 63) & 1) == 0) continue;
      const glm::ivec3 index = 8 * brick + glm::ivec3(i >> 6, i >> 3 & 7, i & 7);
      paint.each[i] = material_of(here.tag_at(lattice_.to_world(glm::dvec3(index))));
    }
    return paint;
  }

 private:
  [[nodiscard]] std::uint8_t material_of(int mark) const {
    const bool known = mark >= 0 && mark < std::ssize(materials_);
    return known ? static_cast<std::uint8_t>(materials_[static_cast<std::size_t>(mark)]) : 0;
  }

  Lattice lattice_;
  const Field& field_;
  std::span<const int> materials_;
};

// Calls visit(sample, material) for the brick's active samples.
template <class Visit>
void for_active(const BrickPaint& paint, const std::uint64_t* active, const Visit& visit) {
  for (int i = 0; i < kBrickSamples; ++i) {
    if ((active[i >> 6] >> (i & 63) & 1) == 0) continue;
    visit(i, paint.each.empty() ? paint.all : paint.each[static_cast<std::size_t>(i)]);
  }
}

}  // namespace

std::set<int> paint_by_field(const Grid& grid, const Field& field, std::span<const int> materials,
                             const Job& job) {
  const FieldPaint paint(grid.lattice(), field, materials);
  const std::vector<glm::ivec3> places = all_bricks(grid);
  std::vector<BrickPaint> painted(places.size());
  parallel_for("paint", places.size(), kGrain, job, [&](std::size_t begin, std::size_t end) {
    const GridBricks bricks(grid);  // one serves one thread
    for (std::size_t i = begin; i < end; ++i) {
      painted[i] = paint.of(places[i], bricks.find(places[i]).active);
    }
  });
  GridBricks bricks(grid);
  std::set<int> found;
  for (std::size_t i = 0; i < places.size(); ++i) {
    for_active(painted[i], bricks.find(places[i]).active,
               [&](int, std::uint8_t material) { found.insert(material); });
  }
  for (std::size_t i = 0; i < places.size(); ++i) {
    std::int32_t samples[kBrickSamples] = {};
    bool any = false;
    for_active(painted[i], bricks.find(places[i]).active, [&](int sample, std::uint8_t material) {
      samples[sample] = found.size() > 1 ? material : 0;
      any = any || samples[sample] != 0;
    });
    if (any || bricks.paint(places[i]) != nullptr) bricks.set_paint(places[i], samples);
  }
  return found;
}

}  // namespace sdfgrid
