#include "sdfgrid/grid/compare_summary.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace sdfgrid {

ErrorSummary summarize(const std::vector<SampleError>& samples) {
  ErrorSummary summary;
  std::vector<double> errors;
  errors.reserve(samples.size());
  double sum = 0;
  double squares = 0;
  for (const SampleError& sample : samples) {
    if (!sample.counts) continue;
    const double error =
        std::isnan(sample.error) ? std::numeric_limits<double>::infinity() : sample.error;
    if (errors.empty() || error > summary.max_error) {
      summary.max_error = error;
      summary.worst = sample.world;
    }
    errors.push_back(error);
    sum += error;
    squares += error * error;
    summary.sign_errors += sample.sign_error ? 1 : 0;
  }
  summary.samples = errors.size();
  if (errors.empty()) return summary;
  const auto count = static_cast<double>(errors.size());
  summary.mean_error = sum / count;
  summary.rms_error = std::sqrt(squares / count);
  const auto rank = static_cast<std::ptrdiff_t>(std::ceil(0.99 * count)) - 1;
  std::nth_element(errors.begin(), errors.begin() + rank, errors.end());
  summary.p99_error = errors[static_cast<std::size_t>(rank)];
  return summary;
}

}  // namespace sdfgrid
