// SPDX-License-Identifier: Apache-2.0
/// One loop of a cascade, as it runs on board: a PID controller whose derivative is a measured
/// rate.
#pragma once

#include <iosfwd>
#include <limits>
#include <string>
#include <vector>

#include "quadtune/control/pid.hpp"
#include "quadtune/lti.hpp"
#include "quadtune/synthesis/margins.hpp"
#include "quadtune/synthesis/pid_gains.hpp"

namespace quadtune {

/// What a loop commands and measures, sampled. One input, the command; two outputs, the value and
/// its rate, both of which rise after a positive command. Lag, delay and the loops inside are
/// states of it.
using CascadePlant = DiscreteLti;

/// command = Kp (r - value) + Ki ∫(r - value) - Kd rate, the integral as `method` says. In the
/// gains of this file Tf is 0.
/// @return  the loop cut at the command: one input, one output, under negative feedback
/// @throws InvalidInput  for a plant that is none
[[nodiscard]] DiscreteLti cut_at_command(const CascadePlant& plant, const PidGains& gains,
                                         PidMethod method);

/// The same loop closed: from r to the value and its rate, for the loop around it.
[[nodiscard]] CascadePlant closed_at_command(const CascadePlant& plant, const PidGains& gains,
                                             PidMethod method);

/// What a loop of given gains is worth.
struct CascadeLoopEvidence {
  LoopMargins margins;   ///< of the whole loop, cut at the command
  LoopMargins rate;      ///< of the rate's part alone, Kd times the rate
  double bandwidth = 0;  ///< [rad/s] where the value's part crosses 1, the rate's closed; 0: never
  double load_integral = 0;  ///< ∫ of the value after a unit step of load at the command: 1/Ki
  double load_peak = 0;      ///< the greatest value after it
  double load_left = 0;      ///< the value that stays: 0 with an integral
  double tracking_peak = 0;  ///< max |value / set point|
  double value_noise = 0;    ///< max |Kp + Ki/s| |S|: from the value's noise to the command
  double rate_noise = 0;     ///< max Kd |S|: from the rate's noise to the command
};

/// @throws InvalidInput  for a plant that is none
[[nodiscard]] CascadeLoopEvidence cascade_loop_evidence(const CascadePlant& plant,
                                                        const PidGains& gains, PidMethod method);

/// What bounds the gains of a loop. An infinite bound does not.
struct CascadeLoopBounds {
  static constexpr double kInfinity = std::numeric_limits<double>::infinity();

  /// Where the rate's part of the loop crosses 1 [rad/s]: exactly there, or 0 for what suits best.
  double rate_crossover = 0;
  double rate_crossover_max = kInfinity;  ///< [rad/s]
  double Ms_max = 1.4;                    ///< max |S| of the whole loop, > 1
  double tracking_max = kInfinity;        ///< max |value / set point|, > 1
  double value_noise_max = kInfinity;     ///< [command / value], > 0
  double rate_noise_max = kInfinity;      ///< [command / rate], > 0
  double load_peak_max = kInfinity;       ///< [value / command] after a unit step of load, > 0
  bool integral = true;                   ///< false: Ki is 0, and the greatest Kp is looked for
  bool p_pi = false;                      ///< Ki within greatest_p_pi_integral()
};

/// How a search ended.
enum class CascadeLoopStatus {
  not_run,
  solved,
  crossover_out_of_reach,  ///< no value's part fits beside a rate's part that is so fast
  not_found,               ///< the bounds leave nothing
};

/// "solved", "crossover out of reach", "not found".
[[nodiscard]] std::string to_string(CascadeLoopStatus status);

/// Gains with their evidence. Numbers are NaN unless solved.
struct CascadeLoopDesign {
  static constexpr double kNaN = std::numeric_limits<double>::quiet_NaN();

  CascadeLoopStatus status = CascadeLoopStatus::not_run;
  PidGains gains = {kNaN, kNaN, kNaN, 0};
  CascadeLoopEvidence evidence;
  std::vector<std::string> binding;  ///< of "Ms", "value noise", …: bounds met within 0.1 %
  /// The highest crossover of the rate's part that keeps Ms_max by itself [rad/s].
  double highest_rate_crossover = kNaN;
  std::string culprit;  ///< empty when solved

  [[nodiscard]] bool solved() const { return status == CascadeLoopStatus::solved; }
};

std::ostream& operator<<(std::ostream& out, const CascadeLoopDesign& design);

/// The gains that reject a slow load best within the bounds: the greatest Ki, or the greatest Kp of
/// a loop without integral.
///
/// For given Kp and Kd every bound is, at each frequency, a quadratic inequality in Ki, as in
/// greatest_integral_gain(). A local search over the two, from a scan.
///
/// @throws InvalidInput  for a plant or bounds that are none
/// Theory: "PID synthesis".
[[nodiscard]] CascadeLoopDesign design_cascade_loop(const CascadePlant& plant,
                                                    const CascadeLoopBounds& bounds,
                                                    PidMethod method);

}  // namespace quadtune
