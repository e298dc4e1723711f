// SPDX-License-Identifier: Apache-2.0
/// The same likelihoods by statsmodels and R, as programs that time themselves.
#pragma once

#include <Eigen/Core>
#include <optional>
#include <string>

#include "kalman_problems.hpp"

namespace quadtune::bench {

struct PeerLikelihood {
  std::string name;
  double seconds = 0;  ///< of one evaluation, or of the fit
  double value = 0;    ///< log-likelihood
  // Of a fit:
  double evaluations = 0;
  Eigen::VectorXd variances;
};

enum class KalmanPeer { statsmodels, r };
/// What of it: statsmodels decides when the covariance is steady, or never does; R never does.
enum class PeerTask { likelihood, every_step, fit };

/// Gives a peer the problem without its inputs: what they make of the outputs is subtracted before,
/// which costs the peer nothing and changes no likelihood. Uniform time, a start that is known.
///
/// @param start  (2) of a fit: logarithms of Q's and R's only variance.
/// @return       nothing where the peer is not installed
[[nodiscard]] std::optional<PeerLikelihood> ask_peer(KalmanPeer peer, PeerTask task,
                                                     const KalmanProblem& problem,
                                                     const Eigen::VectorXd& start = {});

}  // namespace quadtune::bench
