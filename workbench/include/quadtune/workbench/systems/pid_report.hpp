// SPDX-License-Identifier: Apache-2.0
/// PID gains for a transfer function: for a given crossover, by a published rule, or optimal within
/// bounds.
#pragma once

#include <optional>
#include <string>
#include <variant>

#include "quadtune/synthesis/pid/pid_gains.hpp"
#include "quadtune/synthesis/pid/pid_optimum.hpp"
#include "quadtune/transfer_function.hpp"
#include "quadtune/workbench/design/margins_report.hpp"

namespace quadtune {

/// Gains for a crossover with a phase margin. See pid_for_crossover().
struct PidCrossover {
  double crossover = 0;     ///< [rad/s], > 0
  double phase_margin = 0;  ///< [deg], more than 0 and less than 180
};

/// A tuning rule for a first-order model with delay, which is fitted to the plant.
struct PidRule {
  std::string rule;  ///< "amigo", "simc", "ziegler-nichols", "cohen-coon" or "lambda"
  /// Time constant of the closed loop [s], > 0, for simc and lambda. None: for simc the delay of
  /// the model; for lambda the larger of the delay and a third of the model's time constant.
  std::optional<double> tau_c = {};
};

/// The requirements on the gains.
struct PidRequest {
  PidType type = PidType::PID;  ///< which terms the controller has
  double Tf = 0;  ///< time constant of the derivative filter [s], ≥ 0; a rule defines its own
  /// PidBounds: the maximum integral gain within the bounds, see max_integral_gain().
  std::variant<PidCrossover, PidRule, PidBounds> by;
};

/// Gains, the method by which they were computed, and the margins of their loop.
struct PidReport {
  PidType type = PidType::PID;       ///< which terms the controller has
  ContinuousTransferFunction plant;  ///< with its delay
  PidGains gains;                    ///< of the controller
  std::string how;                   ///< description of the method
  /// The derivative makes the loop improper: no margins; a Tf is needed.
  bool needs_filter = false;
  MarginsReport margins = {};  ///< of the loop of plant and controller
};

/// "P", "PI", "PD" or "PID".
/// @throws OptionError  "type", for other words
[[nodiscard]] PidType pid_type(const std::string& word);

/// @param plant    valid, with its delay
/// @param request  type, and crossover, rule or bounds
/// @throws OptionError   if a number is out of range, the rule is unknown, or the method does not
///                       support the type
/// @throws InvalidInput  as the rules
/// @throws NoSolution    with the culprit
[[nodiscard]] PidReport pid_report(const ContinuousTransferFunction& plant,
                                   const PidRequest& request);

}  // namespace quadtune
