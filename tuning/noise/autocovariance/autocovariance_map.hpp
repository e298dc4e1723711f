// SPDX-License-Identifier: Apache-2.0
/// The autocovariances of the innovations as a linear function of the terms of the noise
/// covariances.
#pragma once

#include <Eigen/Core>
#include <utility>
#include <vector>

#include "quadtune/estimation/filter_model.hpp"

namespace quadtune::internal {

/// Contribution of one number to the covariances: of a variance, or of an entry of a full block.
struct NoiseTerm {
  /// Index in θ of the logarithm of the variance, or of the first entry of a block
  int parameter = 0;
  int row = -1, column = 0;  ///< position in the block; row -1: a variance
  Eigen::MatrixXd Q;         ///< (nx × nx) for one step
  Eigen::MatrixXd R;         ///< (ny × ny)
};

/// A model of the step from one measurement to the next, with the outputs in use.
struct SampledModel {
  double dt = 0;
  std::vector<Eigen::Index> outputs;  ///< indices of the outputs in use, among those of the model
  Eigen::MatrixXd F;                  ///< (nx × nx)
  Eigen::MatrixXd C;                  ///< (ny × nx)
  Eigen::MatrixXd D;                  ///< (ny × nu)
  Eigen::MatrixXd Q, R;               ///< the part that does not depend on θ
  std::vector<NoiseTerm> terms;       ///< the part that does: each term is multiplied by its value
};

[[nodiscard]] SampledModel sample_model(const FilterModel& model, double dt,
                                        const std::vector<Eigen::Index>& outputs);

/// The values of the terms at θ.
[[nodiscard]] Eigen::VectorXd term_values(const SampledModel& model, const Eigen::VectorXd& theta);

/// Q of one step and R at θ.
[[nodiscard]] std::pair<Eigen::MatrixXd, Eigen::MatrixXd> noise_at(const SampledModel& model,
                                                                   const Eigen::VectorXd& theta);

/// Autocovariances at lags 0 … `lags` for a covariance Q of one step and R, (ny × ny) each; empty
/// if F (I - M C) is not stable.
[[nodiscard]] std::vector<Eigen::MatrixXd> autocovariances(const SampledModel& model,
                                                           const Eigen::MatrixXd& M,
                                                           const Eigen::MatrixXd& Q,
                                                           const Eigen::MatrixXd& R, int lags);

/// First and last lag of each group after lag 0.
using LagGroups = std::vector<std::pair<int, int>>;

/// Splits the lags 1 … `last` into at most `count` groups, as narrow as possible, with increasing
/// width.
[[nodiscard]] LagGroups lag_groups(int last, int count);

/// The moments: the lower triangle of lag 0, column by column, then the mean of each group, column
/// by column.
[[nodiscard]] Eigen::VectorXd moments_of(const std::vector<Eigen::MatrixXd>& lags,
                                         const LagGroups& groups);

/// Covariance of the sample moments of a normal process with these autocovariances.
/// @param gamma  lags 0, 1, …, up to the lag at which they vanish
/// @param pairs  number of pairs in the mean of each lag
/// Source: Bartlett 1946, for several outputs.
[[nodiscard]] Eigen::MatrixXd moment_covariance(const std::vector<Eigen::MatrixXd>& gamma,
                                                const LagGroups& groups,
                                                const std::vector<double>& pairs);

/// moments = constant + of · values; empty if F (I - M C) is not stable.
struct MomentMap {
  Eigen::VectorXd constant;
  Eigen::MatrixXd of;  ///< one column per term; exactly 0 if the term does not affect the outputs
};

[[nodiscard]] MomentMap moment_map(const SampledModel& model, const Eigen::MatrixXd& M,
                                   const LagGroups& groups);

}  // namespace quadtune::internal
