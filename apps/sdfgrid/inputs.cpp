#include "inputs.h"

#include <algorithm>
#include <cmath>
#include <cstdio>

#include "options.h"
#include "scenes.h"
#include "sdfgrid/core/error.h"
#include "sdfgrid/grid/dense.h"
#include "sdfgrid/grid/grid.h"
#include "sdfgrid/image/stack.h"
#include "sdfgrid/mesh/read.h"
#include "sdfgrid/scene/file_kind.h"
#include "sdfgrid/volume/isosurface.h"
#include "sdfgrid/volume/regions.h"

namespace sdfgrid::cli {
namespace {

glm::ivec3 parse_dims(const std::string& text) {
  const glm::dvec3 v = parse_vector("--raw-dims", text);
  const glm::ivec3 dims(v);
  if (glm::dvec3(dims) != v || dims.x < 1 || dims.y < 1 || dims.z < 1) {
    throw CLI::ValidationError("--raw-dims", "'" + text + "' is not a size as in 256,256,108");
  }
  return dims;
}

glm::dvec3 parse_spacing(const std::string& text) {
  const glm::dvec3 v = parse_vector("--spacing", text);
  if (!(v.x > 0 && v.y > 0 && v.z > 0)) {
    throw CLI::ValidationError("--spacing", "'" + text + "' must be three numbers above 0");
  }
  return v;
}

struct OptionUse {
  const char* option;
  std::vector<InputKind> kinds;  // that it has an effect on
};

// What a grid is made from; a grid itself has its voxels and band already.
const std::vector<InputKind> kMade = {InputKind::mesh, InputKind::volume, InputKind::scene};

// Whatever is not here has an effect on every input of the subcommands that take it.
const std::vector<OptionUse> kOptionUses = {
    {"--iso", {InputKind::volume}},
    {"--below", {InputKind::volume}},
    {"--largest", {InputKind::volume}},
    {"--spacing", {InputKind::volume}},
    {"--raw-dims", {InputKind::volume}},
    {"--time", {InputKind::scene}},
    {"--sign", {InputKind::mesh, InputKind::volume}},
    {"--method", {InputKind::mesh, InputKind::volume}},
    {"--methods", {InputKind::mesh, InputKind::volume}},
    {"--bucket", {InputKind::mesh, InputKind::volume}},
    {"--mask", {InputKind::mesh, InputKind::volume}},
    {"--dim", kMade},
    {"--voxel", kMade},
    {"--dense", kMade},
    {"--width", kMade},
    {"--exwidth", kMade},
    {"--inwidth", kMade},
    {"--max-memory", kMade},
};

std::string plural(InputKind kind) {
  switch (kind) {
    case InputKind::mesh:
      return "meshes";
    case InputKind::volume:
      return "volumes";
    case InputKind::grid:
      return "grids";
    case InputKind::scene:
      break;
  }
  return "scenes";
}

// Samples at or above a value are inside of fog; of a level set they would be outside.
VolumeFile read_fog(const std::string& path) {
  const Grid grid = read_scalar_grid(path);
  if (grid.is_level_set()) {
    throw input_error(path, "", "it holds a level set, distances that are negative inside, no fog",
                      "use it as the grid that it is, without --iso; `sdfgrid convert` makes a "
                      "volume of it");
  }
  VolumeFile file;
  file.format = "OpenVDB";
  file.volume = to_volume(grid, 1);
  return file;
}

VolumeFile read_any_volume(const std::string& path, const VolumeOptions& options,
                           Context& context) {
  if (extension_of(path) == ".vdb") {
    return read_fog(path);
  }
  if (is_stack_name(path)) return read_image_stack(path, context.job());
  std::optional<RawLayout> raw;
  if (options.raw_dims) {
    raw = options.raw;
    raw->dims = *options.raw_dims;
  } else if (extension_of(path) == ".raw") {
    throw Error(ErrorKind::usage,
                path + ": a raw file says nothing of itself; give --raw-dims X,Y,Z and --raw-type");
  }
  return read_volume(path, raw, context.job());
}

}  // namespace

glm::dvec3 parse_vector(const std::string& option, const std::string& text) {
  glm::dvec3 v;
  int used = 0;
  const bool three = std::sscanf(text.c_str(), "%lf,%lf,%lf%n", &v.x, &v.y, &v.z, &used) == 3;
  const bool finite = std::isfinite(v.x) && std::isfinite(v.y) && std::isfinite(v.z);
  if (!three || static_cast<std::size_t>(used) != text.size() || !finite) {
    throw CLI::ValidationError(option, "'" + text + "' is not three numbers as in 1,0.5,-2");
  }
  return v;
}

void add_volume_options(CLI::App& app, VolumeOptions& options) {
  app.add_option_function<std::string>(
         "--spacing",
         [&options](const std::string& text) { options.spacing = parse_spacing(text); },
         "distance between a volume's samples, instead of what its file says")
      ->type_name("X,Y,Z");
  auto* dims = app.add_option_function<std::string>(
                      "--raw-dims",
                      [&options](const std::string& text) { options.raw_dims = parse_dims(text); },
                      "shape of a .raw file, whose first axis runs fastest")
                   ->type_name("X,Y,Z");
  std::vector<std::pair<std::string, std::string>> types;
  for (const std::string& name : type_names()) types.emplace_back(name, name);
  add_choice(app, "--raw-type", options.raw.type, types, "its samples")->needs(dims);
  app.add_flag("--raw-big-endian", options.raw.big_endian, "the greatest byte comes first")
      ->needs(dims);
  app.add_option("--raw-skip", options.raw.skip, "bytes before its first sample")->needs(dims);
}

bool names_volume(const std::string& path) { return is_volume_name(path) || is_stack_name(path); }

VolumeFile load_volume(const std::string& path, const VolumeOptions& options, Context& context) {
  VolumeFile file = read_any_volume(path, options, context);
  for (const std::string& warning : file.warnings) context.warn(path + ": " + warning);
  if (options.spacing) file.volume.spacing = *options.spacing;
  return file;
}

void add_surface_options(CLI::App& app, SurfaceOptions& options) {
  app.add_option("--iso", options.iso,
                 "value of a volume's samples at its surface; inside are those at or above it")
      ->check(finite_number())
      ->type_name("V");
  app.add_flag("--below", options.inside_below, "inside are the samples below --iso instead");
  app.add_flag("--largest", options.largest,
               "only the largest connected piece inside, without supports and noise");
  add_volume_options(app, options.volume);
}

InputKind kind_of(const std::string& path, bool iso) {
  const FileKind kind = kind_of_file(path);
  if (kind == FileKind::session || kind == FileKind::strokes) {
    throw input_error(path, "", fmt::format("it is {}, which is not taken here", noun_of(kind)),
                      way_to_grid(kind, path));
  }
  if (names_scene(path)) return InputKind::scene;
  if (names_volume(path)) return InputKind::volume;
  if (extension_of(path) == ".vdb") return iso ? InputKind::volume : InputKind::grid;
  return InputKind::mesh;
}

void check_options_for(const CLI::App& app, const std::vector<InputKind>& inputs) {
  for (const OptionUse& use : kOptionUses) {
    const CLI::Option* option = app.get_option_no_throw(use.option);
    if (option == nullptr || option->count() == 0) continue;
    const bool used = std::any_of(inputs.begin(), inputs.end(), [&](InputKind kind) {
      return std::find(use.kinds.begin(), use.kinds.end(), kind) != use.kinds.end();
    });
    if (used) continue;
    std::vector<std::string> kinds;
    for (const InputKind kind : use.kinds) kinds.push_back(plural(kind));
    throw Error(ErrorKind::usage, fmt::format("{} is for {}, not for {}", use.option, one_of(kinds),
                                              plural(inputs.front())));
  }
}

Grid read_distances(const std::string& path, bool sides) {
  Grid grid = read_grid(path);
  const std::string word = grid.grid_class();
  if (grid.is_level_set() || (word == "unknown" && !sides)) return grid;
  if (grid.metadata("sdfgrid:sign") == "unsigned") {
    throw input_error(path, "", "its distances have no sign, and so no inside",
                      "convert the mesh with --sign winding, or use the mesh itself");
  }
  throw input_error(path, "", fmt::format("its class is '{}', not 'level set'", word),
                    "where --iso is taken, give with it the value at the surface; or make a level "
                    "set by `sdfgrid convert --iso`");
}

MeshFile load_mesh(const std::string& path, const Job& job) {
  const std::string extension = extension_of(path);
  if (names_volume(path)) {
    throw input_error(path, "name", "it is a volume, which is not taken here",
                      "make a grid of it by `sdfgrid convert --iso V`, and give that");
  }
  if (extension == ".nvdb" || extension == ".vti") {
    throw input_error(path, "name", fmt::format("{} files are written, but not read", extension),
                      "give the .vdb or the .nrrd of the same");
  }
  if (extension == ".vdb") {
    throw input_error(path, "name", "it is a grid, which is not taken here",
                      "give the mesh or scene that it was made from");
  }
  return read_mesh(path, job);
}

Surface load_surface(const std::string& path, const SurfaceOptions& options, Context& context) {
  const Job& job = context.job();
  Stopwatch watch;
  Surface surface;
  if (kind_of(path, options.iso.has_value()) != InputKind::volume) {
    MeshFile mesh = load_mesh(path, job);
    for (const std::string& warning : mesh.warnings) context.warn(path + ": " + warning);
    surface.soup = std::move(mesh.soup);
    surface.source = "mesh";
    surface.read_seconds = watch.seconds()["total"];
    return surface;
  }
  VolumeFile file = load_volume(path, options.volume, context);
  watch.lap("read");
  if (!options.iso) {
    const SampleRange range = sample_range(file.volume, job);
    throw Error(ErrorKind::usage,
                fmt::format("{}: give --iso V, the value at the surface; samples are {:.6g} to "
                            "{:.6g}",
                            path, range.lo, range.hi));
  }
  surface.source = "volume";
  const glm::dvec3& spacing = file.volume.spacing;
  surface.spacing = std::min({spacing.x, spacing.y, spacing.z});
  const IsosurfaceOptions isosurface_options{*options.iso, !options.inside_below};
  if (options.largest) (void)keep_largest_region(file.volume, isosurface_options, job);
  surface.soup = isosurface(file.volume, isosurface_options, job);
  watch.lap("isosurface");
  surface.read_seconds = watch.seconds()["read"];
  surface.isosurface_seconds = watch.seconds()["isosurface"];
  return surface;
}

}  // namespace sdfgrid::cli
