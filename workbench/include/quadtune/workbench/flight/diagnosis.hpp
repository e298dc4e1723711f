// SPDX-License-Identifier: Apache-2.0
/// Diagnoses a failed flight and suggests a command. Theory: docs/theory.md, "Why a flight failed".
#pragma once

#include <limits>
#include <optional>
#include <string>

#include "quadtune/workbench/flight/fly.hpp"

namespace quadtune {

/// The cause of a failure.
enum class FlightCause {
  none,            ///< it passed
  unstable_loop,   ///< the flown loop is unstable, with true states too
  estimator_loop,  ///< the flown loop is unstable with this estimator, stable with true states
  event,           ///< an event of the mission: without it and with true states, the law passes
  motor_limits,    ///< the motors are at their limits, with true states too
  law,             ///< with true states the law exceeds the mission's limits by half or more
  mission_limits,  ///< with true states the law exceeds the mission's limits by less than half
  estimator,       ///< the estimate is worse than the sensors allow
  drift,           ///< no sensor measures the position, and its estimate drifts
  sensors,         ///< the estimate is as good as the sensors allow
  noise,           ///< the law converts the noise of the estimate into motion or commands
};
/// For example "unstable loop" or "motor limits".
[[nodiscard]] std::string to_string(FlightCause cause);

/// The quantities on which the diagnosis is based. NaN: unknown.
struct FlightEvidence {
  bool passes_with_true_states = false;                   ///< within the mission's own limits
  bool passes_with_ideal_sensors = false;                 ///< likewise
  FlightEnd end_with_true_states = FlightEnd::completed;  ///< how the flight with true states ended
  double saturation = 0;                   ///< share of the flight at a motor's limit [1]
  double saturation_with_true_states = 0;  ///< likewise
  double estimate_rms = std::numeric_limits<double>::quiet_NaN();    ///< of the position [m]
  double bound_rms = std::numeric_limits<double>::quiet_NaN();       ///< of the best filter [m]
  double estimate_limit = std::numeric_limits<double>::quiet_NaN();  ///< limit that the best filter
                                                                     ///< satisfies [m]
  double largest_pole = std::numeric_limits<double>::quiet_NaN();    ///< largest |z| of the flown
                                                                     ///< loop
};

/// The cause of a failure and a remedy.
struct Diagnosis {
  FlightCause cause = FlightCause::none;  ///< none if nothing was found
  FlightEvidence evidence;                ///< what the diagnosis is based on
  std::string why;                        ///< the mechanism, in one sentence with its numbers
  std::string next;                       ///< a remedy, with a command of this program
};

/// Flies the plan again with true states and with ideal sensors, analyses the flown loop, and
/// compares the estimate with the bound of the sensors.
///
/// @param plan    plan of the flight, from plan_flight()
/// @param flight  result of the plan
/// @throws InvalidInput, Interrupted  as fly()
[[nodiscard]] Diagnosis diagnose(const PlannedFlight& plan, const FlownFlight& flight);

}  // namespace quadtune
