// SPDX-License-Identifier: Apache-2.0
/// Margins of a loop that is known only by its frequency response at some frequencies, for example
/// because it was measured in flight.
#pragma once

#include <Eigen/Core>
#include <complex>
#include <string>

#include "quadtune/synthesis/margins.hpp"

namespace quadtune {

/// A frequency response of one channel at given frequencies.
struct FrequencyData {
  Eigen::VectorXd w;   ///< (n) [rad/s], > 0, increasing; n ≥ 2
  Eigen::VectorXcd G;  ///< (n) finite and not 0
};

/// @throws InvalidInput  naming the sample, if there are fewer than two samples, the frequencies
///                       are not positive and increasing, or a value is 0 or not finite
void validate(const FrequencyData& data, const std::string& where);

/// What was measured. In flight the loop is closed, so that the response from the set point to the
/// output (T), or from a disturbance at the output to the output (S), is the usual measurement.
enum class MeasuredResponse {
  loop,                       ///< L
  complementary_sensitivity,  ///< T = L/(1 + L), hence L = T/(1 - T)
  sensitivity,                ///< S = 1/(1 + L), hence L = 1/S - 1
};

/// The open loop L of a measured response.
/// @throws InvalidInput  as validate(), or if T is 1 or S is 1 at a frequency, where L is infinite
///                       or 0
[[nodiscard]] FrequencyData open_loop_of(const FrequencyData& measured, MeasuredResponse what);

/// Margins of frequency response data, with what the data leave open.
struct FrequencyDataMargins {
  /// `stable` is the given assumption, since data at some frequencies do not show it.
  LoopMargins margins;
  bool crosses_gain = false;      ///< whether |L| passes 1 within the data
  bool crosses_phase = false;     ///< whether L passes the negative real axis within the data
  double largest_phase_step = 0;  ///< between neighbours [rad]; above π/2 the data are too coarse
  double w_largest_phase_step = 0;  ///< lower end of that step [rad/s]
};

/// Computes the margins of L from samples. Between neighbouring samples, log|L| and the phase,
/// which changes by less than π, are linear in log w. Crossovers are exact for this interpolation;
/// peaks are those of the interpolated curve. Nothing is extrapolated: a margin whose crossover
/// lies outside the data is infinite.
/// @param L       accepted by validate()
/// @param stable  whether the closed loop is stable, as a loop that was measured in flight is
/// @param skew    of the disk, as for loop_margins()
/// @throws InvalidInput  as validate(), or if the skew is not finite
[[nodiscard]] FrequencyDataMargins frequency_data_margins(const FrequencyData& L,
                                                          bool stable = true, double skew = 0);

}  // namespace quadtune
