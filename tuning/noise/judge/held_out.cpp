// SPDX-License-Identifier: Apache-2.0
#include "noise/judge/held_out.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numbers>

#include "noise/log_gamma.hpp"
#include "quadtune/internal/counted.hpp"
#include "quadtune/internal/tails.hpp"

namespace quadtune::internal {
namespace {

using Eigen::Index;

/// Minimum number of innovations of a held-out part that passes.
constexpr Index kMinHeldOut = 30;

double log_density(double e, double S, double student) {
  if (student == 0) return -0.5 * (std::log(2 * std::numbers::pi * S) + e * e / S);
  return log_gamma(0.5 * (student + 1)) - log_gamma(0.5 * student) -
         0.5 * std::log(std::numbers::pi * student * S) -
         0.5 * (student + 1) * std::log1p(e * e / (student * S));
}

/// Comparison of the log-densities of the innovations that both runs have.
struct Comparison {
  /// Number of innovations, and of those that are less likely after the fit
  Index count = 0, worse = 0;
  double before = 0, after = 0;  ///< means
  double deviation = 0;          ///< of the mean of their differences
};

Comparison compare_densities(const FilterModel& model, const std::vector<FilterRun>& before,
                             const std::vector<FilterRun>& after) {
  Comparison result;
  double squares = 0;
  for (std::size_t r = 0; r < after.size(); ++r) {
    Index i = 0;
    for (const FilterSensor& sensor : model.sensors)
      for (Index row = 0; row < sensor.C.rows(); ++row, ++i)
        for (Index k = 0; k < after[r].innovation.cols(); ++k) {
          const double e0 = before[r].innovation(i, k), e1 = after[r].innovation(i, k);
          if (std::isnan(e0) || std::isnan(e1)) continue;
          const double l0 = log_density(e0, before[r].variance(i, k), sensor.student);
          const double l1 = log_density(e1, after[r].variance(i, k), sensor.student);
          ++result.count;
          if (l1 < l0) ++result.worse;
          result.before += l0;
          result.after += l1;
          squares += (l1 - l0) * (l1 - l0);
        }
  }
  const auto n = static_cast<double>(result.count);
  result.before /= n;
  result.after /= n;
  const double mean = result.after - result.before;
  result.deviation = std::sqrt(std::max(squares / n - mean * mean, 0.0) / n);
  return result;
}

/// Probability of at least `hits` of `count` if each has probability 1/2.
double sign_test(Index count, Index hits) {
  double sum = 0;
  const auto n = static_cast<double>(count);
  for (Index k = hits; k <= count; ++k) {
    const auto q = static_cast<double>(k);
    sum += std::exp(log_gamma(n + 1) - log_gamma(q + 1) - log_gamma(n - q + 1) -
                    n * std::numbers::ln2);
  }
  return sum;
}

/// Whether the log-likelihood decreased significantly. The differences of few innovations are not
/// normally distributed, so their signs must be significant as well.
bool is_worse(const Comparison& compared, double significance) {
  const double loss = compared.before - compared.after;
  if (compared.count >= kMinHeldOut)
    return loss > normal_exceeded(significance) * compared.deviation;
  if (compared.count < 2) return false;
  const auto n = static_cast<double>(compared.count);
  return student_above(loss / (compared.deviation * std::sqrt(n / (n - 1))), n - 1) <
             significance &&
         sign_test(compared.count, compared.worse) < significance;
}

}  // namespace

HoldOut judge_held_out(const FilterModel& model, const std::vector<FilterRun>& before,
                       const std::vector<FilterRun>& after, double significance) {
  const bool both = !before.empty();
  const Comparison compared = compare_densities(model, both ? before : after, after);
  HoldOut result;
  result.innovations = compared.count;
  if (compared.count > 0) {
    result.after = compared.after;
    if (both) result.before = compared.before;
  }
  if (compared.count > 0 &&
      (!std::isfinite(result.after) || (both && is_worse(compared, significance)))) {
    result.verdict = CheckVerdict::fail;
    result.reason = fmt::format(
        "the held-out part is less likely than before: {:.4g} per innovation instead of {:.4g}",
        result.after, result.before);
  } else if (compared.count < kMinHeldOut) {
    result.reason = fmt::format("{} held out, expected at least {} for a verdict",
                                internal::counted(compared.count, "innovation"), kMinHeldOut);
  } else {
    result.verdict = CheckVerdict::pass;
  }
  return result;
}

}  // namespace quadtune::internal
