// SPDX-License-Identifier: Apache-2.0
/// The innovations' autocovariances as a linear function of what noise covariances consist of.
#pragma once

#include <Eigen/Core>
#include <utility>
#include <vector>

#include "quadtune/estimation/filter_model.hpp"

namespace quadtune::internal {

/// What a covariance has of one number: of a variance, or of an entry of a full block.
struct NoiseTerm {
  int parameter = 0;         ///< θ, the logarithm; or the first of a block
  int row = -1, column = 0;  ///< in the block; row -1: a variance
  Eigen::MatrixXd Q;         ///< (nx × nx) of a step
  Eigen::MatrixXd R;         ///< (ny × ny)
};

/// A model from one measurement to the next, with the outputs in use.
struct SampledModel {
  double dt = 0;
  std::vector<Eigen::Index> outputs;  ///< in use, of the model's
  Eigen::MatrixXd F;                  ///< (nx × nx)
  Eigen::MatrixXd C;                  ///< (ny × nx)
  Eigen::MatrixXd D;                  ///< (ny × nu)
  Eigen::MatrixXd Q, R;               ///< what does not depend on θ
  std::vector<NoiseTerm> terms;       ///< what does, times their values
};

[[nodiscard]] SampledModel sample_model(const FilterModel& model, double dt,
                                        const std::vector<Eigen::Index>& outputs);

/// The numbers of the terms at θ.
[[nodiscard]] Eigen::VectorXd term_values(const SampledModel& model, const Eigen::VectorXd& theta);

/// Q of a step and R at θ.
[[nodiscard]] std::pair<Eigen::MatrixXd, Eigen::MatrixXd> noise_at(const SampledModel& model,
                                                                   const Eigen::VectorXd& theta);

/// Lags 0 … `lags` for a covariance Q of a step and R, (ny × ny) each; empty where F (I - M C) is
/// not stable.
[[nodiscard]] std::vector<Eigen::MatrixXd> autocovariances(const SampledModel& model,
                                                           const Eigen::MatrixXd& M,
                                                           const Eigen::MatrixXd& Q,
                                                           const Eigen::MatrixXd& R, int lags);

/// First and last lag of each group after lag 0.
using LagGroups = std::vector<std::pair<int, int>>;

/// At most `count` groups of 1 … `last`, as narrow as they can be, widening.
[[nodiscard]] LagGroups lag_groups(int last, int count);

/// Lag 0, its lower triangle column by column, then the mean of each group, column by column.
[[nodiscard]] Eigen::VectorXd moments_of(const std::vector<Eigen::MatrixXd>& lags,
                                         const LagGroups& groups);

/// Covariance of the moments that samples of a normal process with these autocovariances have.
/// @param gamma  lags 0, 1, …, as far as they matter
/// @param pairs  that the mean of each lag is of
/// Source: Bartlett 1946, for several outputs.
[[nodiscard]] Eigen::MatrixXd moment_covariance(const std::vector<Eigen::MatrixXd>& gamma,
                                                const LagGroups& groups,
                                                const std::vector<double>& pairs);

/// moments = constant + of values; empty where F (I - M C) is not stable.
struct MomentMap {
  Eigen::VectorXd constant;
  Eigen::MatrixXd of;  ///< one column a term; exactly 0 where the term does not reach the outputs
};

[[nodiscard]] MomentMap moment_map(const SampledModel& model, const Eigen::MatrixXd& M,
                                   const LagGroups& groups);

}  // namespace quadtune::internal
