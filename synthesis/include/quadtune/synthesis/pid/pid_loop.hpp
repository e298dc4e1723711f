// SPDX-License-Identifier: Apache-2.0
/// PID gains that meet a required crossover and phase margin exactly.
#pragma once

#include <iosfwd>
#include <limits>
#include <string>

#include "quadtune/synthesis/pid/pid_gains.hpp"
#include "quadtune/transfer_function.hpp"

namespace quadtune {

/// How the third gain of a PID is chosen; the crossover and the phase margin determine two.
enum class PidFreedom {
  Ti_is_4_Td,  ///< both zeros of K (1 + 1/(Ti s) + Td s) coincide
  max_Ki,      ///< maximum Ki, hence best rejection of slow disturbances, within Ms_max
};

/// Requirements on the loop.
struct LoopRequirement {
  PidType type = PidType::PID;  ///< which terms the controller has
  double crossover = 0;         ///< where |L| = 1 [rad/s], > 0
  double phase_margin = 0;      ///< arg L + π there [rad], in (0, π)
  double Tf = 0;                ///< time constant of the derivative filter [s], ≥ 0
  PidFreedom freedom = PidFreedom::Ti_is_4_Td;  ///< how the freedom of a PID is used
  double Ms_max = 2;                            ///< maximum of |S| for max_Ki, > 1
};

/// How a synthesis ended.
enum class PidLoopStatus {
  not_run,
  solved,            ///< stable, with the required crossover and phase margin
  phase_infeasible,  ///< gains of one sign cannot shift the phase enough at the crossover
  unstable,          ///< the gains that meet the requirement do not stabilize the loop
  other_crossover,   ///< |L| = 1 also at a higher frequency, or with less phase margin
  Ms_exceeded,       ///< no Ki keeps max |S| below Ms_max
};

/// "solved", "phase out of reach", …
[[nodiscard]] std::string to_string(PidLoopStatus status);

/// Gains with the evidence that the loop meets the requirement. Numbers are NaN unless solved.
struct PidLoopDesign {
  static constexpr double kNaN = std::numeric_limits<double>::quiet_NaN();  ///< unknown

  PidLoopStatus status = PidLoopStatus::not_run;  ///< solved, or why there are no gains
  PidGains gains = {kNaN, kNaN, kNaN, kNaN};      ///< of the controller
  double crossover = kNaN;     ///< [rad/s] at the minimum margin, recomputed from the loop
  double phase_margin = kNaN;  ///< [rad] at that crossover
  double Ms = kNaN;            ///< max |1/(1 + L)|
  double w_Ms = kNaN;          ///< [rad/s]
  double Mt = kNaN;            ///< max |L/(1 + L)|
  double w_Mt = kNaN;          ///< [rad/s]
  /// Unless solved: the minimum and maximum crossover [rad/s] that are feasible with all other
  /// requirements unchanged, computed by a scan and bisection. 0 and infinite if the scan found no
  /// limit; NaN if no crossover is feasible.
  double lowest_crossover = kNaN;
  double highest_crossover = kNaN;  ///< see lowest_crossover [rad/s]
  std::string culprit;  ///< the obstacle, and which crossovers are feasible; empty when solved

  /// Whether there are gains.
  [[nodiscard]] bool solved() const { return status == PidLoopStatus::solved; }
};

/// Prints the status, then gains, crossover and margins, or the culprit.
std::ostream& operator<<(std::ostream& out, const PidLoopDesign& design);

/// Solves C(jωc) P(jωc) = e^(j(φm - π)) for the gains, all of one sign.
///
/// For PI and PD, these are two linear equations. For a PID with Ti = 4 Td, Kd is the positive root
/// of a quadratic equation; for the maximum Ki, Kd is searched along the line of solutions. A P
/// controller has one gain: its crossover is exact, and the phase margin is at least the required
/// one. Gains are accepted only if the closed loop is stable (with the exact delay), no other
/// crossover has less phase margin, and none is at a higher frequency.
///
/// @param plant        with its delay; may be unstable
/// @param requirement  see LoopRequirement
/// @throws InvalidInput  if the plant is malformed or a requirement is out of range; the message
///                       names the field.
/// Theory: "PID synthesis".
[[nodiscard]] PidLoopDesign pid_for_crossover(const ContinuousTransferFunction& plant,
                                              const LoopRequirement& requirement);

}  // namespace quadtune
