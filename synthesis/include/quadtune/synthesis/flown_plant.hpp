// SPDX-License-Identifier: Apache-2.0
/// The plant that a control law really has: a hovering vehicle, its rotors' lag, the delay of its
/// commands, its sensors with their clocks, and its estimator. Theory: docs/theory.md, "The flown
/// loop".
#pragma once

#include <Eigen/Core>
#include <string>
#include <vector>

#include "quadtune/cascade.hpp"
#include "quadtune/control/pid_method.hpp"
#include "quadtune/convention.hpp"
#include "quadtune/gains.hpp"
#include "quadtune/lti.hpp"
#include "quadtune/simulation/flight.hpp"
#include "quadtune/synthesis/periodic_loop.hpp"
#include "quadtune/synthesis/uncertain_loop.hpp"

namespace quadtune {

/// What a flown plant is built for, beside a flight's setup.
struct FlownPlantOptions {
  InputKind inputs = InputKind::wrench;  ///< what the law commands
  double dt = 0.005;                     ///< control period [s], > 0
  double height = 1.1;                   ///< of the hover above the ground [m], > 0
  double command_delay = 0;  ///< from the law's output to the rotors' command [s], [0, kMostDelayPeriods dt]
};

/// Linear about a hover with the heading north, exact for inputs that are held over a control
/// period and for sensors that sample at any instant.
///
/// Inputs: the law's commands about their trim. Outputs: the 12 states of ned_convention() about
/// the hover as the law gets them, at the instant at which it computes its command.
struct FlownPlant {
  PeriodicLti plant;
  std::vector<Signal> drifts;      ///< true states that no sensor sees, e.g. px, py, yaw
  Eigen::VectorXd scale;           ///< one a state of `plant`: what counts as 1, to compare them by
  std::vector<std::string> notes;  ///< what was left out or rounded, a sentence each
};

/// Builds the plant from the vehicle as it truly is, its sensors, and the estimator as it runs,
/// with the gains that its covariances settle to. Of the sensors their clocks, delays, responses
/// and scale factors count; bias, noise, limits, quanta and lost samples do not.
/// @param setup  its vehicle, flown vehicle, sensors, estimator and environment
/// @throws InvalidInput  for a period, height or delay out of range, a sensor's delay beyond
///                       kMostDelayPeriods control periods, or a vehicle that cannot hover, with its culprit
[[nodiscard]] FlownPlant flown_plant(const FlightSetup& setup, const FlownPlantOptions& options);

/// A state feedback as a law for flown_plant(): from the 12 states to its commands. An integral
/// acts in the period in which it is advanced, as it runs.
/// @throws InvalidInput  as state_feedback_settings()
[[nodiscard]] DiscreteLti flown_law(const Vehicle& vehicle, const Gains& gains, double dt);
/// A cascade likewise, to the wrench.
/// @throws InvalidInput  as cascade_law()
[[nodiscard]] DiscreteLti flown_law(const CascadeGains& gains, PidMethod method);

/// The law of a setup and what it commands.
[[nodiscard]] DiscreteLti flown_law(const FlightSetup& setup);
[[nodiscard]] InputKind input_kind(const FlightSetup& setup);

}  // namespace quadtune
