// SPDX-License-Identifier: Apache-2.0
/// Tests whether the innovations of a filter agree with their covariances: size, whiteness, mean
/// and shape.
#pragma once

#include <Eigen/Core>
#include <limits>
#include <string>
#include <vector>

#include "quadtune/tuning/innovation_likelihood.hpp"

namespace quadtune {

/// Limits of the consistency checks. A check fails if its statistic deviates significantly and by
/// enough to matter: in a long log any small deviation is significant. A large and significant
/// deviation fails with any number of samples; a pass requires enough samples, otherwise the
/// verdict is too_short.
struct ConsistencyOptions {
  double significance = 0.001;   ///< probability of a false alarm of each check, 0 … 0.5
  int lags = 20;                 ///< of the autocorrelation, ≥ 1
  double max_correlation = 0.1;  ///< maximum autocorrelation of innovations at any of these lags
  double max_mean = 0.1;         ///< maximum mean, in standard deviations
  double min_size = 0.8;         ///< minimum of the mean of e²/S
  double max_size = 1.25;        ///< maximum of the mean of e²/S
  double max_kurtosis = 3;  ///< maximum excess kurtosis; 0 is normal, 3 that of rare large errors
  /// Minimum number of samples of each output. With fewer samples nothing passes, and a deviation
  /// must be significant among all checks.
  Eigen::Index min_samples = 100;
};

/// @throws InvalidInput  for options out of range.
void validate(const ConsistencyOptions& options);

/// The verdict of a check; too_short: too few samples.
enum class CheckVerdict { pass, fail, too_short };

/// One check of one output, or of all outputs.
struct ConsistencyCheck {
  std::string name;    ///< "size", "whiteness", "mean", "normality"
  std::string output;  ///< "sonar: height", or "all"
  double value = std::numeric_limits<double>::quiet_NaN();  ///< the tested statistic
  double low = std::numeric_limits<double>::quiet_NaN();    ///< interval of a consistent filter
  double high = std::numeric_limits<double>::quiet_NaN();   ///< upper end of that interval
  /// Probability of a value at least as far off, if consistent
  double p = std::numeric_limits<double>::quiet_NaN();
  CheckVerdict verdict = CheckVerdict::pass;  ///< of this check
  std::string reason = {};                    ///< one line; empty if the check passes
};

/// Statistics of the standardized innovations z = e/√S of one output. For a sensor with Student's
/// distribution z is the normal deviate of the same probability.
struct InnovationStatistics {
  std::string output;                                          ///< "sonar: height"
  Eigen::Index samples = 0;                                    ///< number of innovations
  double mean = std::numeric_limits<double>::quiet_NaN();      ///< of z
  double size = std::numeric_limits<double>::quiet_NaN();      ///< mean of z²; expected 1
  double kurtosis = std::numeric_limits<double>::quiet_NaN();  ///< excess kurtosis; expected 0
  double skewness = std::numeric_limits<double>::quiet_NaN();  ///< expected 0
  /// (lags) autocorrelation of z at lags 1, 2, …, in samples of this output.
  Eigen::VectorXd autocorrelation;
  /// Ljung-Box statistic over these lags
  double ljung_box = std::numeric_limits<double>::quiet_NaN();
  /// Its p-value by χ² with as many degrees of freedom as lags
  double ljung_box_p = std::numeric_limits<double>::quiet_NaN();
};

/// The checks of all outputs.
struct Consistency {
  std::vector<InnovationStatistics> outputs;       ///< one for each output
  std::vector<ConsistencyCheck> checks;            ///< of every output, then of all
  CheckVerdict verdict = CheckVerdict::too_short;  ///< fail if a check fails
  std::vector<std::string> reasons;                ///< why the verdict is not pass
};

/// @param model    of the runs
/// @param runs     one per record, in time order; records are assumed to be uncorrelated with each
///                 other
/// @param options  limits of the checks
/// @throws InvalidInput  for options out of range, or a run that was not computed.
/// Sources: Bar-Shalom, Li and Kirubarajan 2001, section 5.4; Ljung and Box 1978; Jarque and Bera
/// 1980; for few innovations Anscombe and Glynn 1983.
[[nodiscard]] Consistency check_consistency(const FilterModel& model,
                                            const std::vector<FilterRun>& runs,
                                            const ConsistencyOptions& options = {});

/// "pass", "fail" or "too short to tell".
[[nodiscard]] std::string to_string(CheckVerdict verdict);

}  // namespace quadtune
