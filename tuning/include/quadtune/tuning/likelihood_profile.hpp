// SPDX-License-Identifier: Apache-2.0
/// How the likelihood falls to both sides of one parameter, the others at their best.
#pragma once

#include <Eigen/Core>

#include "quadtune/tuning/noise_fit.hpp"

namespace quadtune {

struct LikelihoodProfileOptions {
  int points = 31;           ///< of the profile, ≥ 3
  double deviations = 4;     ///< that it reaches to both sides, in standard errors, > 0
  int max_iterations = 100;  ///< of the search at each point, > 0
};

struct LikelihoodProfile {
  Eigen::VectorXd theta;  ///< (points) of the parameter, increasing
  /// (points) log-likelihood and log-priors less what they are at the fit; NaN where there is none.
  Eigen::VectorXd value;
};

/// Of a parameter that is at zero the profile goes from well below its upper bound to beyond it; of
/// one that the logs do not tell, three e-folds to both sides.
///
/// @param fit        of this likelihood
/// @param parameter  its index; not fixed
/// @throws InvalidInput  for options out of range, or a parameter that was not to be found.
[[nodiscard]] LikelihoodProfile likelihood_profile(const InnovationLikelihood& likelihood,
                                                   const NoiseFit& fit, int parameter,
                                                   const LikelihoodProfileOptions& options = {});

}  // namespace quadtune
