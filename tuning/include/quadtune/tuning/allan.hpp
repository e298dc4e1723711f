// SPDX-License-Identifier: Apache-2.0
/// Allan deviation of a stationary sensor, and the noise coefficients computed from it.
#pragma once

#include <Eigen/Core>
#include <array>
#include <cstddef>
#include <string>
#include <vector>

namespace quadtune {

/// Two- or three-sample deviations. All are computed from means over tau = m dt.
enum class AllanKind {
  plain,        ///< Allan, from adjacent means
  overlapping,  ///< Allan, from all overlapping means; the usual choice
  /// Allan, also averaged over m phases: separates white from flicker phase noise
  modified,
  time,   ///< tau / √3 times the modified deviation
  total,  ///< Allan, on the phase extended by reflection: more terms at long tau
  /// Of second differences, from adjacent means: insensitive to a linear drift
  hadamard,
  overlapping_hadamard,  ///< likewise from all overlapping means
};

/// One point of a deviation curve.
struct AllanPoint {
  std::size_t m = 0;      ///< samples in a mean
  double tau = 0;         ///< m dt [s]
  double deviation = 0;   ///< [unit of the rate]; for `time` [unit of the rate times s]
  std::size_t terms = 0;  ///< number of averaged squares
};

/// Spacing of the averaging factors m.
enum class AllanTaus { octaves, decades, all };

/// The averaging factors m of a grid: 1, 2, 4, … or 1, 2, 4, 10, 20, 40, … or 1, 2, 3, …
/// @param samples  number of samples of the rate; the largest m leaves one term of `kind`
/// @param taus     which factors
/// @param kind     of the deviation
[[nodiscard]] std::vector<std::size_t> allan_factors(std::size_t samples, AllanTaus taus,
                                                     AllanKind kind = AllanKind::overlapping);

/// Computes the deviations of a rate in O(samples) for each m.
///
/// @param rate     (samples) means over dt each, evenly spaced, e.g. [rad/s]
/// @param dt       [s], > 0
/// @param factors  the averaging factors m, each leaving at least one term
/// @param kind     of the deviation
/// @throws InvalidInput  for a sample that is not finite (the message names the first one), for dt
///                       out of range, and for an m for which there are too few samples.
/// Source: Riley and Howe 2008, sections 5.2.2 to 5.2.11.
[[nodiscard]] std::vector<AllanPoint> allan_deviation(const Eigen::Ref<const Eigen::VectorXd>& rate,
                                                      double dt,
                                                      const std::vector<std::size_t>& factors,
                                                      AllanKind kind = AllanKind::overlapping);

/// Computes the same deviations from a phase (the integral of the rate, one sample more than the
/// rate has), e.g. [rad]. Arguments and errors as allan_deviation().
[[nodiscard]] std::vector<AllanPoint> allan_deviation_of_phase(
    const Eigen::Ref<const Eigen::VectorXd>& phase, double dt,
    const std::vector<std::size_t>& factors, AllanKind kind = AllanKind::overlapping);

/// Computes the rate whose integral is the given phase: differences of neighbours over dt. Its
/// deviations are those of the phase.
/// @param phase  (n) samples dt apart, not wrapped, e.g. [rad]
/// @param dt     [s], > 0
/// @return       (n - 1) means, e.g. [rad/s]; empty if n < 2
[[nodiscard]] Eigen::VectorXd rate_of_phase(const Eigen::Ref<const Eigen::VectorXd>& phase,
                                            double dt);

/// The noise types whose Allan variances are assumed to sum to that of a rate.
enum class AllanNoise {
  quantization,     ///< of the angle: 3 Q² / tau²
  white,            ///< noise density, angle random walk: N² / tau
  flicker,          ///< bias instability: (2 ln 2 / π) B²
  rate_random_walk  ///< K² tau / 3
};
inline constexpr std::size_t kAllanNoises = 4;  ///< number of noise types

/// A coefficient estimated from the curve, or the reason why it cannot be estimated.
struct AllanReading {
  bool seen = false;    ///< whether the curve determines the coefficient
  double value = 0;     ///< [unit of the coefficient]; 0 unless seen
  double low = 0;       ///< 95 % interval; 0 unless seen
  double high = 0;      ///< likewise
  double tau_from = 0;  ///< range of tau that it was estimated from [s]
  double tau_to = 0;    ///< likewise
  double at_most = 0;   ///< if not seen: 95 % upper bound; 0 if there is none
  std::string reason;   ///< if not seen: the reason; if seen: a remark, or empty
};

/// A point of the overlapping deviation with its 95 % interval.
struct AllanCurvePoint {
  AllanPoint point;  ///< averaging time and deviation
  double edf = 0;    ///< equivalent degrees of freedom of the variance
  double low = 0;    ///< of the deviation
  double high = 0;   ///< likewise
  double model = 0;  ///< deviation of the fitted noises
};

/// The overlapping Allan deviation of a rate, with the estimated noise coefficients.
struct AllanAnalysis {
  std::vector<AllanCurvePoint> curve;  ///< by increasing tau
  AllanReading quantization;           ///< Q [unit s]
  AllanReading noise_density;          ///< N [unit/√Hz]: the line of slope -1/2 at tau = 1 s
  AllanReading bias_instability;       ///< minimum of the deviation / 0.664 [unit]
  AllanReading random_walk;            ///< K [unit/s/√Hz]: the line of slope +1/2 at tau = 3 s
  /// Q², N², B², K² of the fit; 0 if the noise is not in it
  std::array<double, kAllanNoises> variances{};
  double chi_squared = 0;  ///< of the fit, at the octaves from fitted_from on
  int degrees = 0;         ///< of freedom of chi_squared
  double fitted_from = 0;  ///< smallest tau of the fit [s]; below it filters shape the curve
  bool explained = false;  ///< whether the four noise types describe the curve
  double model_error = 0;  ///< relative error of a variance that the fit allowed: 0.01, 0.03, 0.1
};

/// Minimum number of samples of analyse_allan().
inline constexpr std::size_t kMinAllanSamples = 64;

/// Computes the curve at `factors`, and estimates the noise coefficients by a generalized
/// least-squares fit of the sum of the noise types to the octaves. The weights are the exact
/// covariances of overlapping Allan variances of Gaussian noise with the fitted spectrum, between
/// all pairs of tau. The equivalent degrees of freedom follow from these covariances, and the
/// intervals from the degrees of freedom by chi-squared.
///
/// @param rate     (at least kMinAllanSamples) as in allan_deviation()
/// @param dt       [s], > 0
/// @param factors  averaging factors of the curve; empty: octaves
/// @throws InvalidInput  as allan_deviation(), and for too few samples or a constant rate.
/// Source: Greenhall and Riley 2003 (degrees of freedom); IEEE 952-1997, annex C (coefficients);
/// docs/theory.md, "Allan deviation".
[[nodiscard]] AllanAnalysis analyse_allan(const Eigen::Ref<const Eigen::VectorXd>& rate, double dt,
                                          std::vector<std::size_t> factors = {});

}  // namespace quadtune
