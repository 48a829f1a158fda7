#include "tolerance.h"

#include <algorithm>
#include <cmath>
#include <cstdlib>

#include "options.h"

namespace sdfgrid::cli {
namespace {

// The tolerance in world units: as it is, or a share of the longest side.
double parse_tolerance(const std::string& text, double size) {
  char* end = nullptr;
  const double value = std::strtod(text.c_str(), &end);
  const std::string rest = end;
  const bool percent = rest == "%";
  if (end == text.c_str() || !(percent || rest.empty()) || !std::isfinite(value) || value <= 0) {
    throw CLI::ValidationError("--tolerance",
                               "'" + text + "' is not a length as in 0.01, or a share as in 0.1%");
  }
  return percent ? 0.01 * value * size : value;
}

}  // namespace

CLI::Option* add_tolerance(CLI::App& app, ToleranceOptions& options) {
  auto* tolerance =
      app.add_option("--tolerance", options.tolerance,
                     "take the coarsest voxels and cheapest method whose measured error, "
                     "interpolation included, stays within this: world units, or 0.1% of the size")
          ->type_name("E");
  app.add_option("--budget-s", options.budget_seconds, "seconds that the search may take")
      ->check(CLI::PositiveNumber & finite_number())
      ->needs(tolerance);
  app.add_option("--budget-mb", options.budget_megabytes, "megabytes that a conversion may take")
      ->check(CLI::PositiveNumber & finite_number())
      ->needs(tolerance);
  return tolerance;
}

ChooseOptions choose_options(const ToleranceOptions& options, double longest_side) {
  ChooseOptions choose;
  choose.tolerance = parse_tolerance(options.tolerance, longest_side);
  choose.budget_seconds = options.budget_seconds;
  choose.budget_bytes = 1e6 * options.budget_megabytes;
  return choose;
}

void report_choice(const Choice& choice, const ChooseOptions& choose, Context& context) {
  Json& result = context.result();
  result["tolerance"] = choose.tolerance;
  result["error"] = choice.chosen.error;
  result["within"] = choice.within;
  result["trials"] = Json::array();
  for (const Trial& trial : choice.trials) {
    result["trials"].push_back({{"method", trial.method},
                                {"dim", trial.dim},
                                {"voxel", trial.voxel},
                                {"seconds", trial.seconds},
                                {"error", trial.error}});
    context.print(
        "tried {} at {} voxels along the longest side: error {}, {:.3f} s", trial.method, trial.dim,
        std::isnan(trial.error) ? "not measured, not quicker" : fmt::format("{:.4g}", trial.error),
        trial.seconds);
  }
  context.print("{} at voxel {:.6g}: error {:.4g}, {} the tolerance of {:.4g}",
                choice.chosen.method, choice.chosen.voxel, choice.chosen.error,
                choice.within ? "within" : "beyond", choose.tolerance);
  if (!choice.within) context.warn("the tolerance was missed: " + choice.why_not);
}

}  // namespace sdfgrid::cli
