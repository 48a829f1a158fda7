#include "sdfgrid/scene/sampled_files.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "sdfgrid/core/error.h"
#include "sdfgrid/grid/bricks.h"
#include "sdfgrid/grid/convert.h"
#include "sdfgrid/mesh/read.h"
#include "sdfgrid/scene/file_kind.h"
#include "sdfgrid/trace/atlas_seen.h"
#include "sdfgrid/trace/grid_sampler.h"

namespace sdfgrid {
namespace {

// How many times as wide the band of a file would have to be for a use.
double times(const SamplerUse& use) {
  return std::max(-use.lo / use.sampler->reach_inside(), use.hi / use.sampler->reach_outside());
}

// Those of the field itself, and of what lies as far from its surface as was asked for.
std::vector<SamplerUse> uses_in_reach(const Field& field, const SceneReach& reach,
                                      std::vector<SamplerUse> uses) {
  for (const double level : {reach.outside, -reach.inside}) {
    if (level == 0) continue;
    const Field moved = make_field("offset", {{"by", level}}, {field});
    for (const SamplerUse& use : moved.sampler_uses()) (void)add_use(uses, use);
  }
  return uses;
}

// The part of the reach that was asked for within which the file's distances do not end. Searched
// for: neither values (Sampler::value_at) nor what ops look at need be in proportion to it. `own`
// are the uses of the field itself, which the file is wide enough for.
double share(const Field& field, const SceneReach& reach, const std::vector<SamplerUse>& own,
             const Sampler* sampler) {
  constexpr int kHalvings = 20;
  double enough = 0;
  double too_far = 1;
  for (int i = 0; i < kHalvings; ++i) {
    const double part = 0.5 * (enough + too_far);
    std::vector<SamplerUse> uses =
        uses_in_reach(field, {part * reach.inside, part * reach.outside}, own);
    (times(add_use(uses, {sampler, 0, 0})) > 1 ? too_far : enough) = part;
  }
  return enough;
}

// The width that a file's band has to have for a use.
double wider(const SampledFile& file, const SamplerUse& use) {
  return std::ceil(1.05 * file.width * times(use)) + 1;
}

Grid read(SampledFile& known) {
  Grid grid = read_grid(known.path);
  const double voxel = grid.lattice().voxel;
  known.width = std::max(grid.background(), -band_limits(grid).inside) / voxel;
  // What was carved since would be lost.
  if (grid.metadata("sdfgrid:method") != "sculpt") known.made_of = grid.metadata("sdfgrid:source");
  return grid;
}

}  // namespace

const SampledFile& SampledFiles::get(const std::string& path, const std::string& name, int dim,
                                     int line) {
  SampledFile& known = files_[fmt::format("{} {}", dim, path)];
  if (known.sampler != nullptr) return known;
  known.path = path;
  if (known.line == 0) known.line = line;
  known.dim = dim;
  check_kind(path, name, dim > 0 ? FileKind::mesh : FileKind::grid,
             {FileKind::grid, FileKind::mesh});
  const Grid grid = dim > 0 ? convert(known) : read(known);
  std::map<int, int> tags = paint_tags(grid);
  known.tag = tags.contains(0) ? tags[0] : -1;
  tags.erase(0);
  known.sampler = make_sampler(grid, job_, tags);
  model_.has_grids = true;
  return known;
}

bool SampledFiles::widen(const SceneReach& reach) {
  if (files_.empty()) return false;
  std::vector<SamplerUse> own = model_.field.sampler_uses();
  for (const SamplerUse& use : own) {
    if (times(use) > 1 && of(use).dim == 0) refuse(of(use), use);
  }
  bool any = false;
  model_.short_bands.clear();
  for (const SamplerUse& use : uses_in_reach(model_.field, reach, own)) {
    SampledFile& file = of(use);
    if (times(use) <= 1) continue;
    // Of a mesh much smaller than what is looked at from afar: such a band would take minutes.
    constexpr double kWidest = 40;
    const SamplerUse least = add_use(own, {use.sampler, 0, 0});
    const bool must = times(least) > 1;
    if (file.dim == 0 || (!must && file.width >= kWidest)) {
      const double part = share(model_.field, reach, own, use.sampler);
      model_.short_bands.push_back({file.path, file.line, part, wider(file, use)});
      continue;
    }
    const double needed = must ? wider(file, least) : 0;
    file.width = std::max(needed, std::min(wider(file, use), kWidest));
    file.sampler.reset();
    any = true;
  }
  return any;
}

SampledFile& SampledFiles::of(const SamplerUse& use) {
  return std::find_if(files_.begin(), files_.end(),
                      [&](const auto& known) { return known.second.sampler.get() == use.sampler; })
      ->second;
}

void SampledFiles::refuse(const SampledFile& grid, const SamplerUse& use) const {
  throw input_error(
      scene_, fmt::format("line {}", grid.line),
      fmt::format("an offset, shell, blend or displacement looks {:.4g} inwards and {:.4g} "
                  "outwards of the surface of {}, whose distances end at {:.4g} and {:.4g}",
                  std::fabs(use.lo), use.hi, grid.path, use.sampler->reach_inside(),
                  use.sampler->reach_outside()),
      fmt::format("convert {} again, with --width {:g}",
                  grid.made_of.empty() ? "its mesh" : grid.made_of, wider(grid, use)));
}

// The materials that a grid is painted with: the scene's of that number, or else as a grid alone
// shows them. 0, what is not painted, is among them if the grid says how that looks.
std::map<int, int> SampledFiles::paint_tags(const Grid& grid) {
  const std::map<int, PaintLook> looks = paint_looks(grid);
  std::map<int, int> tags;
  if (looks.contains(0)) tags[0] = tag_of(looks.at(0));
  for (const auto& [material, count] : paint_counts(grid)) {
    const std::string number = std::to_string(material);
    const auto named = tags_.find(number);
    const auto look = looks.find(material);
    if (named != tags_.end()) {
      tags[material] = named->second;
    } else if (look != looks.end()) {
      tags[material] = tag_of(look->second);
    } else {
      const Material shown = paint_look(material);
      tags[material] = tag_of({shown.diffuse, shown.specular, shown.exponent, number});
    }
  }
  return tags;
}

// Grids that say the same share it.
int SampledFiles::tag_of(const PaintLook& look) {
  for (const auto& [known, tag] : looks_) {
    if (known == look) return tag;
  }
  return looks_.emplace_back(look, model_.add_material(paint_look(0, look), look.name)).second;
}

void SampledFiles::warn(const std::string& text) {
  std::vector<std::string>& all = model_.warnings;
  if (std::find(all.begin(), all.end(), text) == all.end()) all.push_back(text);
}

Grid SampledFiles::convert(const SampledFile& from) {
  const MeshFile mesh = read_mesh(from.path, job_);
  for (const std::string& warning : mesh.warnings) warn(warning);
  ConvertOptions options;
  options.dim = from.dim;
  options.band = {from.width, from.width};
  Conversion made = convert_mesh(mesh.soup, options, job_);
  for (const std::string& warning : made.warnings) warn(warning);
  return made.grid;
}

}  // namespace sdfgrid
