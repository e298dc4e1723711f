// SPDX-License-Identifier: Apache-2.0
/// Gains of one continuous PID controller, in parallel and in standard form.
#pragma once

#include <complex>
#include <iosfwd>
#include <limits>
#include <string>

#include "quadtune/control/pid.hpp"
#include "quadtune/transfer_function.hpp"

namespace quadtune {

/// The terms of a controller.
enum class PidType { P, PI, PD, PID };

/// "P", "PI", "PD", "PID".
[[nodiscard]] std::string to_string(PidType type);

/// Parallel form: C(s) = Kp + Ki/s + Kd s/(Tf s + 1).
struct PidGains {
  double Kp = 0;  ///< [output / error]
  double Ki = 0;  ///< [output / (error · s)]
  double Kd = 0;  ///< [output · s / error]
  double Tf = 0;  ///< time constant of the derivative's filter [s], ≥ 0; 0 means no filter

  /// C(s), s [rad/s].
  [[nodiscard]] std::complex<double> operator()(std::complex<double> s) const;
};

/// Prints the four numbers in one line.
std::ostream& operator<<(std::ostream& out, const PidGains& gains);

/// Computes C(s) P(s), with the delay of the plant. Terms whose gain is 0 add no poles and zeros. A
/// derivative without filter may give the result more zeros than poles.
[[nodiscard]] ContinuousTransferFunction loop_of(const ContinuousTransferFunction& plant,
                                                 const PidGains& gains);

/// Standard form: C(s) = K (1 + 1/(Ti s) + Td s/(Tf s + 1)).
struct PidStandard {
  double K = 0;                                         ///< [output / error]
  double Ti = std::numeric_limits<double>::infinity();  ///< [s]; infinite without an integral
  double Td = 0;                                        ///< [s]; 0 without a derivative
  double Tf = 0;                                        ///< [s]
};

/// Converts parallel to standard form.
/// @throws InvalidInput  if Kp is 0 and another gain is not, because the standard form cannot
///                       represent such a controller.
[[nodiscard]] PidStandard standard_form(const PidGains& gains);

/// Converts standard to parallel form.
/// @throws InvalidInput  if Ti is 0 or not a number.
[[nodiscard]] PidGains parallel_form(const PidStandard& standard);

/// Computes the settings of the discrete controller that runs these gains every dt seconds. Its
/// derivative is filtered if Tf > 0, and a plain difference if Tf is 0.
/// @throws InvalidInput  for the reasons of validate() of the settings, e.g. if forward Euler makes
///                       the filter unstable.
[[nodiscard]] PidSettings<double> pid_settings(const PidGains& gains, double dt,
                                               PidMethod method = PidMethod::tustin);

}  // namespace quadtune
