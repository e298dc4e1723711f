// SPDX-License-Identifier: Apache-2.0
/// Tests of white noise and of normality that hold for few samples, where the limits of many do
/// not.
#pragma once

#include <Eigen/Core>

namespace quadtune::internal {

/// Of the autocorrelations of a series, that which white noise has least often.
struct LargestCorrelation {
  double value = 0;
  Eigen::Index lag = 0;  ///< in samples; 0: there is none to look at
  double p = 1;          ///< of one as rare among all these lags, if the series is white
};

/// Each correlation r has the variance (n - lag) / (n (n + 2)) and is taken for one of Pearson's of
/// as large a variance, so that r √(ν / (1 - r²)) is Student's; that of n = 6 … 99 normal numbers
/// is as rare as it says or rarer.
/// @param autocorrelation  at lags 1, 2, …, about the mean
/// @param samples          n; below 6 nothing is told
/// Sources: Dixon 1944; Ljung and Box 1978.
[[nodiscard]] LargestCorrelation largest_correlation(
    const Eigen::Ref<const Eigen::VectorXd>& autocorrelation, Eigen::Index samples);

/// A correlation at a lag of one sample that white noise exceeds with this probability; 1 where
/// there are too few samples.
[[nodiscard]] double correlation_exceeded(double p, Eigen::Index samples);

/// Probability of an excess kurtosis as large, of so many normal numbers; 1 below 8 of them.
/// Source: Anscombe and Glynn 1983.
[[nodiscard]] double kurtosis_p(double kurtosis, Eigen::Index samples);

}  // namespace quadtune::internal
