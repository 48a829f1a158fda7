#include "convert_made.h"

#include <algorithm>
#include <variant>

#include "sdfgrid/grid/dense.h"
#include "sdfgrid/grid/paint.h"
#include "sdfgrid/volume/write.h"

namespace sdfgrid::cli {
namespace {

// How large what was made is.
struct Extent {
  glm::ivec3 dims;
  double voxel;
  std::size_t active_voxels, bricks, bytes;
};

Extent extent_of(const Grid& grid) {
  return {grid.dims(), grid.lattice().voxel, grid.active_voxels(), grid.bricks(), grid.bytes()};
}

Extent extent_of(const Volume& volume) {
  return {volume.dims, volume.spacing.x, volume.size(), 0, volume.size() * sizeof(float)};
}

// What the grid says of itself to whoever opens it later (docs/architecture.md, "Metadata").
void stamp(Made& made, const std::string& source) {
  made.grid.set_metadata("sdfgrid:method", made.method);
  made.grid.set_metadata("sdfgrid:sign", made.sign);
  made.grid.set_metadata("sdfgrid:source", source.substr(source.find_last_of('/') + 1));
  if (made.max_error) made.grid.set_metadata("sdfgrid:max_error", *made.max_error);
  made.grid.set_metadata("sdfgrid:version", SDFGRID_VERSION);
}

bool has_inside(const Made& made) {
  if (!made.dense) return made.grid.has_inside();
  const auto& samples = std::get<std::vector<float>>(made.dense->samples);
  return std::any_of(samples.begin(), samples.end(), [](float d) { return d < 0; });
}

// As all samples of a box: around the band, or the dense field's own.
void save_densely(Made& made, const std::string& path, Context& context) {
  const auto write = [&](const Volume& volume) {
    made.origin = volume.origin;
    write_volume(volume, path, context.job());
  };
  return made.dense ? write(*made.dense) : write(to_volume(made.grid));
}

}  // namespace

Band band_of(const ConvertRequest& options) {
  return {options.exwidth > 0 ? options.exwidth : options.width,
          options.inwidth > 0 ? options.inwidth : options.width};
}

void check_voxel(const ConvertRequest& options, double voxel) {
  if (becomes_grid(options)) check_storable(voxel);
}

void warn_of_nothing(const Made& made, const std::string& source, Context& context) {
  if (!made.dense && made.grid.active_voxels() == 0) {
    return context.warn("the grid is empty: no voxel is near the " + source +
                        "; use a smaller --voxel");
  }
  if (made.sign == "unsigned" || has_inside(made)) return;
  context.warn(
      "the grid has no inside: the " + source +
      " is thinner than its voxels; use a smaller --voxel, or for a sheet --sign unsigned");
}

void warn_of_lost_paint(const std::string& path, Context& context) {
  context.warn(path + ": this format holds no paint, which is left out; .vdb and .nvdb do");
}

bool becomes_grid(const ConvertRequest& options) {
  return !has_extension(options.output.path, volume_extensions());
}

void make_sparse(Made& made, const ConvertRequest& options) {
  if (!made.dense) return;
  made.grid = to_grid(*made.dense, band_of(options).exwidth * made.dense->spacing.x);
  made.dense.reset();
}

void save(Made& made, const ConvertRequest& options, Context& context) {
  const std::string& path = options.output.path;
  context.job().report("write", 0.0);
  context.job().checkpoint();
  if (!becomes_grid(options)) {
    if (!made.dense && has_paint(made.grid)) warn_of_lost_paint(path, context);
    return save_densely(made, path, context);
  }
  make_sparse(made, options);
  if (kind_of(options.input, false) != InputKind::grid || options.surface.iso) {
    stamp(made, options.input);
  }
  write_grid(made.grid, path);
}

void describe(const Made& made, const ConvertRequest& options, Context& context) {
  const Extent extent = made.dense ? extent_of(*made.dense) : extent_of(made.grid);
  const glm::ivec3& dims = extent.dims;
  Json& result = context.result();
  result["method"] = made.method;
  result["sign"] = made.sign;
  result["sign_reason"] = made.sign_reason;
  result["voxel"] = extent.voxel;
  result["dims"] = {dims.x, dims.y, dims.z};
  result["active_voxels"] = extent.active_voxels;
  result["bricks"] = extent.bricks;
  result["bytes"] = extent.bytes;
  if (made.max_error) result["max_error"] = *made.max_error;
  if (made.origin) result["origin"] = {made.origin->x, made.origin->y, made.origin->z};
  context.print("{}: {} x {} x {} samples, voxel {:.6g}, {} active in {} bricks, {:.1f} MB",
                options.output.path, dims.x, dims.y, dims.z, extent.voxel, extent.active_voxels,
                extent.bricks, 1e-6 * static_cast<double>(extent.bytes));
  if (made.origin) {
    context.print("sample 0 at {:.9g} {:.9g} {:.9g}", made.origin->x, made.origin->y,
                  made.origin->z);
  }
  context.print("method {}{}; sign {}: {}", made.method,
                made.max_error
                    ? fmt::format(", error at most {:.1g} voxel", *made.max_error / extent.voxel)
                    : "",
                made.sign, made.sign_reason);
}

}  // namespace sdfgrid::cli
