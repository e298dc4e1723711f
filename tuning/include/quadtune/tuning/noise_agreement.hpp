// SPDX-License-Identifier: Apache-2.0
/// Tests whether the covariances of maximum likelihood and of autocovariance least squares agree.
/// Both estimates are consistent if the model is right, so a significant difference indicates a
/// model error.
#pragma once

#include <cstddef>
#include <functional>
#include <limits>
#include <string>
#include <vector>

#include "quadtune/tuning/innovation_likelihood.hpp"
#include "quadtune/tuning/noise_fit.hpp"

namespace quadtune {

/// Methods that estimate covariances from logs.
enum class NoiseMethod { likelihood, autocovariances };

[[nodiscard]] std::string to_string(NoiseMethod method);  ///< "ml", "als"

/// Options of compare_methods().
struct AgreementOptions {
  double significance = 0.001;  ///< probability of a false alarm, for all parameters together
  double max_factor = 1.5;      ///< maximum ratio of two variances that count as equal in practice
  std::size_t threads = 0;      ///< as NoiseFitOptions::threads
  /// Called during the other fit; true interrupts it.
  std::function<bool()> interrupted = {};
};

/// A parameter by both methods.
struct ParameterAgreement {
  FittedParameter other;  ///< by the other method
  /// The larger variance over the smaller, ≥ 1; if one is zero, the other over its upper bound. NaN
  /// if one of them is not estimated, or if the parameter is not a variance.
  double factor = std::numeric_limits<double>::quiet_NaN();
  /// Distance of the logarithms in standard deviations √(σ₁² + σ₂²). This overestimates the
  /// standard deviation of their difference, as both use the same measurements and are correlated.
  /// If one variance is zero, the distance of the other from its upper bound.
  double deviations = std::numeric_limits<double>::quiet_NaN();
  bool disagrees = false;  ///< the difference is both large and significant
};

/// The comparison of the two methods.
struct NoiseAgreement {
  NoiseMethod other = NoiseMethod::autocovariances;  ///< the method that the fit did not use
  /// Why there is no comparison: the other method has no result; empty if it has.
  std::string not_compared;
  Eigen::VectorXd theta;                       ///< (p) by the other method
  std::vector<ParameterAgreement> parameters;  ///< in the order of the model
  /// One sentence for each parameter that disagrees.
  std::vector<std::string> disagreements;
};

/// Fits by the other method and compares the results. The intervals are valid if the model is
/// right, and then the two estimates agree (Hausman 1978); if they do not, the true uncertainty is
/// at least their distance.
/// @param fit      converged
/// @param method   the method of `fit`
/// @param likelihood  of the model and records of `fit`
/// @param options  significance and factor
[[nodiscard]] NoiseAgreement compare_methods(const NoiseFit& fit, NoiseMethod method,
                                             const InnovationLikelihood& likelihood,
                                             const AgreementOptions& options = {});

}  // namespace quadtune
