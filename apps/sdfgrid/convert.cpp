// sdfgrid convert: a mesh to a sparse distance grid.
#include "sdfgrid/grid/convert.h"

#include <memory>

#include "command.h"
#include "options.h"
#include "sdfgrid/core/error.h"
#include "sdfgrid/mesh/read.h"

namespace sdfgrid::cli {
namespace {

enum class Method { exact };

struct Options {
  std::string input;
  Output output;
  ConvertOptions convert;
  Method method = Method::exact;
  double width = 3.0;
  double exwidth = 0;  // 0: as --width
  double inwidth = 0;
};

const std::vector<std::pair<std::string, Method>> kMethods = {{"exact", Method::exact}};

const std::vector<std::pair<std::string, SignMethod>> kSigns = {{"auto", SignMethod::automatic},
                                                                {"normal", SignMethod::normal},
                                                                {"winding", SignMethod::winding},
                                                                {"unsigned", SignMethod::no_sign}};

Band band_of(const Options& options) {
  return {options.exwidth > 0 ? options.exwidth : options.width,
          options.inwidth > 0 ? options.inwidth : options.width};
}

void describe(const Conversion& conversion, const Options& options, Context& context) {
  const Grid& grid = conversion.grid;
  glm::ivec3 lo;
  glm::ivec3 hi;
  grid.active_bounds(lo, hi);
  const glm::ivec3 dims = hi - lo + 1;
  Json& result = context.result();
  result["method"] = "exact";
  result["sign"] = sign_name(conversion.sign);
  result["sign_reason"] = conversion.sign_reason;
  result["voxel"] = grid.lattice().voxel;
  result["dims"] = {dims.x, dims.y, dims.z};
  result["active_voxels"] = grid.active_voxels();
  result["bricks"] = grid.bricks();
  result["bytes"] = grid.bytes();
  result["max_error"] = kConvertError * grid.lattice().voxel;
  context.print("{}: {} x {} x {} samples, voxel {:.6g}, {} active in {} bricks, {:.1f} MB",
                options.output.path, dims.x, dims.y, dims.z, grid.lattice().voxel,
                grid.active_voxels(), grid.bricks(), 1e-6 * static_cast<double>(grid.bytes()));
  context.print("method exact, error at most {:.1g} voxel; sign {}: {}", kConvertError,
                sign_name(conversion.sign), conversion.sign_reason);
}

// What the grid says of itself to whoever opens it later (docs/architecture.md, "Metadata").
void stamp(Grid& grid, const Conversion& conversion, const std::string& source) {
  grid.set_metadata("sdfgrid:method", "exact");
  grid.set_metadata("sdfgrid:sign", sign_name(conversion.sign));
  grid.set_metadata("sdfgrid:source", source.substr(source.find_last_of('/') + 1));
  grid.set_metadata("sdfgrid:max_error", kConvertError * grid.lattice().voxel);
  grid.set_metadata("sdfgrid:version", SDFGRID_VERSION);
}

Exit run(const Options& options, Context& context) {
  check_output(options.output);
  Stopwatch watch;
  const MeshFile mesh = read_mesh(options.input, context.job());
  for (const std::string& warning : mesh.warnings) context.warn(warning);
  watch.lap("read");
  ConvertOptions convert = options.convert;
  convert.band = band_of(options);
  check_storable(choose_lattice(mesh.soup, convert).voxel);
  Conversion conversion = convert_mesh(mesh.soup, convert, context.job());
  for (const std::string& warning : conversion.warnings) context.warn(warning);
  watch.lap("convert");
  stamp(conversion.grid, conversion, options.input);
  context.job().report("write", 0.0);
  context.job().checkpoint();
  write_grid(conversion.grid, options.output.path);
  watch.lap("write");
  describe(conversion, options, context);
  Json seconds = watch.seconds();
  seconds.erase("convert");
  seconds["sign"] = conversion.seconds.sign;
  seconds["voxelize"] = conversion.seconds.voxelize;
  seconds["transform"] = conversion.seconds.assemble;
  context.result()["seconds"] = seconds;
  context.print(
      "read {:.3f} s, sign {:.3f} s, voxelize {:.3f} s, assemble {:.3f} s, write {:.3f} s",
      seconds["read"].get<double>(), conversion.seconds.sign, conversion.seconds.voxelize,
      conversion.seconds.assemble, seconds["write"].get<double>());
  return Exit::done;
}

}  // namespace

Run add_convert(CLI::App& app) {
  auto options = std::make_shared<Options>();
  app.add_option("IN", options->input, "mesh: .obj, .ply, .stl, .off or .om")->required();
  add_output(app, options->output, {".vdb"});
  auto* voxel = app.add_option("--voxel", options->convert.voxel, "voxel size, world units")
                    ->check(CLI::PositiveNumber & finite_number());
  app.add_option("--dim", options->convert.dim, "voxels along the longest side")
      ->check(CLI::Range(1, 100000))
      ->capture_default_str()
      ->excludes(voxel);
  add_choice(app, "--method", options->method, kMethods, "how distances are made");
  app.add_option("--width", options->width, "half-width of the band, voxels")
      ->check(CLI::Range(1.0, 1000.0) & finite_number())
      ->capture_default_str();
  app.add_option("--exwidth", options->exwidth, "the same outside only")
      ->check(CLI::Range(1.0, 1000.0) & finite_number());
  app.add_option("--inwidth", options->inwidth, "the same inside only")
      ->check(CLI::Range(1.0, 1000.0) & finite_number());
  add_choice(app, "--sign", options->convert.sign, kSigns, "how inside and outside are told apart");
  app.add_option("--max-memory", options->convert.max_memory,
                 "refuse to take more than this, as in 8GB (default: 80 % of what is free)")
      ->transform(CLI::AsSizeValue(false));
  return [options](Context& context) { return run(*options, context); };
}

}  // namespace sdfgrid::cli
