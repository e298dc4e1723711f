// SPDX-License-Identifier: Apache-2.0
/// What is known of noise parameters that were found, and in words what is not.
#pragma once

#include <Eigen/Core>
#include <functional>
#include <string>
#include <vector>

#include "quadtune/tuning/noise_fit.hpp"

namespace quadtune::internal {

/// A direction with less information is not seen: a standard deviation of more than 5 e-folds.
inline constexpr double kSeen = 0.04;
/// Loss of log-likelihood that no data tell from none.
inline constexpr double kNoLoss = 0.05;

/// The entries of `all` in the rows, or rows and columns, `free`.
[[nodiscard]] Eigen::VectorXd chosen(const Eigen::VectorXd& all, const std::vector<int>& free);
[[nodiscard]] Eigen::MatrixXd chosen(const Eigen::MatrixXd& all, const std::vector<int>& free);

/// The model's parameters by name, marked where fixed.
[[nodiscard]] std::vector<FittedParameter> unfitted_parameters(const FilterModel& model);

/// The same with their values at θ; how well they are known is not.
[[nodiscard]] std::vector<FittedParameter> parameters_at(const FilterModel& model,
                                                         const Eigen::VectorXd& theta);

/// Marks and names a parameter of which nothing depends.
void name_unmeasured(FittedParameter& parameter, std::vector<std::string>& unseen);

/// Standard errors of the free parameters from their information; the directions that are not seen
/// are named, and marked.
/// @param information  (p × p) of all of θ
void describe_seen(const Eigen::MatrixXd& information, const std::vector<int>& free,
                   std::vector<FittedParameter>& parameters, std::vector<std::string>& unseen);

/// Where a loss that is zero at `centre` has grown to `most` on one side.
/// @param side  -1 below, +1 above
/// @param step  a first guess of how far, > 0
/// @return      NaN where it does not grow so far
[[nodiscard]] double edge_of_loss(const std::function<double(double)>& loss, double most,
                                  double centre, int side, double step);

/// Quantile of the normal distribution that a two-sided interval of this confidence ends at.
[[nodiscard]] double deviations(double confidence);

}  // namespace quadtune::internal
