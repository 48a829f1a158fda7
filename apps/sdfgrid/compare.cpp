// sdfgrid compare: how far a grid is from a mesh, or two of either from each other.
#include "sdfgrid/grid/compare.h"

#include <cstdlib>
#include <memory>
#include <optional>
#include <utility>
#include <variant>

#include "command.h"
#include "inputs.h"
#include "options.h"
#include "sdfgrid/core/error.h"
#include "sdfgrid/grid/grid.h"

namespace sdfgrid::cli {
namespace {

struct Options {
  std::string a;
  std::string b;
  CompareOptions compare;
  std::optional<double> tolerance;
  SurfaceOptions surface;
};

using Shape = std::variant<Grid, TriangleSoup>;

Shape load(const std::string& path, const Options& options, Context& context) {
  if (extension_of(path) == ".vdb") return read_distances(path, false);
  return load_surface(path, options.surface, context).soup;
}

// The keys of the contract for one summary; `voxel` is 0 where there is no grid.
Json keys_of(const ErrorSummary& summary, double voxel) {
  Json keys;
  keys["samples"] = summary.samples;
  const std::pair<const char*, double> errors[] = {{"max_error", summary.max_error},
                                                   {"rms_error", summary.rms_error},
                                                   {"p99_error", summary.p99_error},
                                                   {"mean_error", summary.mean_error}};
  for (const auto& [name, value] : errors) keys[name] = value;
  for (const auto& [name, value] : errors) {
    keys[std::string(name) + "_voxels"] = voxel > 0 ? Json(value / voxel) : Json();
  }
  keys["sign_errors"] = summary.sign_errors;
  keys["worst"] = {summary.worst.x, summary.worst.y, summary.worst.z};
  return keys;
}

void print_head(Context& context, const char* unit) {
  context.print("{:<22}{:>9}{:>12}{:>12}{:>12}{:>12}{:>13}", unit, "samples", "max", "p99", "rms",
                "mean", "wrong signs");
}

void print_row(Context& context, const char* name, const ErrorSummary& s, double unit) {
  context.print("{:<22}{:>9}{:>12.3g}{:>12.3g}{:>12.3g}{:>12.3g}{:>13}", name, s.samples,
                s.max_error / unit, s.p99_error / unit, s.rms_error / unit, s.mean_error / unit,
                s.sign_errors);
}

Exit verdict(const Options& options, bool within, Context& context) {
  if (!options.tolerance) return Exit::done;
  context.result()["tolerance"] = *options.tolerance;
  context.result()["within_tolerance"] = within;
  context.print("{} the tolerance of {:.6g}", within ? "within" : "outside", *options.tolerance);
  return within ? Exit::done : Exit::missed;
}

// What the grid's maker stated, beside what was measured: whether it holds.
bool check_stated(const Grid& grid, const Comparison& comparison, Context& context) {
  const std::string text = grid.metadata("sdfgrid:max_error");
  if (text.empty()) return true;
  const double stated = std::strtod(text.c_str(), nullptr);
  const bool holds = comparison.within(stated);
  context.result()["stated_max_error"] = stated;
  context.result()["stated_holds"] = holds;
  context.print("the grid states an error of at most {:.3g} ({:.3g} voxel), which {}", stated,
                stated / comparison.voxel, holds ? "holds" : "DOES NOT HOLD");
  return holds;
}

void report(const Comparison& comparison, Context& context) {
  for (const std::string& warning : comparison.warnings) context.warn(warning);
  const double voxel = comparison.voxel;
  Json& result = context.result();
  result["voxel"] = voxel;
  result.update(keys_of(comparison.voxels, voxel));
  result["sign_errors"] = comparison.sign_errors();
  result["signs"] = comparison.signs;
  result["undecided_signs"] = comparison.undecided_signs;
  result["voxels"] = keys_of(comparison.voxels, voxel);
  result["interpolated"] = keys_of(comparison.interpolated, voxel);
  result["inactive"] = keys_of(comparison.inactive, voxel);
  result["inactive"]["wrong_constants"] = comparison.wrong_constants;

  print_head(context, "errors in voxels");
  print_row(context, "at voxels", comparison.voxels, voxel);
  print_row(context, "between, interpolated", comparison.interpolated, voxel);
  print_row(context, "beyond the band", comparison.inactive, voxel);
  const glm::dvec3& worst = comparison.voxels.worst;
  context.print("voxel {:.6g}; largest error at a voxel {:.4g}, at {:.6g} {:.6g} {:.6g}", voxel,
                comparison.voxels.max_error, worst.x, worst.y, worst.z);
  if (!comparison.signs) context.print("one side has no signs: absolute values were compared");
  if (comparison.undecided_signs > 0) {
    context.print(
        "{} samples have no definite side, for the mesh is open or its triangles disagree: "
        "absolute values there",
        comparison.undecided_signs);
  }
  if (comparison.wrong_constants > 0) {
    context.print("{} inactive samples hold neither background", comparison.wrong_constants);
  }
}

void report(const SurfaceComparison& surfaces, Context& context) {
  const bool a_is_worse = surfaces.a_to_b.max_error > surfaces.b_to_a.max_error;
  Json& result = context.result();
  result = keys_of(a_is_worse ? surfaces.a_to_b : surfaces.b_to_a, 0);
  result["voxel"] = Json();
  result["sign_errors"] = Json();
  result["hausdorff"] = surfaces.hausdorff();
  result["a_to_b"] = keys_of(surfaces.a_to_b, 0);
  result["b_to_a"] = keys_of(surfaces.b_to_a, 0);
  print_head(context, "distances");
  print_row(context, "first to second", surfaces.a_to_b, 1);
  print_row(context, "second to first", surfaces.b_to_a, 1);
}

Exit compare_meshes(const TriangleSoup& a, const TriangleSoup& b, const Options& options,
                    Context& context) {
  const SurfaceComparison surfaces = compare(a, b, options.compare, context.job());
  report(surfaces, context);
  return verdict(options, surfaces.hausdorff() <= options.tolerance.value_or(0), context);
}

Exit compare_grids(const Grid& a, const Grid& b, const Options& options, Context& context) {
  const Comparison comparison = compare(a, b, options.compare, context.job());
  report(comparison, context);
  return verdict(options, comparison.within(options.tolerance.value_or(0)), context);
}

Exit compare_with_mesh(const Grid& grid, const TriangleSoup& mesh, const Options& options,
                       Context& context) {
  const Comparison comparison = compare(grid, mesh, options.compare, context.job());
  report(comparison, context);
  const bool holds = check_stated(grid, comparison, context);
  const Exit asked = verdict(options, comparison.within(options.tolerance.value_or(0)), context);
  return options.tolerance || holds ? asked : Exit::missed;
}

Exit run(const Options& options, const CLI::App& app, Context& context) {
  // A .vdb is a grid here, with --iso too: that is for the other side.
  check_options_for(app, {kind_of(options.a, false), kind_of(options.b, false)});
  Stopwatch watch;
  const Shape a = load(options.a, options, context);
  const Shape b = load(options.b, options, context);
  watch.lap("read");
  const auto measure = [&] {
    const auto* grid_a = std::get_if<Grid>(&a);
    const auto* grid_b = std::get_if<Grid>(&b);
    if (grid_a != nullptr && grid_b != nullptr) {
      return compare_grids(*grid_a, *grid_b, options, context);
    }
    if (grid_a != nullptr) {
      return compare_with_mesh(*grid_a, std::get<TriangleSoup>(b), options, context);
    }
    if (grid_b != nullptr) {
      return compare_with_mesh(*grid_b, std::get<TriangleSoup>(a), options, context);
    }
    return compare_meshes(std::get<TriangleSoup>(a), std::get<TriangleSoup>(b), options, context);
  };
  const Exit exit = measure();
  watch.lap("compare");
  context.result()["seconds"] = watch.seconds();
  return exit;
}

}  // namespace

Run add_compare(CLI::App& app) {
  auto options = std::make_shared<Options>();
  app.add_option("A", options->a, "grid (.vdb), mesh, or volume")->required();
  app.add_option("B", options->b, "grid (.vdb), mesh, or volume")->required();
  app.add_option("--samples", options->compare.samples, "voxels, and places between, to measure at")
      ->check(whole_number(1, std::int64_t{1} << 32))
      ->capture_default_str();
  app.add_option("--seed", options->compare.seed, "another one draws other places")
      ->capture_default_str();
  app.add_option("--tolerance", options->tolerance,
                 "exit with 3 if a stored value is off by more than this (world units) or has the "
                 "wrong sign; for two meshes, if their distance is more. If not given, the error "
                 "that the grid states takes its place")
      ->check(CLI::NonNegativeNumber & finite_number());
  add_surface_options(app, options->surface);
  return [options, &app](Context& context) { return run(*options, app, context); };
}

}  // namespace sdfgrid::cli
