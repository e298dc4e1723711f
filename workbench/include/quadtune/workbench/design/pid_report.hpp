// SPDX-License-Identifier: Apache-2.0
/// PID gains for a transfer function: for a crossover, by a published rule, or the best within
/// bounds.
#pragma once

#include <optional>
#include <string>
#include <variant>

#include "quadtune/synthesis/pid_gains.hpp"
#include "quadtune/synthesis/pid_optimum.hpp"
#include "quadtune/transfer_function.hpp"
#include "quadtune/workbench/design/margins_report.hpp"

namespace quadtune {

/// The loop crosses 1 here, with this margin. See pid_for_crossover().
struct PidCrossover {
  double crossover = 0;     ///< [rad/s], > 0
  double phase_margin = 0;  ///< [deg], more than 0 and less than 180
};

/// A rule for a model of one lag and a delay, which is fitted to the plant.
struct PidRule {
  std::string rule;  ///< "amigo", "simc", "ziegler-nichols", "cohen-coon" or "lambda"
  /// Time constant of the closed loop [s], > 0, for simc and lambda; none: the model's delay, and
  /// the greater of the delay and a third of the time constant.
  std::optional<double> tau_c = {};
};

/// What is asked for.
struct PidRequest {
  PidType type = PidType::PID;
  double Tf = 0;  ///< time constant of the derivative's filter [s], ≥ 0; a rule has its own
  /// With PidBounds the greatest integral gain, see greatest_integral_gain().
  std::variant<PidCrossover, PidRule, PidBounds> by;
};

/// Gains, how they were found, and the margins of their loop.
struct PidReport {
  PidType type = PidType::PID;
  ContinuousTransferFunction plant;
  PidGains gains;
  std::string how;  ///< in words
  bool needs_filter =
      false;  ///< the derivative makes the loop improper: no margins, a Tf is needed
  MarginsReport margins = {};
};

/// "P", "PI", "PD" or "PID".
/// @throws OptionError  naming "type"
[[nodiscard]] PidType pid_type(const std::string& word);

/// @param plant  a valid one, with its delay
/// @throws OptionError   for numbers out of range, a rule that is not known, and a type that the
///                       way to find gains does not have
/// @throws InvalidInput  as the rules
/// @throws NoSolution    with the culprit
[[nodiscard]] PidReport pid_report(const ContinuousTransferFunction& plant,
                                   const PidRequest& request);

}  // namespace quadtune
