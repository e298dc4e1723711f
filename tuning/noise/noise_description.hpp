// SPDX-License-Identifier: Apache-2.0
/// Uncertainty of estimated noise parameters, and descriptions of what the logs do not determine.
#pragma once

#include <Eigen/Core>
#include <functional>
#include <string>
#include <vector>

#include "quadtune/tuning/noise_fit.hpp"

namespace quadtune::internal {

/// Minimum information of a direction that counts as seen: below it the standard deviation exceeds
/// 5 e-folds.
inline constexpr double kSeen = 0.04;
/// Loss of log-likelihood that is negligible with any data.
inline constexpr double kNoLoss = 0.05;

/// The entries of `all` in the rows, or rows and columns, given by `free`.
[[nodiscard]] Eigen::VectorXd chosen(const Eigen::VectorXd& all, const std::vector<int>& free);
[[nodiscard]] Eigen::MatrixXd chosen(const Eigen::MatrixXd& all, const std::vector<int>& free);

/// The parameters of the model by name; fixed ones are marked.
[[nodiscard]] std::vector<FittedParameter> unfitted_parameters(const FilterModel& model);

/// The same with their values at θ, without their uncertainty.
[[nodiscard]] std::vector<FittedParameter> parameters_at(const FilterModel& model,
                                                         const Eigen::VectorXd& theta);

/// Marks and names a parameter on which no measurement depends.
void name_unmeasured(FittedParameter& parameter, std::vector<std::string>& unseen);

/// Computes standard errors of the free parameters from their information; marks and describes the
/// directions that are not determined.
/// @param information  (p × p) of all of θ
void describe_seen(const Eigen::MatrixXd& information, const std::vector<int>& free,
                   std::vector<FittedParameter>& parameters, std::vector<std::string>& unseen);

/// Computes the point on one side of `centre`, where the loss is zero, at which the loss is `most`.
/// @param side  -1 below, +1 above
/// @param step  initial guess of the distance, > 0
/// @return      NaN if the loss does not reach `most`
[[nodiscard]] double edge_of_loss(const std::function<double(double)>& loss, double max,
                                  double centre, int side, double step);

/// Quantile of the normal distribution at the end of a two-sided interval of this confidence.
[[nodiscard]] double deviations(double confidence);

}  // namespace quadtune::internal
