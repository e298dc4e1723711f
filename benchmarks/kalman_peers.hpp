// SPDX-License-Identifier: Apache-2.0
/// The same likelihoods by statsmodels and R, run as programs that measure their own time.
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
  // For a fit only:
  double evaluations = 0;
  Eigen::VectorXd variances;
};

enum class KalmanPeer { statsmodels, r };
/// Peers and their variants: statsmodels decides itself when the covariance is steady, or never
/// treats it as steady; R never does.
enum class PeerTask { likelihood, every_step, fit };

/// Runs a peer on the problem without its inputs: their effect is subtracted from the outputs
/// beforehand, which costs the peer no time and does not change the likelihood. Requires uniform
/// time and a known start.
///
/// @param start  (2) for a fit: logarithms of the only variances of Q and R.
/// @return       nothing if the peer is not installed
[[nodiscard]] std::optional<PeerLikelihood> ask_peer(KalmanPeer peer, PeerTask task,
                                                     const KalmanProblem& problem,
                                                     const Eigen::VectorXd& start = {});

}  // namespace quadtune::bench
