#include "sdfgrid/grid/paint.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>
#include <glm/common.hpp>
#include <optional>
#include <string_view>

#include "sdfgrid/grid/vdb.h"

namespace sdfgrid {

using PaintTree = openvdb::Int32Tree;

bool has_paint(const Grid& grid) {
  const openvdb::Int32Grid::Ptr& paint = grid.storage().paint;
  return paint && !paint->tree().empty() && paint->activeVoxelCount() > 0;
}

std::map<int, std::size_t> paint_counts(const Grid& grid) {
  std::map<int, std::size_t> counts;
  if (!grid.storage().paint) return counts;
  for (auto at = grid.storage().paint->tree().cbeginValueOn(); at; ++at) {
    counts[*at] += at.getVoxelCount();
  }
  return counts;
}

namespace {

constexpr std::string_view kLookKey = "sdfgrid:material-";

// "0.8 0.1 0.1 0.3 64 red", the name up to the end.
std::string text_of(const PaintLook& look) {
  return fmt::format("{} {} {} {} {} {}", look.diffuse.x, look.diffuse.y, look.diffuse.z,
                     look.specular, look.exponent, look.name);
}

std::optional<PaintLook> look_of(std::string_view text) {
  float numbers[5];
  for (float& number : numbers) {
    const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), number);
    if (error != std::errc() || !std::isfinite(number) || number < 0) return std::nullopt;
    text.remove_prefix(static_cast<std::size_t>(end - text.data()));
    if (text.starts_with(' ')) text.remove_prefix(1);
  }
  return PaintLook{{numbers[0], numbers[1], numbers[2]}, numbers[3], numbers[4], std::string(text)};
}

}  // namespace

void set_paint_look(Grid& grid, int material, const PaintLook& look) {
  grid.set_metadata(fmt::format("{}{}", kLookKey, material), text_of(look));
}

std::map<int, PaintLook> paint_looks(const Grid& grid) {
  std::map<int, PaintLook> looks;
  for (int material = 0; material <= kMostMaterial; ++material) {
    const std::string text = grid.metadata(fmt::format("{}{}", kLookKey, material));
    if (const auto look = look_of(text)) looks[material] = *look;
  }
  return looks;
}

struct PaintReader::Access {
  explicit Access(const PaintTree& tree) : materials(tree) {}
  openvdb::tree::ValueAccessor<const PaintTree> materials;
};

PaintReader::PaintReader(const Grid& grid) : grid_(grid) {
  if (grid.storage().paint) access_ = std::make_unique<Access>(grid.storage().paint->tree());
}

PaintReader::~PaintReader() = default;

int PaintReader::at(const glm::dvec3& world) const {
  if (access_ == nullptr) return 0;
  const glm::dvec3 index = grid_.lattice().to_index(world);
  const glm::dvec3 low = glm::floor(index);
  const glm::dvec3 t = index - low;
  const glm::ivec3 first(low);
  std::array<int, 8> materials{};
  std::array<double, 8> weights{};
  for (int n = 0; n < 8; ++n) {
    const glm::ivec3 step(n >> 2, n >> 1 & 1, n & 1);
    const glm::dvec3 w = glm::mix(1.0 - t, t, glm::dvec3(step));
    const glm::ivec3 p = first + step;
    const int material = access_->materials.getValue(openvdb::Coord(p.x, p.y, p.z));
    const auto* known = std::find(materials.begin(), materials.begin() + n, material);
    materials[n] = material;
    weights[known - materials.begin()] += w.x * w.y * w.z;
  }
  int best = 0;
  for (int n = 1; n < 8; ++n) {
    const bool more = weights[n] > weights[best];
    if (more || (weights[n] == weights[best] && materials[n] < materials[best])) best = n;
  }
  return materials[best];
}

}  // namespace sdfgrid
