// SPDX-License-Identifier: Apache-2.0
/// The PID controller that rejects slow disturbances best, subject to bounds on robustness and
/// noise.
#pragma once

#include <iosfwd>
#include <limits>
#include <string>
#include <vector>

#include "quadtune/synthesis/pid/pid_gains.hpp"
#include "quadtune/transfer_function.hpp"

namespace quadtune {

/// Bounds on the loop. An infinite bound is inactive.
struct PidBounds {
  double Ms_max = 1.4;                                      ///< max |S|, S = 1/(1 + L), > 1
  double Mt_max = std::numeric_limits<double>::infinity();  ///< max |T|, T = L/(1 + L), > 1
  /// max |C S|, the gain from measurement noise to the controller's output, > 0. It is infinite for
  /// a PID without filter, which therefore cannot have this bound.
  double noise_gain_max = std::numeric_limits<double>::infinity();
};

/// How a search ended.
enum class PidOptimumStatus {
  not_run,
  solved,     ///< the search has converged, and all bounds are met
  not_found,  ///< the search found no stabilizing gains within the bounds
  unbounded,  ///< Ki grew without limit: no bound is active
};

/// "solved", "not found", "unbounded".
[[nodiscard]] std::string to_string(PidOptimumStatus status);

/// Gains with their evidence. Numbers are NaN unless solved.
struct PidOptimum {
  static constexpr double kNaN = std::numeric_limits<double>::quiet_NaN();  ///< unknown

  PidOptimumStatus status = PidOptimumStatus::not_run;  ///< solved, or why there are no gains
  PidGains gains = {kNaN, kNaN, kNaN, kNaN};            ///< of the controller
  double Ms = kNaN;                                     ///< maximum of |S|
  double Mt = kNaN;                                     ///< maximum of |T|
  double noise_gain = kNaN;                             ///< max |C S|
  std::vector<std::string> binding;  ///< "Ms", "Mt", "noise gain": active within 0.1 %
  int evaluations = 0;               ///< how often Ki was maximized for given Kp and Kd
  std::string culprit;               ///< empty when solved

  /// Whether there are gains.
  [[nodiscard]] bool solved() const { return status == PidOptimumStatus::solved; }
};

/// Prints the status, then gains and peaks, or the culprit.
std::ostream& operator<<(std::ostream& out, const PidOptimum& optimum);

/// Maximizes |Ki| within the bounds. Its inverse is the integral of the error after a unit load
/// step at the plant's input.
///
/// For given Kp and Kd, each bound is a quadratic inequality in Ki at each frequency. The maximum
/// Ki is the upper end of the highest feasible interval in which the loop is stable. Nested golden
/// section searches, over Kd and over Kp for each Kd, maximize it; they can follow the ridge where
/// two bounds are active. The search starts from the best of a scan over crossovers and of the
/// AMIGO gains, if their model can be fitted. It is local: a better optimum elsewhere is not
/// excluded.
///
/// @param plant   with its delay
/// @param type    PI or PID
/// @param bounds  see PidBounds
/// @param Tf      time constant of the derivative filter [s], ≥ 0; not used by PI
/// @throws InvalidInput  if the plant is malformed, a bound is out of range, or the type is neither
///                       PI nor PID.
/// Source: Åström, Panagopoulos, Hägglund 1998. Theory: "PID synthesis".
[[nodiscard]] PidOptimum max_integral_gain(const ContinuousTransferFunction& plant, PidType type,
                                           const PidBounds& bounds, double Tf = 0);

}  // namespace quadtune
