// sdfgrid info: what a file holds.
#include <algorithm>
#include <cstdlib>
#include <map>
#include <memory>
#include <string_view>
#include <utility>

#include "command.h"
#include "info_strokes.h"
#include "inputs.h"
#include "options.h"
#include "scenes.h"
#include "sdfgrid/grid/grid.h"
#include "sdfgrid/grid/paint.h"
#include "sdfgrid/mesh/diagnose.h"
#include "sdfgrid/scene/file_kind.h"

namespace sdfgrid::cli {
namespace {

struct Options {
  std::string input;
  VolumeOptions volume;
  double time = 0;
};

Json triple(const glm::dvec3& v) { return {v.x, v.y, v.z}; }

// Which way a mesh faces, in one word.
std::string_view orientation(const MeshDiagnosis& diagnosis) {
  if (!diagnosis.consistently_oriented()) return "inconsistent";
  if (!diagnosis.closed()) return "consistent";
  return diagnosis.volume < 0.0 ? "inward" : "outward";
}

void report_defects(const MeshDiagnosis& diagnosis, Context& context) {
  const std::pair<const char*, std::size_t> counts[] = {
      {"boundary_edges", diagnosis.boundary_edges},
      {"nonmanifold_edges", diagnosis.nonmanifold_edges},
      {"flipped_neighbours", diagnosis.flipped_neighbours},
      {"zero_area_faces", diagnosis.zero_area_faces},
      {"duplicate_faces", diagnosis.duplicate_faces}};
  for (const auto& [key, count] : counts) {
    context.result()[key] = count;
    std::string name = key;
    std::replace(name.begin(), name.end(), '_', ' ');
    if (count > 0) context.print("{:<20} {}", name, count);
  }
}

void report_mesh(const MeshFile& file, Context& context) {
  const MeshDiagnosis diagnosis = diagnose(file.soup);
  Json& result = context.result();
  result["kind"] = "mesh";
  result["format"] = file.format;
  context.print("mesh       {}", file.format);
  report_bounds(diagnosis.bounds, context);
  result["triangles"] = diagnosis.triangles;
  result["points"] = diagnosis.points;
  result["file_faces"] = file.faces;
  result["file_points"] = file.points;
  result["components"] = diagnosis.components;
  context.print("triangles  {} (of {} faces), on {} points (of {} in the file)",
                diagnosis.triangles, file.faces, diagnosis.points, file.points);
  context.print("components {}", diagnosis.components);
  result["area"] = diagnosis.area;
  result["volume"] = diagnosis.volume;
  result["closed"] = diagnosis.closed();
  result["orientation"] = orientation(diagnosis);
  context.print("area       {:.9g}", diagnosis.area);
  if (diagnosis.closed() && diagnosis.consistently_oriented()) {
    context.print("volume     {:.9g}", diagnosis.volume);
  }
  context.print("closed     {}, orientation {}", diagnosis.closed() ? "yes" : "no",
                orientation(diagnosis));
  report_defects(diagnosis, context);
}

void report_samples(const Grid& grid, Context& context) {
  const glm::ivec3 dims = grid.dims();
  Json& result = context.result();
  result["dims"] = {dims.x, dims.y, dims.z};
  result["active_voxels"] = grid.active_voxels();
  result["bricks"] = grid.bricks();
  result["bytes"] = grid.bytes();
  context.print("samples    {} x {} x {}, {} active in {} bricks, {:.1f} MB in memory", dims.x,
                dims.y, dims.z, grid.active_voxels(), grid.bricks(),
                1e-6 * static_cast<double>(grid.bytes()));
  const std::map<int, PaintLook> looks = paint_looks(grid);
  for (const auto& [material, samples] : paint_counts(grid)) {
    result["paint"][std::to_string(material)] = samples;
    const auto look = looks.find(material);
    const std::string name = look != looks.end() ? fmt::format(" ({})", look->second.name) : "";
    context.print("paint      {} samples of material {}{}", samples, material, name);
  }
}

void report_metadata(const Grid& grid, double voxel, Context& context) {
  Json metadata = Json::object();
  for (const auto& [key, value] : grid.all_metadata()) {
    metadata[key] = value;
    if (key.starts_with("sdfgrid:")) context.print("{:<18} {}", key, value);
  }
  context.result()["metadata"] = metadata;
  const std::string stated = grid.metadata("sdfgrid:max_error");
  if (stated.empty()) return;
  const double error = std::strtod(stated.c_str(), nullptr);
  context.result()["max_error"] = error;
  context.result()["max_error_voxels"] = error / voxel;
}

void report_grid(const Grid& grid, Context& context) {
  const Lattice lattice = grid.lattice();
  const std::string grid_class = grid.grid_class();
  const double band = grid.background() / lattice.voxel;
  Json& result = context.result();
  result["kind"] = "grid";
  result["class"] = grid_class;
  result["name"] = grid.name();
  context.print("grid       '{}', class {}", grid.name(), grid_class);
  report_bounds(grid.bounds(), context);
  result["voxel"] = lattice.voxel;
  result["origin"] = triple(lattice.origin);
  result["background"] = grid.background();
  result["band"] = band;
  context.print("voxel      {:.9g}, index 0 at {:.9g} {:.9g} {:.9g}", lattice.voxel,
                lattice.origin.x, lattice.origin.y, lattice.origin.z);
  context.print("background {:.9g}: the band is {:.4g} voxels wide outside", grid.background(),
                band);
  report_samples(grid, context);
  report_metadata(grid, lattice.voxel, context);
}

void report_volume(const VolumeFile& file, Context& context) {
  const Volume& volume = file.volume;
  Json& result = context.result();
  result["kind"] = "volume";
  result["format"] = file.format;
  context.print("volume     {}, samples of type {}", file.format, type_name(volume.samples));
  Box box;
  for (int corner = 0; corner < 8; ++corner) {
    const glm::ivec3 upper(corner & 1, corner >> 1 & 1, corner >> 2);
    box.add(volume.to_world(glm::dvec3(upper * (volume.dims - 1))));
  }
  report_bounds(box, context);
  result["dims"] = {volume.dims.x, volume.dims.y, volume.dims.z};
  result["samples"] = volume.size();
  result["type"] = type_name(volume.samples);
  result["spacing"] = triple(volume.spacing);
  result["origin"] = triple(volume.origin);
  result["axes"] = {triple(volume.axes[0]), triple(volume.axes[1]), triple(volume.axes[2])};
  const SampleRange range = sample_range(volume, context.job());
  result["range"] = {range.lo, range.hi};
  context.print("samples    {} x {} x {}, {:.6g} to {:.6g}", volume.dims.x, volume.dims.y,
                volume.dims.z, range.lo, range.hi);
  context.print("spacing    {:.9g} {:.9g} {:.9g}, sample 0 at {:.9g} {:.9g} {:.9g}{}",
                volume.spacing.x, volume.spacing.y, volume.spacing.z, volume.origin.x,
                volume.origin.y, volume.origin.z,
                volume.axis_aligned() ? "" : ", axes turned or mirrored");
}

void report_scene(const std::string& path, double time, Context& context) {
  const SceneModel scene = load_scene(path, time, context);
  Json& result = context.result();
  result["kind"] = "scene";
  context.print("scene      at time {:g}", time);
  const Box box = scene.field.bounds();
  const bool ends = box.finite();
  if (ends) report_bounds(box, context);
  if (!ends) result["bounds"] = Json();
  result["instructions"] = scene.field.size();
  result["materials"] = scene.materials.size();
  context.print("program    {}, {}{}", counted(scene.field.size(), "instruction"),
                counted(scene.materials.size(), "material"), ends ? "" : "; without end");
}

Exit run(const Options& options, const CLI::App& app, Context& context) {
  const FileKind kind = kind_of_file(options.input);
  if (kind == FileKind::session || kind == FileKind::strokes) {
    if (kind == FileKind::session) report_session(options.input, context);
    if (kind == FileKind::strokes) report_strokes(options.input, context);
    return Exit::done;
  }
  check_options_for(app, {kind_of(options.input, false)});
  if (names_scene(options.input)) {
    report_scene(options.input, options.time, context);
    return Exit::done;
  }
  if (names_volume(options.input)) {
    report_volume(load_volume(options.input, options.volume, context), context);
    return Exit::done;
  }
  if (extension_of(options.input) == ".vdb") {
    report_grid(read_grid(options.input), context);
    return Exit::done;
  }
  const MeshFile file = load_mesh(options.input, context.job());
  for (const std::string& warning : file.warnings) context.warn(warning);
  report_mesh(file, context);
  return Exit::done;
}

}  // namespace

void report_bounds(const Box& box, Context& context) {
  context.result()["bounds"] = box.empty() ? Json() : Json{triple(box.lo), triple(box.hi)};
  if (box.empty()) return;
  const glm::dvec3 size = box.size();
  context.print("bounds     {:.9g} {:.9g} {:.9g} to {:.9g} {:.9g} {:.9g}", box.lo.x, box.lo.y,
                box.lo.z, box.hi.x, box.hi.y, box.hi.z);
  context.print("size       {:.9g} x {:.9g} x {:.9g}", size.x, size.y, size.z);
}

Run add_info(CLI::App& app) {
  auto options = std::make_shared<Options>();
  app.add_option("FILE", options->input,
                 "mesh (.obj, .ply, .stl, .off, .om), volume, grid (.vdb), scene (.yaml, .json), "
                 "stroke file or the folder of a session")
      ->required();
  add_volume_options(app, options->volume);
  add_scene_options(app, options->time);
  return [options, &app](Context& context) { return run(*options, app, context); };
}

}  // namespace sdfgrid::cli
