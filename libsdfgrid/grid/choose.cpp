#include "sdfgrid/grid/choose.h"

#include <fmt/format.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <functional>
#include <limits>
#include <utility>

#include "sdfgrid/core/error.h"
#include "sdfgrid/core/memory.h"
#include "sdfgrid/core/parallel.h"
#include "sdfgrid/grid/compare_claims.h"
#include "sdfgrid/grid/methods.h"

namespace sdfgrid {
namespace {

using Clock = std::chrono::steady_clock;

double seconds_since(Clock::time_point start) {
  return std::chrono::duration<double>(Clock::now() - start).count();
}

// What the search is about: how it is converted, how far a grid of it is off, and about how many
// bytes a resolution takes.
struct Subject {
  std::function<Conversion(const ConvertMethod& method, int dim)> convert;
  std::function<double(const Grid& grid)> error;
  std::function<double(int dim)> bytes;
  double allowed_bytes = 0;  // for any conversion
};

// The search's state: what was tried, and what is best so far.
class Search {
 public:
  Search(Subject subject, const ChooseOptions& options)
      : subject_(std::move(subject)), options_(options) {
    if (!(options.tolerance > 0)) {
      throw Error(ErrorKind::usage, "the tolerance must be more than 0");
    }
  }

  // Resolutions from the coarsest on, by the first method; at the first one that is within, the
  // others.
  Choice run(const std::vector<ConvertMethod>& methods) {
    for (const int dim : choice_dims()) {
      choice_.why_not = obstacle(dim);
      if (!choice_.why_not.empty()) break;
      try {
        attempt(methods.front(), dim);
      } catch (const Error& error) {
        // More memory than estimated: what was found before is kept.
        if (error.kind() != ErrorKind::failed || choice_.trials.empty()) throw;
        choice_.why_not = error.what();
        break;
      }
      choice_.within = within(choice_.trials.back());
      if (choice_.within) break;
    }
    if (choice_.trials.empty()) {
      throw Error(ErrorKind::failed, choice_.why_not + ", which is over the budget");
    }
    if (!choice_.within) {
      if (choice_.why_not.empty()) choice_.why_not = "no finer resolution is tried";
      return std::move(choice_);
    }
    for (std::size_t m = 1; m < methods.size(); ++m) {
      if (!obstacle(choice_.chosen.dim).empty()) break;
      challenge(methods[m], choice_.chosen.dim);
    }
    return std::move(choice_);
  }

 private:
  struct Converted {
    Conversion conversion;
    Trial trial;
  };

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
    const double bytes = subject_.bytes(dim);
    const double budget = options_.budget_bytes > 0
                              ? std::min(options_.budget_bytes, subject_.allowed_bytes)
                              : subject_.allowed_bytes;
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

  [[nodiscard]] Converted converted(const ConvertMethod& method, int dim) const {
    const auto start = Clock::now();
    Conversion made = subject_.convert(method, dim);
    const Trial trial{method.name, dim, made.grid.lattice().voxel, seconds_since(start),
                      std::numeric_limits<double>::quiet_NaN()};
    return {std::move(made), trial};
  }
  void measure(const Conversion& made, Trial& trial) const {
    trial.error = subject_.error(made.grid);
  }
  void take(Conversion& made, const Trial& trial) {
    choice_.conversion = std::move(made);
    choice_.chosen = trial;
  }

  Subject subject_;
  const ChooseOptions& options_;
  Clock::time_point start_ = Clock::now();
  Choice choice_;
};

// The largest difference between trilinear values and the field, at random places in cells.
double error_between(const Grid& grid, const Field& field, const CompareOptions& options,
                     const Job& job) {
  constexpr std::size_t kRun = 512;
  const GridClaims claims(grid);
  std::vector<double> errors(options.samples);
  parallel_for(errors.size(), kRun, job, [&](std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i) {
      const auto claim = claims.in_cell(i, errors.size(), options.seed);
      if (!claim) continue;
      errors[i] = std::abs(claim->value - static_cast<double>(field(glm::vec3(claim->world))));
    }
  });
  return *std::max_element(errors.begin(), errors.end());
}

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
  const std::vector<ConvertMethod> methods = select_methods(options.methods, convert, false);
  const SurfaceTruth truth(soup, job);
  const auto at_dim = [&](int dim) {
    ConvertOptions with = convert;
    with.voxel = 0;
    with.dim = dim;
    return with;
  };
  Subject subject;
  subject.convert = [&](const ConvertMethod& method, int dim) {
    return method.convert(soup, at_dim(dim), job);
  };
  subject.error = [&](const Grid& grid) {
    return survey(grid, truth, options.compare, job).between.max_error;
  };
  subject.bytes = [&](int dim) {
    return estimate_memory(soup, choose_lattice(soup, at_dim(dim)), at_dim(dim));
  };
  subject.allowed_bytes = allowed_memory(convert.max_memory);
  return Search(std::move(subject), options).run(methods);
}

Choice choose_conversion(const Field& field, const FieldConvertOptions& convert,
                         const ChooseOptions& options, const Job& job) {
  if (!options.methods.empty()) {
    throw Error(ErrorKind::usage, "a scene has its own values: there is no method to choose");
  }
  double bytes = 0;  // of the last grid
  Subject subject;
  subject.convert = [&](const ConvertMethod&, int dim) {
    FieldConvertOptions with = convert;
    with.voxel = 0;
    with.dim = dim;
    Conversion made;
    made.grid = convert_field(field, with, job).grid;
    bytes = static_cast<double>(made.grid.bytes());
    return made;
  };
  subject.error = [&](const Grid& grid) {
    return error_between(grid, field, options.compare, job);
  };
  subject.bytes = [&](int) { return 2 * bytes; };
  subject.allowed_bytes = allowed_memory(convert.max_memory);
  ConvertMethod method;
  method.name = "field";
  return Search(std::move(subject), options).run({method});
}

}  // namespace sdfgrid
