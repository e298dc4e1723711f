// SPDX-License-Identifier: Apache-2.0
/// Whether a filter's innovations are what its covariances say: size, whiteness, mean, shape.
#pragma once

#include <Eigen/Core>
#include <limits>
#include <string>
#include <vector>

#include "quadtune/tuning/innovation_likelihood.hpp"

namespace quadtune {

/// Limits of a verdict. What is checked must be both significant, as a long log makes any small
/// flaw, and large enough to matter; or else too uncertain to tell. A large flaw that is
/// significant fails at any count; that there is none takes samples.
struct ConsistencyOptions {
  double significance = 0.001;    ///< of each check: probability of a false alarm, 0 … 0.5
  int lags = 20;                  ///< of the autocorrelation, ≥ 1
  double most_correlation = 0.1;  ///< of innovations at any of these lags
  double most_mean = 0.1;         ///< in standard deviations
  double least_size = 0.8;        ///< of the mean of e²/S
  double most_size = 1.25;
  double most_kurtosis = 3;  ///< excess, where 0 is normal: 3 is that of rare large errors
  /// Of each output. With fewer nothing passes, and a flaw has to be significant among all checks.
  Eigen::Index least_samples = 100;
};

/// @throws InvalidInput  for options out of range.
void validate(const ConsistencyOptions& options);

enum class CheckVerdict { pass, fail, too_short };

/// One check of one output, or of all.
struct ConsistencyCheck {
  std::string name;    ///< "size", "whiteness", "mean", "normality"
  std::string output;  ///< "sonar: height", or "all"
  double value = std::numeric_limits<double>::quiet_NaN();
  double low = std::numeric_limits<double>::quiet_NaN();  ///< band of a consistent filter
  double high = std::numeric_limits<double>::quiet_NaN();
  double p = std::numeric_limits<double>::quiet_NaN();  ///< of a value as far off, if consistent
  CheckVerdict verdict = CheckVerdict::pass;
  std::string reason = {};  ///< one line; empty where it passes
};

/// Statistics of one output's standardized innovations z = e/√S; of a sensor with Student's
/// distribution, the normal deviates that are as rare.
struct InnovationStatistics {
  std::string output;                                          ///< "sonar: height"
  Eigen::Index samples = 0;                                    ///< compared
  double mean = std::numeric_limits<double>::quiet_NaN();      ///< of z
  double size = std::numeric_limits<double>::quiet_NaN();      ///< mean of z²: 1
  double kurtosis = std::numeric_limits<double>::quiet_NaN();  ///< excess: 0
  double skewness = std::numeric_limits<double>::quiet_NaN();  ///< 0
  /// (lags) of z with itself so many samples of this output before.
  Eigen::VectorXd autocorrelation;
  double ljung_box = std::numeric_limits<double>::quiet_NaN();    ///< of these lags
  double ljung_box_p = std::numeric_limits<double>::quiet_NaN();  ///< by χ² of as many degrees
};

struct Consistency {
  std::vector<InnovationStatistics> outputs;
  std::vector<ConsistencyCheck> checks;
  CheckVerdict verdict = CheckVerdict::too_short;
  std::vector<std::string> reasons;  ///< of a verdict that is not pass
};

/// @param runs   of all records, in the order of their times; records are not correlated with each
///               other
/// @throws InvalidInput  for options out of range, or a run that is not computed.
/// Sources: Bar-Shalom, Li and Kirubarajan 2001, section 5.4; Ljung and Box 1978; Jarque and Bera
/// 1980; for few innovations Anscombe and Glynn 1983.
[[nodiscard]] Consistency check_consistency(const FilterModel& model,
                                            const std::vector<FilterRun>& runs,
                                            const ConsistencyOptions& options = {});

[[nodiscard]] std::string to_string(CheckVerdict verdict);

}  // namespace quadtune
