#include "sdfgrid/scene/stamp.h"

#include <fmt/format.h>

#include <filesystem>
#include <fstream>
#include <functional>
#include <span>
#include <sstream>

#include "sdfgrid/core/atomic_file.h"
#include "sdfgrid/core/error.h"
#include "sdfgrid/edit/field_brush.h"
#include "sdfgrid/edit/journal.h"
#include "sdfgrid/grid/atlas.h"
#include "sdfgrid/scene/build.h"
#include "sdfgrid/scene/file_kind.h"
#include "sdfgrid/scene/scene.h"
#include "sdfgrid/trace/grid_sampler.h"

namespace sdfgrid {
namespace {

namespace fs = std::filesystem;

std::string bytes_of(const std::string& file) {
  std::ifstream in(file, std::ios::binary);
  std::stringstream bytes;
  if (!in || !(bytes << in.rdbuf())) {
    throw input_error(file, "", "the stamp cannot be read", "check the path");
  }
  return bytes.str();
}

std::string name_of(const std::string& bytes, const std::string& file) {
  return fmt::format("{:016x}{}", fnv_hash(bytes), fs::path(file).extension().string());
}

// A file that a stamp consists of.
using Visit = std::function<void(const std::string& name, const std::string& bytes)>;

std::string visit_file(const std::string& file, const Visit& visit) {
  const std::string bytes = bytes_of(file);
  const std::string name = name_of(bytes, file);
  visit(name, bytes);
  return name;
}

// Gives the files that nodes name the names of their copies.
void rename_files(std::vector<SceneNode>& nodes, const fs::path& folder, const Visit& visit) {
  for (SceneNode& node : nodes) {
    for (SceneValue& value : node.values) {
      if (value.name == "file" && value.is_text) {
        value.text = visit_file((folder / value.text).string(), visit);
      }
    }
    rename_files(node.of, folder, visit);
  }
}

// Visits the files of a stamp's copy, the stamp's own last, and returns its name.
std::string visit_files(const Stamp& stamp, const Visit& visit) {
  if (stamp.kind == Stamp::Kind::grid) return visit_file(stamp.file, visit);
  Scene scene = read_scene(stamp.file).scene;
  rename_files(scene.nodes, fs::path(stamp.file).parent_path(), visit);
  const std::string text = scene_text(scene);
  const std::string name = name_of(text, "scene.yaml");
  visit(name, text);
  return name;
}

std::shared_ptr<const BrushShape> grid_brush(const std::string& file, const Job& job) {
  const Grid grid = read_grid(file);
  check_has_inside(grid);
  const Box box = grid.bounds();
  const auto atlas = std::make_shared<const Atlas>(make_atlas(grid, job));
  auto shape = std::make_shared<BrushShape>();
  shape->bounds = box;
  shape->exact = false;  // between the samples, and beyond the band
  shape->distances = [atlas, box](const float* x, const float* y, const float* z, float* distance,
                                  std::size_t count) {
    for (std::size_t i = 0; i < count; ++i) {
      distance[i] = static_cast<float>(trilinear_distance(*atlas, box, {x[i], y[i], z[i]}));
    }
  };
  return shape;
}

}  // namespace

FileStamps::Entry& FileStamps::entry(const Stamp& stamp) {
  Entry& known = entries_[stamp.file];
  if (!known.name.empty()) return known;
  check_kind(stamp.file, fs::path(stamp.file).filename().string(),
             stamp.kind == Stamp::Kind::grid ? FileKind::grid : FileKind::scene,
             {FileKind::grid, FileKind::scene});
  const std::string name = visit_files(stamp, [](const std::string&, const std::string&) {});
  if (stamp.kept && name != fs::path(stamp.file).filename()) {
    throw input_error(stamp.file, "",
                      "it is not the stamp that was kept, or one of its files is not",
                      "restore it from a copy");
  }
  known.name = name;
  return known;
}

Field FileStamps::scene_field(const std::string& file) {
  const SceneFile scene = read_scene(file);
  SceneModel model = build_scene(scene.scene, file, 0, job_);
  warnings_.insert(warnings_.end(), scene.warnings.begin(), scene.warnings.end());
  for (const std::string& warning : model.warnings) warnings_.push_back(file + ": " + warning);
  return model.field;
}

Field FileStamps::field(const Stamp& stamp) {
  Entry& known = entry(stamp);
  if (known.field == nullptr) {
    known.field = std::make_unique<Field>(
        stamp.kind == Stamp::Kind::grid ? make_field(make_sampler(read_grid(stamp.file), job_))
                                        : scene_field(stamp.file));
  }
  return *known.field;
}

std::shared_ptr<const BrushShape> FileStamps::brush(const Stamp& stamp) {
  Entry& known = entry(stamp);
  if (known.brush == nullptr) {
    known.brush = stamp.kind == Stamp::Kind::grid ? grid_brush(stamp.file, job_)
                                                  : make_brush(field(stamp), false);
  }
  return known.brush;
}

std::string FileStamps::keep(const Stamp& stamp, const std::string& folder) {
  create_folders(folder);
  const auto write = [&](const std::string& own, const std::string& bytes) {
    const std::string path = (fs::path(folder) / own).string();
    if (fs::exists(path) && fs::file_size(path) == bytes.size()) return;
    write_bytes_atomically(path, std::as_bytes(std::span(bytes)));
  };
  const std::string name = visit_files(stamp, write);
  if (name != entry(stamp).name) {
    throw Error(ErrorKind::failed, stamp.file + ": it changed while it was used; start again");
  }
  return name;
}

}  // namespace sdfgrid
