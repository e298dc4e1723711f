// SPDX-License-Identifier: Apache-2.0
/// The PID controller that rejects slow disturbances best within bounds on robustness and noise.
#pragma once

#include <iosfwd>
#include <limits>
#include <string>
#include <vector>

#include "quadtune/synthesis/pid_gains.hpp"
#include "quadtune/transfer_function.hpp"

namespace quadtune {

/// What bounds the gains. An infinite bound does not.
struct PidBounds {
  double Ms_max = 1.4;                                      ///< max |S|, S = 1/(1 + L), > 1
  double Mt_max = std::numeric_limits<double>::infinity();  ///< max |T|, T = L/(1 + L), > 1
  /// max |C S|: from the measurement's noise to the output, > 0. A PID without filter has none.
  double noise_gain_max = std::numeric_limits<double>::infinity();
};

/// How a search ended.
enum class PidOptimumStatus {
  not_run,
  solved,     ///< the search has converged, all bounds are kept
  not_found,  ///< no stabilizing gains within the bounds were met
  unbounded,  ///< Ki grew beyond all numbers: nothing bounds it
};

/// "solved", "not found", "unbounded".
[[nodiscard]] std::string to_string(PidOptimumStatus status);

/// Gains with their evidence. Numbers are NaN unless solved.
struct PidOptimum {
  static constexpr double kNaN = std::numeric_limits<double>::quiet_NaN();

  PidOptimumStatus status = PidOptimumStatus::not_run;
  PidGains gains = {kNaN, kNaN, kNaN, kNaN};
  double Ms = kNaN;
  double Mt = kNaN;
  double noise_gain = kNaN;          ///< max |C S|
  std::vector<std::string> binding;  ///< of "Ms", "Mt", "noise gain": those met within 0.1 %
  int evaluations = 0;               ///< of the greatest Ki at given Kp and Kd
  std::string culprit;               ///< empty when solved

  [[nodiscard]] bool solved() const { return status == PidOptimumStatus::solved; }
};

std::ostream& operator<<(std::ostream& out, const PidOptimum& optimum);

/// Greatest |Ki|, whose inverse is the integral of the error after a unit step of load at the
/// plant's input, within the bounds.
///
/// For given Kp and Kd each bound is, at each frequency, a quadratic inequality in Ki; the greatest
/// Ki is at the end of the highest gap that they leave and in which the loop is stable. It is
/// climbed over Kp for every Kd, and over Kd, by golden sections, which follow the ridge where two
/// bounds meet. The start is the best of AMIGO's gains, where a model for them can be fitted, and
/// of a scan over crossovers. A local search: a better optimum elsewhere is not excluded.
///
/// @param plant   with its delay
/// @param type    PI or PID
/// @param bounds  as above
/// @param Tf      time constant of the derivative's filter [s], ≥ 0; PI does not use it
/// @throws InvalidInput  for a plant or bounds that are none, or another type.
/// Source: Åström, Panagopoulos, Hägglund 1998. Theory: "PID synthesis".
[[nodiscard]] PidOptimum greatest_integral_gain(const ContinuousTransferFunction& plant,
                                                PidType type, const PidBounds& bounds,
                                                double Tf = 0);

}  // namespace quadtune
