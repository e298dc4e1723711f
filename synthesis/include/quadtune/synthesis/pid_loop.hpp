// SPDX-License-Identifier: Apache-2.0
/// PID gains that give a loop a wanted crossover and phase margin exactly.
#pragma once

#include <iosfwd>
#include <limits>
#include <string>

#include "quadtune/synthesis/pid_gains.hpp"
#include "quadtune/transfer_function.hpp"

namespace quadtune {

/// A PID has three gains for two requirements: what the third is spent on.
enum class PidFreedom {
  Ti_is_4_Td,   ///< both zeros of K (1 + 1/(Ti s) + Td s) fall together
  greatest_Ki,  ///< the best rejection of slow disturbances that Ms_max allows
};

/// What the loop shall be.
struct LoopRequirement {
  PidType type = PidType::PID;
  double crossover = 0;     ///< where |L| = 1 [rad/s], > 0
  double phase_margin = 0;  ///< arg L + π there [rad], in (0, π)
  double Tf = 0;            ///< of the derivative's filter [s], ≥ 0
  PidFreedom freedom = PidFreedom::Ti_is_4_Td;
  double Ms_max = 2;  ///< max |S| for greatest_Ki, > 1
};

/// How a synthesis ended.
enum class PidLoopStatus {
  not_run,
  solved,              ///< stable, with this crossover and this phase margin
  phase_out_of_reach,  ///< gains of one sign cannot turn the phase so far at this frequency
  unstable,            ///< the gains that meet the requirement do not stabilize
  other_crossover,     ///< |L| = 1 elsewhere too, higher up or with less phase margin
  Ms_exceeded,         ///< no Ki keeps max |S| below Ms_max
};

/// "solved", "phase out of reach", …
[[nodiscard]] std::string to_string(PidLoopStatus status);

/// Gains with the evidence that the loop is what was asked for. Numbers are NaN unless solved.
struct PidLoopDesign {
  static constexpr double kNaN = std::numeric_limits<double>::quiet_NaN();

  PidLoopStatus status = PidLoopStatus::not_run;
  PidGains gains = {kNaN, kNaN, kNaN, kNaN};
  double crossover = kNaN;     ///< [rad/s], found anew from the loop; that of the least margin
  double phase_margin = kNaN;  ///< [rad], there
  double Ms = kNaN;            ///< max |1/(1 + L)|
  double w_Ms = kNaN;          ///< [rad/s]
  double Mt = kNaN;            ///< max |L/(1 + L)|
  double w_Mt = kNaN;          ///< [rad/s]
  /// Unless solved: the least and the greatest crossover [rad/s] that can be had with everything
  /// else as required, found by search and bisection; 0 and infinite where the search met no end;
  /// NaN where nothing was found.
  double lowest_crossover = kNaN;
  double highest_crossover = kNaN;
  std::string culprit;  ///< what stands in the way, and what can be had; empty when solved

  [[nodiscard]] bool solved() const { return status == PidLoopStatus::solved; }
};

std::ostream& operator<<(std::ostream& out, const PidLoopDesign& design);

/// Solves C(jωc) P(jωc) = e^(j(φm - π)) for the gains, all of one sign.
///
/// PI and PD are two linear equations. A PID with Ti = 4 Td is a quadratic one in Kd with one
/// positive root; for the greatest Ki, Kd is searched along the line of solutions. A P controller
/// has one gain: the crossover is exact and the phase margin at least the one required. Whatever
/// comes out is accepted only if the closed loop is stable (its delay taken exactly), no other
/// crossover has less margin and none lies higher up.
///
/// @param plant        with its delay; may be unstable
/// @param requirement  as above
/// @throws InvalidInput  for a plant or requirement that is none, naming the field.
/// Theory: "PID synthesis".
[[nodiscard]] PidLoopDesign pid_for_crossover(const ContinuousTransferFunction& plant,
                                              const LoopRequirement& requirement);

}  // namespace quadtune
