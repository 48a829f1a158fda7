#include "sdfgrid/grid/choose.h"

#include <fmt/format.h>

#include <chrono>
#include <cmath>
#include <limits>
#include <utility>

#include "sdfgrid/core/error.h"
#include "sdfgrid/grid/methods.h"

namespace sdfgrid {
namespace {

using Clock = std::chrono::steady_clock;

double seconds_since(Clock::time_point start) {
  return std::chrono::duration<double>(Clock::now() - start).count();
}

// The search's state: what was tried, and what is best so far.
class Search {
 public:
  Search(const TriangleSoup& soup, const ConvertOptions& convert, const ChooseOptions& options,
         const Job& job)
      : soup_(soup), convert_(convert), options_(options), job_(job), truth_(soup, job) {}

  // Converts and measures; keeps the grid if it is the most accurate so far.
  void attempt(const ConvertMethod& method, int dim) {
    auto [made, trial] = converted(method, dim);
    measure(made, trial);
    choice_.trials.push_back(trial);
    if (choice_.trials.size() == 1 || trial.error < choice_.chosen.error) take(made, trial);
  }

  // Converts, and measures if that was much quicker; keeps the grid if it is within then.
  void challenge(const ConvertMethod& method, int dim) {
    constexpr double kWorthIt = 0.8;
    try {
      auto [made, trial] = converted(method, dim);
      const bool quicker = trial.seconds <= kWorthIt * choice_.chosen.seconds;
      if (quicker) measure(made, trial);
      choice_.trials.push_back(trial);
      if (quicker && within(trial)) take(made, trial);
    } catch (const Error& error) {
      // A band that the method cannot do, or memory that only it would need.
      if (error.kind() != ErrorKind::usage && error.kind() != ErrorKind::failed) throw;
    }
  }

  // Why the resolution must not be tried; empty if it may be.
  [[nodiscard]] std::string obstacle(int dim) const {
    ConvertOptions convert = convert_;
    convert.voxel = 0;
    convert.dim = dim;
    const double bytes = estimate_memory(soup_, choose_lattice(soup_, convert), convert);
    const double allowed = allowed_memory(convert);
    const double budget =
        options_.budget_bytes > 0 ? std::min(options_.budget_bytes, allowed) : allowed;
    if (bytes > budget) {
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
  struct Converted {
    Conversion conversion;
    Trial trial;
  };

  [[nodiscard]] Converted converted(const ConvertMethod& method, int dim) const {
    ConvertOptions convert = convert_;
    convert.voxel = 0;
    convert.dim = dim;
    const auto start = Clock::now();
    Conversion made = method.convert(soup_, convert, job_);
    const Trial trial{method.name, dim, made.grid.lattice().voxel, seconds_since(start),
                      std::numeric_limits<double>::quiet_NaN()};
    return {std::move(made), trial};
  }
  void measure(const Conversion& made, Trial& trial) const {
    trial.error = survey(made.grid, truth_, options_.compare, job_).between.max_error;
  }
  void take(Conversion& made, const Trial& trial) {
    choice_.conversion = std::move(made);
    choice_.chosen = trial;
  }

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
  const std::vector<ConvertMethod> methods = select_methods(options.methods, convert, false);
  Search search(soup, convert, options, job);
  Choice& choice = search.choice();
  for (const int dim : choice_dims()) {
    choice.why_not = search.obstacle(dim);
    if (!choice.why_not.empty()) break;
    search.attempt(methods.front(), dim);
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
  for (std::size_t m = 1; m < methods.size(); ++m) {
    if (!search.obstacle(choice.chosen.dim).empty()) break;
    search.challenge(methods[m], choice.chosen.dim);
  }
  return choice;
}

}  // namespace sdfgrid
