// SPDX-License-Identifier: Apache-2.0
/// Tests of white noise and of normality that are valid for few samples, for which the asymptotic
/// limits are not.
#pragma once

#include <Eigen/Core>

namespace quadtune::internal {

/// The least probable autocorrelation of a series under white noise.
struct LargestCorrelation {
  double value = 0;
  Eigen::Index lag = 0;  ///< in samples; 0: there is none
  /// Probability of one as improbable among all these lags, if the series is white
  double p = 1;
};

/// Computes the least probable correlation. Each correlation r has the variance
/// (n - lag) / (n (n + 2)) and is treated as a Pearson correlation of the same variance, so that r
/// √(ν / (1 - r²)) has Student's distribution; for n = 6 … 99 normal numbers the probability is
/// right or conservative.
/// @param autocorrelation  at lags 1, 2, …, about the mean
/// @param samples          n; there is no result below 6
/// Sources: Dixon 1944; Ljung and Box 1978.
[[nodiscard]] LargestCorrelation largest_correlation(
    const Eigen::Ref<const Eigen::VectorXd>& autocorrelation, Eigen::Index samples);

/// The correlation at a lag of one sample that white noise exceeds with this probability; 1 if
/// there are too few samples.
[[nodiscard]] double correlation_exceeded(double p, Eigen::Index samples);

/// Probability of an excess kurtosis at least this large for this many normal numbers; 1 for fewer
/// than 8.
/// Source: Anscombe and Glynn 1983.
[[nodiscard]] double kurtosis_p(double kurtosis, Eigen::Index samples);

}  // namespace quadtune::internal
