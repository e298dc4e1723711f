// SPDX-License-Identifier: Apache-2.0
/// Coefficients of the classical low-pass designs that the Mambo's estimator refers to by name.
#pragma once

#include <Eigen/Core>

namespace quadtune {

/// y = (num[0] + num[1] z⁻¹ + …) / (den[0] + den[1] z⁻¹ + …) u, den[0] = 1, DC gain 1.
struct DigitalFilter {
  Eigen::VectorXd num;
  Eigen::VectorXd den;
};

/// butter(order, cutoff): Butterworth, -3 dB at the cutoff.
///
/// @param order   1 to 12
/// @param cutoff  as a fraction of half the sample rate, 0 < cutoff < 1
/// @throws InvalidInput  if the order or the cutoff is out of range
/// Source: bilinear transform with prewarping; Oppenheim and Schafer, section 7.
[[nodiscard]] DigitalFilter butterworth(int order, double cutoff);

/// cheby2(order, attenuation, edge): Chebyshev of the second kind.
///
/// @param order        1 to 12
/// @param attenuation  minimum attenuation in the stop band [dB], 0 < attenuation < 300
/// @param edge         start of the stop band, as a fraction of half the sample rate, 0 < edge < 1
/// @throws InvalidInput  if an argument is out of range
[[nodiscard]] DigitalFilter chebyshev2(int order, double attenuation, double edge);

/// fir1(order, cutoff): impulse response of the ideal low pass with a Hamming window; order + 1
/// coefficients, gain 1/2 at the cutoff.
/// @param order, cutoff  as for butterworth()
/// @throws InvalidInput  if the order or the cutoff is out of range
[[nodiscard]] DigitalFilter windowed_fir(int order, double cutoff);

}  // namespace quadtune
