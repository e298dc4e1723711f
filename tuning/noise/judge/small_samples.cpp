// SPDX-License-Identifier: Apache-2.0
#include "noise/judge/small_samples.hpp"

#include <algorithm>
#include <cmath>

#include "quadtune/internal/tails.hpp"

namespace quadtune::internal {
namespace {

using Eigen::Index;

/// Minimum number of samples for a correlation, and for a kurtosis.
constexpr Index kMinCorrelated = 6;
constexpr Index kMinShaped = 8;

/// Degrees of freedom of Pearson's correlation with the variance at this lag.
double degrees_of(Index samples, Index lag) {
  const auto n = static_cast<double>(samples), k = static_cast<double>(lag);
  return n * (n + 2) / (n - k) - 1;
}

}  // namespace

LargestCorrelation largest_correlation(const Eigen::Ref<const Eigen::VectorXd>& autocorrelation,
                                       Index samples) {
  LargestCorrelation result;
  if (samples < kMinCorrelated) return result;
  for (Index i = 0; i < autocorrelation.size(); ++i) {
    const double r = autocorrelation(i), degrees = degrees_of(samples, i + 1);
    const double t = std::abs(r) < 1 ? std::abs(r) * std::sqrt(degrees / (1 - r * r)) : 1e100;
    const double p = 2 * student_above(t, degrees);
    if (result.lag > 0 && !(p < result.p)) continue;
    result = {r, i + 1, p};
  }
  result.p = std::min(1.0, result.p * static_cast<double>(autocorrelation.size()));
  return result;
}

double correlation_exceeded(double p, Index samples) {
  if (samples < kMinCorrelated) return 1;
  const double degrees = degrees_of(samples, 1), t = student_exceeded(p, degrees);
  return t / std::sqrt(degrees + t * t);
}

double kurtosis_p(double kurtosis, Index samples) {
  if (samples < kMinShaped) return 1;
  const auto n = static_cast<double>(samples);
  const double variance =
      24 * n * (n - 2) * (n - 3) / ((n + 1) * (n + 1) * (n + 3) * (n + 5));  // of m4/m2²
  const double x = (kurtosis + 3 - 3 * (n - 1) / (n + 1)) / std::sqrt(variance);
  const double skewness = 6 * (n * n - 5 * n + 2) / ((n + 7) * (n + 9)) *
                          std::sqrt(6 * (n + 3) * (n + 5) / (n * (n - 2) * (n - 3)));
  // The cube root of a quotient with A degrees of freedom is approximately normal (Wilson and
  // Hilferty).
  const double A = 6 + 8 / skewness * (2 / skewness + std::sqrt(1 + 4 / (skewness * skewness)));
  const double denominator = 1 + x * std::sqrt(2 / (A - 4));
  if (!(denominator > 0)) return 1;
  const double z =
      (1 - 2 / (9 * A) - std::cbrt((1 - 2 / A) / denominator)) / std::sqrt(2 / (9 * A));
  return normal_above(z);
}

}  // namespace quadtune::internal
