// SPDX-License-Identifier: Apache-2.0
/// Whether the likeliest covariances and those of the autocovariances are the same: both are right
/// where the model is, so that what parts them is not chance but the model.
#pragma once

#include <cstddef>
#include <functional>
#include <limits>
#include <string>
#include <vector>

#include "quadtune/tuning/innovation_likelihood.hpp"
#include "quadtune/tuning/noise_fit.hpp"

namespace quadtune {

enum class NoiseMethod { likelihood, autocovariances };

[[nodiscard]] std::string to_string(NoiseMethod method);  ///< "ml", "als"

struct AgreementOptions {
  double significance = 0.001;  ///< of all parameters together: probability of a false alarm
  double most_factor = 1.5;     ///< between two variances that are the same for what they are used
  std::size_t threads = 0;      ///< as NoiseFitOptions::threads
  /// Asked during the other fit; ends it where true.
  std::function<bool()> interrupted = {};
};

/// A parameter by both methods.
struct ParameterAgreement {
  FittedParameter other;  ///< by the other method
  /// The larger variance over the smaller, ≥ 1; where one is zero, over that one's upper bound. NaN
  /// where one of them is not found, or no variance.
  double factor = std::numeric_limits<double>::quiet_NaN();
  /// Distance of the logarithms in standard deviations √(σ₁² + σ₂²): more than their difference
  /// has, as both are of the same measurements and hang together. Where one variance is zero, of
  /// the other from that one's upper bound.
  double deviations = std::numeric_limits<double>::quiet_NaN();
  bool disagrees = false;  ///< both large and significant
};

struct NoiseAgreement {
  NoiseMethod other = NoiseMethod::autocovariances;  ///< the method that the fit was not made by
  /// Why there is nothing to compare: the other method has no answer here; "" where it has.
  std::string not_compared;
  Eigen::VectorXd theta;                       ///< (p) of the other method
  std::vector<ParameterAgreement> parameters;  ///< in the order of the model's
  /// What is said of each parameter that disagrees, a sentence each.
  std::vector<std::string> disagreements;
};

/// Fits by the other method and compares. Each interval holds if the model is right, and then both
/// estimates meet (Hausman 1978); where they do not, the true uncertainty is at least their
/// distance.
/// @param fit     converged
/// @param method  that made it
/// @param likelihood  of the model and the records that it is of
[[nodiscard]] NoiseAgreement compare_methods(const NoiseFit& fit, NoiseMethod method,
                                             const InnovationLikelihood& likelihood,
                                             const AgreementOptions& options = {});

}  // namespace quadtune
