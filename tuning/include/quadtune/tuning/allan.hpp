// SPDX-License-Identifier: Apache-2.0
/// Allan deviation of a still sensor, and the noises that are read off it.
#pragma once

#include <Eigen/Core>
#include <array>
#include <cstddef>
#include <string>
#include <vector>

namespace quadtune {

/// Which two- or three-sample deviation. All are of means over tau = m dt.
enum class AllanKind {
  plain,                 ///< Allan, from neighbouring means
  overlapping,           ///< Allan, from all means, the usual choice
  modified,              ///< Allan, also averaged over m phases: tells white from flicker phase
  time,                  ///< tau / √3 times the modified one
  total,                 ///< Allan, on the phase continued by reflection: more of long tau
  hadamard,              ///< of second differences, from neighbouring means: blind to a ramp
  overlapping_hadamard,  ///< likewise from all means
};

/// One point of a deviation's curve.
struct AllanPoint {
  std::size_t m = 0;      ///< samples in a mean
  double tau = 0;         ///< m dt [s]
  double deviation = 0;   ///< [unit of the rate]; `time`: times s
  std::size_t terms = 0;  ///< squares that were averaged
};

/// How many means over m are asked for.
enum class AllanTaus { octaves, decades, all };

/// The m of a grid: 1, 2, 4, … or 1, 2, 4, 10, 20, 40, … or 1, 2, 3, …
/// @param samples  of the rate; m goes up to what leaves one term of `kind`
[[nodiscard]] std::vector<std::size_t> allan_factors(std::size_t samples, AllanTaus taus,
                                                     AllanKind kind = AllanKind::overlapping);

/// Deviations of a rate, O(samples) for each m.
///
/// @param rate     (samples) means over dt each, evenly spaced, e.g. [rad/s]
/// @param dt       [s], > 0
/// @param factors  the m, each leaving at least one term
/// @throws InvalidInput  naming the first sample that is not finite, for dt out of range, and for
/// an
///                       m of which the record has too few samples.
/// Source: Riley and Howe 2008, sections 5.2.2 to 5.2.11.
[[nodiscard]] std::vector<AllanPoint> allan_deviation(const Eigen::Ref<const Eigen::VectorXd>& rate,
                                                      double dt,
                                                      const std::vector<std::size_t>& factors,
                                                      AllanKind kind = AllanKind::overlapping);

/// The same of a phase (the rate's integral, one value more than rates), e.g. [rad].
[[nodiscard]] std::vector<AllanPoint> allan_deviation_of_phase(
    const Eigen::Ref<const Eigen::VectorXd>& phase, double dt,
    const std::vector<std::size_t>& factors, AllanKind kind = AllanKind::overlapping);

/// The rate whose integral a phase is: differences of neighbours over dt. Its deviations are those
/// of the phase.
/// @param phase  (n) values dt apart, not wrapped, e.g. [rad]
/// @param dt     [s], > 0
/// @return       (n - 1) means, e.g. [rad/s]; of no value where n < 2
[[nodiscard]] Eigen::VectorXd rate_of_phase(const Eigen::Ref<const Eigen::VectorXd>& phase,
                                            double dt);

/// The noises that a rate's Allan variance is taken for the sum of.
enum class AllanNoise {
  quantization,     ///< of the angle: 3 Q² / tau²
  white,            ///< noise density, angle random walk: N² / tau
  flicker,          ///< bias instability: (2 ln 2 / π) B²
  rate_random_walk  ///< K² tau / 3
};
inline constexpr std::size_t kAllanNoises = 4;

/// A number read off the curve, or why there is none.
struct AllanReading {
  bool seen = false;
  double value = 0;     ///< in the coefficient's unit; 0 unless seen
  double low = 0;       ///< 95 % interval; 0 unless seen
  double high = 0;      ///< likewise
  double tau_from = 0;  ///< the region that it was read from [s]
  double tau_to = 0;    ///< likewise
  double at_most = 0;   ///< where not seen: 95 % bound from above; 0 where there is none
  std::string reason;   ///< where not seen: why; where seen: what to know, or empty
};

/// A point of the overlapping deviation with its 95 % interval.
struct AllanCurvePoint {
  AllanPoint point;
  double edf = 0;    ///< equivalent degrees of freedom of the variance
  double low = 0;    ///< of the deviation
  double high = 0;   ///< likewise
  double model = 0;  ///< deviation of the fitted noises
};

/// The overlapping Allan deviation of a record with what it says of the sensor.
struct AllanAnalysis {
  std::vector<AllanCurvePoint> curve;
  AllanReading quantization;      ///< Q [unit s]
  AllanReading noise_density;     ///< N [unit/√Hz]: the line of slope -1/2 at tau = 1 s
  AllanReading bias_instability;  ///< least deviation / 0.664 [unit]
  AllanReading random_walk;       ///< K [unit/s/√Hz]: the line of slope +1/2 at tau = 3 s
  std::array<double, kAllanNoises> variances{};  ///< Q², N², B², K² of the fit; 0: not in it
  double chi_squared = 0;                        ///< of the fit at the octaves from fitted_from on
  int degrees = 0;                               ///< of freedom of chi_squared
  double fitted_from = 0;  ///< the least tau of the fit [s]; what is below is shaped by filters
  bool explained = false;  ///< whether the four noises describe the curve
  double model_error = 0;  ///< relative error of a variance that was allowed them: 0.01, 0.03, 0.1
};

/// Least samples of analyse_allan().
inline constexpr std::size_t kLeastAllanSamples = 64;

/// The curve at `factors`, and the noises by a generalized least-squares fit of their sum to the
/// octaves. The weights are the exact covariances of overlapping Allan variances of Gaussian noise
/// with the fitted spectrum, between all pairs of tau; from them also come the equivalent degrees
/// of freedom, and from those the intervals by chi-squared.
///
/// @param rate     (at least kLeastAllanSamples) as allan_deviation()
/// @param factors  where the curve is wanted; empty: octaves
/// @throws InvalidInput  as allan_deviation(), and for too few samples or a rate that never
/// changes. Source: Greenhall and Riley 2003 (degrees of freedom); IEEE 952-1997, annex C
/// (coefficients); docs/theory.md#allan-deviation.
[[nodiscard]] AllanAnalysis analyse_allan(const Eigen::Ref<const Eigen::VectorXd>& rate, double dt,
                                          std::vector<std::size_t> factors = {});

}  // namespace quadtune
