// SPDX-License-Identifier: Apache-2.0
/// The classical low-pass designs that the Mambo's estimator names, as coefficients.
#pragma once

#include <Eigen/Core>

namespace quadtune {

/// y = (num[0] + num[1] z⁻¹ + …) / (den[0] + den[1] z⁻¹ + …) u, den[0] = 1, gain 1 at rest.
struct DigitalFilter {
  Eigen::VectorXd num;
  Eigen::VectorXd den;
};

/// butter(order, cutoff): Butterworth, 3 dB down at the cutoff.
///
/// @param order   1 to 12
/// @param cutoff  as a fraction of half the sample rate, 0 < cutoff < 1
/// @throws InvalidInput  for an order or cutoff out of range.
/// Source: bilinear transform with prewarping; Oppenheim and Schafer, section 7.
[[nodiscard]] DigitalFilter butterworth(int order, double cutoff);

/// cheby2(order, attenuation, edge): Chebyshev of the second kind.
///
/// @param attenuation  in the whole stop band [dB], > 0
/// @param edge         of the stop band, as a fraction of half the sample rate, 0 < edge < 1
[[nodiscard]] DigitalFilter chebyshev2(int order, double attenuation, double edge);

/// fir1(order, cutoff): the sinc of the ideal low pass under a Hamming window, order + 1
/// coefficients, half the gain at the cutoff.
[[nodiscard]] DigitalFilter windowed_fir(int order, double cutoff);

}  // namespace quadtune
