// SPDX-License-Identifier: Apache-2.0
/// Gains of one continuous PID controller, in the forms in which they are written.
#pragma once

#include <complex>
#include <iosfwd>
#include <limits>
#include <string>

#include "quadtune/control/pid.hpp"
#include "quadtune/transfer_function.hpp"

namespace quadtune {

/// Which parts a controller has.
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

std::ostream& operator<<(std::ostream& out, const PidGains& gains);

/// C(s) P(s), with the plant's delay and without poles and zeros of parts that the gains leave out.
/// The derivative without a filter may leave it with more zeros than poles.
[[nodiscard]] ContinuousTransferFunction loop_of(const ContinuousTransferFunction& plant,
                                                 const PidGains& gains);

/// Standard form: C(s) = K (1 + 1/(Ti s) + Td s/(Tf s + 1)).
struct PidStandard {
  double K = 0;                                         ///< [output / error]
  double Ti = std::numeric_limits<double>::infinity();  ///< [s]; infinite without an integral
  double Td = 0;                                        ///< [s]; 0 without a derivative
  double Tf = 0;                                        ///< [s]
};

/// @throws InvalidInput  when Kp is 0 and another gain is not: the standard form has no such
///                       controller.
[[nodiscard]] PidStandard standard_form(const PidGains& gains);

/// @throws InvalidInput  when Ti is 0 or not a number.
[[nodiscard]] PidGains parallel_form(const PidStandard& standard);

/// The element that runs these gains every dt seconds: filtered derivative where Tf > 0, a plain
/// difference where it is 0.
/// @throws InvalidInput  as validate() of the settings, e.g. when forward Euler makes the filter
///                       unstable.
[[nodiscard]] PidSettings<double> pid_settings(const PidGains& gains, double dt,
                                               PidMethod method = PidMethod::tustin);

}  // namespace quadtune
