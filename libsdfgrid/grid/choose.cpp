#include "sdfgrid/grid/choose.h"

#include <fmt/format.h>

#include <algorithm>
#include <chrono>
#include <cmath>

#include "sdfgrid/core/error.h"
#include "sdfgrid/grid/methods.h"

namespace sdfgrid {
namespace {

using Clock = std::chrono::steady_clock;

double seconds_since(Clock::time_point start) {
  return std::chrono::duration<double>(Clock::now() - start).count();
}

std::vector<ConvertMethod> methods_of(const ChooseOptions& options) {
  std::vector<ConvertMethod> chosen;
  for (const ConvertMethod& method : convert_methods()) {
    const auto& names = options.methods;
    const bool named = std::find(names.begin(), names.end(), method.name) != names.end();
    if (names.empty() ? !method.peer : named) chosen.push_back(method);
  }
  if (chosen.empty() || (!options.methods.empty() && chosen.size() != options.methods.size())) {
    throw Error(ErrorKind::usage, "an unknown method is named for the choice");
  }
  return chosen;
}

// The search's state: what was tried, and what is best so far.
class Search {
 public:
  Search(const TriangleSoup& soup, const ConvertOptions& convert, const ChooseOptions& options,
         const Job& job)
      : soup_(soup), convert_(convert), options_(options), job_(job), truth_(soup, job) {}

  // Converts and measures; keeps the grid if it is the most accurate so far or `prefer` says so.
  template <class Prefer>
  void attempt(const ConvertMethod& method, int dim, const Prefer& prefer) {
    ConvertOptions convert = convert_;
    convert.voxel = 0;
    convert.dim = dim;
    const auto start = Clock::now();
    Conversion made = method.convert(soup_, convert, job_);
    Trial trial{method.name, dim, made.grid.lattice().voxel, seconds_since(start), 0};
    trial.error = survey(made.grid, truth_, options_.compare, job_).between.max_error;
    choice_.trials.push_back(trial);
    if (choice_.trials.size() == 1 || prefer(trial, choice_.chosen)) {
      choice_.conversion = std::move(made);
      choice_.chosen = trial;
    }
  }

  // Why the resolution must not be tried; empty if it may be.
  [[nodiscard]] std::string obstacle(int dim) const {
    ConvertOptions convert = convert_;
    convert.voxel = 0;
    convert.dim = dim;
    const double bytes = estimate_memory(soup_, choose_lattice(soup_, convert), convert_.band);
    if (options_.budget_bytes > 0 && bytes > options_.budget_bytes) {
      return fmt::format("{} voxels along the longest side would take about {:.0f} MB of memory",
                         dim, 1e-6 * bytes);
    }
    if (options_.budget_seconds > 0 && !choice_.trials.empty()) {
      // Time grows with the surface's voxels at most: twice for each step.
      const double next = 2 * choice_.trials.back().seconds;
      const double spent = seconds_since(start_);
      if (spent + next > options_.budget_seconds) {
        return fmt::format("{:.1f} s are spent and the next resolution would take about {:.1f} s",
                           spent, next);
      }
    }
    return "";
  }

  [[nodiscard]] bool within(const Trial& trial) const { return trial.error <= options_.tolerance; }
  Choice& choice() { return choice_; }

 private:
  const TriangleSoup& soup_;
  const ConvertOptions& convert_;
  const ChooseOptions& options_;
  const Job& job_;
  SurfaceTruth truth_;
  Clock::time_point start_ = Clock::now();
  Choice choice_;
};

}  // namespace

const std::vector<int>& choice_dims() {
  static const std::vector<int> all = [] {
    std::vector<int> dims;
    for (int half_steps = 6; half_steps <= 28; ++half_steps) {
      dims.push_back(static_cast<int>(std::lround(std::exp2(0.5 * half_steps))));
    }
    return dims;
  }();
  return all;
}

Choice choose_conversion(const TriangleSoup& soup, const ConvertOptions& convert,
                         const ChooseOptions& options, const Job& job) {
  if (!(options.tolerance > 0)) {
    throw Error(ErrorKind::usage, "the tolerance must be more than 0");
  }
  const std::vector<ConvertMethod> methods = methods_of(options);
  Search search(soup, convert, options, job);
  Choice& choice = search.choice();
  for (const int dim : choice_dims()) {
    choice.why_not = search.obstacle(dim);
    if (!choice.why_not.empty()) break;
    search.attempt(methods.front(), dim,
                   [](const Trial& now, const Trial& best) { return now.error < best.error; });
    choice.within = search.within(choice.trials.back());
    if (choice.within) break;
  }
  if (choice.trials.empty()) {
    throw Error(ErrorKind::failed, choice.why_not + ", which is over the budget");
  }
  if (!choice.within) {
    if (choice.why_not.empty()) choice.why_not = "no finer resolution is tried";
    return choice;
  }
  constexpr double kWorthIt = 0.8;
  for (std::size_t m = 1; m < methods.size(); ++m) {
    if (!search.obstacle(choice.chosen.dim).empty()) break;
    search.attempt(methods[m], choice.chosen.dim, [&](const Trial& now, const Trial& best) {
      return search.within(now) && now.seconds < kWorthIt * best.seconds;
    });
  }
  return choice;
}

}  // namespace sdfgrid
