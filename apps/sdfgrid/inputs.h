// apps/sdfgrid/inputs.h: what subcommands take as input: meshes, volumes with a value at which
// their surface lies, grids. One place decides what a path names, and which options that makes
// sense of.
#pragma once

#include <CLI/CLI.hpp>
#include <glm/vec3.hpp>
#include <optional>
#include <string>
#include <vector>

#include "command.h"
#include "sdfgrid/grid/grid.h"
#include "sdfgrid/mesh/read.h"
#include "sdfgrid/mesh/soup.h"
#include "sdfgrid/volume/read.h"
#include "sdfgrid/volume/volume.h"

namespace sdfgrid::cli {

// "-2,0.5,1e3" as three finite numbers. Throws CLI::ValidationError for the named option.
[[nodiscard]] glm::dvec3 parse_vector(const std::string& option, const std::string& text);

// How a volume is read where its file says too little.
struct VolumeOptions {
  std::optional<glm::ivec3> raw_dims;  // raw files: all of `raw` counts once this is given
  RawLayout raw;
  std::optional<glm::dvec3> spacing;  // instead of the file's
};

// Registers --spacing and the --raw-... options.
void add_volume_options(CLI::App& app, VolumeOptions& options);

// Whether load_volume() reads a file of this name: volumes, stacks of pictures, TIFFs.
[[nodiscard]] bool names_volume(const std::string& path);

// Reads a volume, a stack of pictures, or the scalar field of a .vdb; warnings go to the context.
[[nodiscard]] VolumeFile load_volume(const std::string& path, const VolumeOptions& options,
                                     Context& context);

// How a surface comes out of a volume.
struct SurfaceOptions {
  VolumeOptions volume;
  std::optional<double> iso;
  bool inside_below = false;
  bool largest = false;
};

// Registers --iso, --below and --largest, and the volume options.
void add_surface_options(CLI::App& app, SurfaceOptions& options);

// A mesh, from a file or out of a volume.
struct Surface {
  TriangleSoup soup;
  std::string source;  // "mesh" or "volume"
  double spacing = 0;  // the volume's smallest; 0 for meshes
  double read_seconds = 0;
  double isosurface_seconds = 0;
};

enum class InputKind { mesh, volume, grid, scene };

// What a path names. A .vdb is a volume if --iso is given, else a grid.
[[nodiscard]] InputKind kind_of(const std::string& path, bool iso);

// Refuses options that would have no effect. Throws Error{usage}, naming the option, if one was
// given that none of the inputs' kinds makes sense of.
void check_options_for(const CLI::App& app, const std::vector<InputKind>& inputs);

// Reads the distances of a .vdb. Throws Error{input} for what holds no distances, such as fog, and,
// if `sides`, for distances without inside and outside.
[[nodiscard]] Grid read_distances(const std::string& path, bool sides);

// Reads a mesh. Throws Error{input}, which says what the path names
// instead, for volumes, grids and what is only written.
[[nodiscard]] MeshFile load_mesh(const std::string& path, const Job& job);

// Reads a mesh, or a volume and its surface at --iso. Throws Error{usage} for a volume without
// --iso, naming the range of its samples.
[[nodiscard]] Surface load_surface(const std::string& path, const SurfaceOptions& options,
                                   Context& context);

}  // namespace sdfgrid::cli
