// SPDX-License-Identifier: Apache-2.0
#include "quadtune/tuning/running_size.hpp"

#include <fmt/format.h>

#include <cmath>
#include <vector>

#include "quadtune/errors.hpp"
#include "quadtune/internal/tails.hpp"

namespace quadtune {

using Eigen::Index;

RunningSize normalized_innovation_window(const FilterRun& run, Index output, int window,
                                         double confidence) {
  if (run.status != LikelihoodStatus::computed || output < 0 || output >= run.innovation.rows() ||
      window < 1 || !(confidence > 0 && confidence < 1))
    throw InvalidInput("running size",
                       fmt::format("output {} of {}, a window of {} and a confidence of {}; "
                                   "expected a computed run, one of its outputs, 1 or more, "
                                   "and between 0 and 1",
                                   output, run.innovation.rows(), window, confidence));
  const Index N = run.innovation.cols();
  std::vector<Index> instants;
  std::vector<double> sums = {0};
  for (Index k = 0; k < N; ++k) {
    const double e = run.innovation(output, k);
    if (std::isnan(e)) continue;
    instants.push_back(k);
    sums.push_back(sums.back() + e * e / run.variance(output, k));
  }
  RunningSize result;
  result.value.setConstant(N, std::nan(""));
  const auto width = static_cast<std::size_t>(window);
  for (std::size_t first = 0; first + width <= instants.size(); ++first)
    result.value(instants[first + width / 2]) = (sums[first + width] - sums[first]) / window;
  result.low = internal::chi_squared_quantile(0.5 - 0.5 * confidence, window) / window;
  result.high = internal::chi_squared_quantile(0.5 + 0.5 * confidence, window) / window;
  return result;
}

}  // namespace quadtune
