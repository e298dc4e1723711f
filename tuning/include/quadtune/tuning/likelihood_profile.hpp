// SPDX-License-Identifier: Apache-2.0
/// Profile of the likelihood over one parameter, maximized over all others.
#pragma once

#include <Eigen/Core>

#include "quadtune/tuning/noise_fit.hpp"

namespace quadtune {

/// Options of likelihood_profile().
struct LikelihoodProfileOptions {
  int points = 31;           ///< number of points of the profile, ≥ 3
  double deviations = 4;     ///< half width of the profile in standard errors, > 0
  int max_iterations = 100;  ///< maximum number of iterations of the search at each point, > 0
};

/// The profile of one parameter.
struct LikelihoodProfile {
  Eigen::VectorXd theta;  ///< (points) values of the parameter, increasing
  /// (points) log-likelihood plus log-priors, minus their value at the fit; NaN if not computed.
  Eigen::VectorXd value;
};

/// Computes the profile of one parameter. For a parameter at zero it extends from well below its
/// upper bound to above it; for one that the logs do not determine, by three e-folds to both sides.
///
/// @param likelihood  of the model and its logs
/// @param fit         of this likelihood
/// @param parameter   its index; not fixed
/// @param options     range and number of points
/// @throws InvalidInput  for options out of range, or a fixed parameter.
[[nodiscard]] LikelihoodProfile likelihood_profile(const InnovationLikelihood& likelihood,
                                                   const NoiseFit& fit, int parameter,
                                                   const LikelihoodProfileOptions& options = {});

}  // namespace quadtune
