// SPDX-License-Identifier: Apache-2.0
/// One loop of a cascade as it runs on board: a PID controller whose derivative term uses a
/// measured rate.
#pragma once

#include <iosfwd>
#include <limits>
#include <string>
#include <vector>

#include "quadtune/control/pid.hpp"
#include "quadtune/lti.hpp"
#include "quadtune/synthesis/margins.hpp"
#include "quadtune/synthesis/pid/pid_gains.hpp"

namespace quadtune {

/// The sampled plant of one loop. It has one input, the command, and two outputs, the value and its
/// rate, both of which increase after a positive command. Lag, delay and inner loops are included
/// as states.
using CascadePlant = DiscreteLti;

/// Computes the open loop, cut at the command, of the controller
///
///     command = Kp (r - value) + Ki ∫(r - value) - Kd rate,
///
/// whose integral is discretized by `method`. Tf of all gains in this file is 0.
/// @return  the open loop under negative feedback: one input, one output
/// @throws InvalidInput  if the plant is malformed (wrong shape, entries not finite, D ≠ 0)
[[nodiscard]] DiscreteLti cut_at_command(const CascadePlant& plant, const PidGains& gains,
                                         PidMethod method);

/// Computes the closed loop from r to the value and its rate. It is the plant of the next outer
/// loop.
[[nodiscard]] CascadePlant closed_at_command(const CascadePlant& plant, const PidGains& gains,
                                             PidMethod method);

/// Properties of a loop with given gains.
struct CascadeLoopEvidence {
  LoopMargins margins;   ///< of the whole loop, cut at the command
  LoopMargins rate;      ///< of the rate feedback alone, Kd times the rate
  double bandwidth = 0;  ///< [rad/s] crossover of the value feedback, rate loop closed; 0 if none
  double load_integral = 0;      ///< ∫ of the value after a unit load step at the command: 1/Ki
  double load_peak = 0;          ///< maximum of |value| after that step
  double load_steady_state = 0;  ///< steady-state value after that step; 0 with an integral
  double tracking_peak = 0;      ///< max |value / set point|
  double value_noise = 0;        ///< max |Kp + Ki/s| |S|: gain from value noise to the command
  double rate_noise = 0;         ///< max Kd |S|: gain from rate noise to the command, without lead
};

/// Computes the properties of a loop with given gains.
/// @throws InvalidInput  if the plant is malformed (wrong shape, entries not finite, D ≠ 0)
[[nodiscard]] CascadeLoopEvidence cascade_loop_evidence(const CascadePlant& plant,
                                                        const PidGains& gains, PidMethod method);

/// Bounds on a loop. An infinite bound is inactive.
struct CascadeLoopBounds {
  static constexpr double kInfinity = std::numeric_limits<double>::infinity();  ///< no bound

  /// Crossover of the rate feedback alone [rad/s], met exactly; 0: chosen by the search.
  double rate_crossover = 0;
  double rate_crossover_max = kInfinity;  ///< [rad/s]
  double Ms_max = 1.4;                    ///< max |S| of the whole loop, > 1
  double tracking_max = kInfinity;        ///< max |value / set point|, > 1
  double value_noise_max = kInfinity;     ///< [command / value], > 0
  double rate_noise_max = kInfinity;      ///< [command / rate], > 0
  double load_peak_max = kInfinity;       ///< [value / command] after a unit step of load, > 0
  bool integral = true;                   ///< false: Ki is 0 and Kp is maximized
  bool p_pi = false;                      ///< limits Ki to max_p_pi_integral()
};

/// How a search ended.
enum class CascadeLoopStatus {
  not_run,
  solved,
  crossover_infeasible,  ///< rate_crossover is too high for Ms_max
  not_found,             ///< no gains satisfy the bounds
};

/// "solved", "crossover out of reach", "not found".
[[nodiscard]] std::string to_string(CascadeLoopStatus status);

/// Gains with their evidence. Numbers are NaN unless solved.
struct CascadeLoopDesign {
  static constexpr double kNaN = std::numeric_limits<double>::quiet_NaN();  ///< unknown

  CascadeLoopStatus status = CascadeLoopStatus::not_run;  ///< solved, or why there are no gains
  PidGains gains = {kNaN, kNaN, kNaN, 0};                 ///< of the loop; Tf is 0
  CascadeLoopEvidence evidence;                           ///< margins and noise gains of the loop
  std::vector<std::string> binding;  ///< "Ms", "value noise", …: the active bounds, within 0.1 %
  /// The highest crossover of the rate feedback alone at which its max |S| is at most Ms_max
  /// [rad/s].
  double highest_rate_crossover = kNaN;
  std::string culprit;  ///< empty when solved

  /// Whether there are gains.
  [[nodiscard]] bool solved() const { return status == CascadeLoopStatus::solved; }
};

/// Prints the status, then the gains and margins, or the culprit.
std::ostream& operator<<(std::ostream& out, const CascadeLoopDesign& design);

/// Computes the gains that reject a slowly varying load best within the bounds: the maximum Ki, or
/// the maximum Kp of a loop without integral.
///
/// For given Kp and Kd, each bound is a quadratic inequality in Ki at each frequency, as in
/// max_integral_gain(). Kp and Kd are found by a local search that starts from a scan.
///
/// @throws InvalidInput  if the plant is malformed (wrong shape, entries not finite, D ≠ 0) or a
///                       bound is out of range
/// Theory: "PID cascade of a vehicle".
[[nodiscard]] CascadeLoopDesign design_cascade_loop(const CascadePlant& plant,
                                                    const CascadeLoopBounds& bounds,
                                                    PidMethod method);

}  // namespace quadtune
