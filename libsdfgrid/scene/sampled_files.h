// scene/sampled_files.h: the grids and meshes that a scene names, as leaves of its field: read once
// each, with bands as wide as the scene needs them (internal to scene/).
#pragma once

#include <map>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "sdfgrid/core/job.h"
#include "sdfgrid/field/field.h"
#include "sdfgrid/grid/grid.h"
#include "sdfgrid/grid/paint.h"
#include "sdfgrid/scene/build.h"

namespace sdfgrid {

struct SampledFile {
  std::shared_ptr<const Sampler> sampler;
  std::string path;
  int line = 0;         // of the first node that names it
  int dim = 0;          // of a mesh; 0 for a grid
  double width = 3;     // of its band, voxels
  std::string made_of;  // what a grid says that it was converted from
  int tag = -1;         // of what is not painted, if the grid says how that looks
};

class SampledFiles {
 public:
  // Keeps references: to the scene's name in messages, the tags of its own materials, and the
  // model, which gets the materials of painted grids, warnings and bands that are too short.
  SampledFiles(const std::string& scene, const std::map<std::string, int>& tags, SceneModel& model,
               const Job& job)
      : scene_(scene), tags_(tags), model_(model), job_(job) {}

  // What the file, called `name` in that line, holds: a mesh at that many voxels along its longest
  // side, or, if dim is 0, a grid. Throws Error{input}, for a file of another kind with the word
  // that it belongs under.
  const SampledFile& get(const std::string& path, const std::string& name, int dim, int line);

  // Where the model's field, or who asked for `reach`, looks beyond the band of a mesh, drops its
  // grid, so that get() makes a wider one; returns whether there are any. Throws Error{input} for a
  // grid that the field itself needs wider.
  bool widen(const SceneReach& reach);

 private:
  SampledFile& of(const SamplerUse& use);
  [[noreturn]] void refuse(const SampledFile& grid, const SamplerUse& use) const;
  Grid convert(const SampledFile& from);
  std::map<int, int> paint_tags(const Grid& grid);
  int tag_of(const PaintLook& look);
  void warn(const std::string& text);

  const std::string& scene_;
  const std::map<std::string, int>& tags_;
  SceneModel& model_;
  const Job& job_;
  std::map<std::string, SampledFile> files_;      // by dim and path
  std::vector<std::pair<PaintLook, int>> looks_;  // of grids, with their tags
};

}  // namespace sdfgrid
