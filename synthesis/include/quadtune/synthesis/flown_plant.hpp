// SPDX-License-Identifier: Apache-2.0
/// The complete plant of a control law: a hovering vehicle, its rotors' lag, the delay of its
/// commands, its sensors with their sample clocks, and its estimator. Theory: docs/theory.md, "The
/// flown loop".
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

/// Options of flown_plant() in addition to the setup of a flight.
struct FlownPlantOptions {
  InputKind inputs = InputKind::wrench;  ///< the quantities that the law commands
  double dt = 0.005;                     ///< control period [s], > 0
  double height = 1.1;                   ///< of the hover above the ground [m], > 0
  /// From the law's output to the rotors' command [s], in addition to the vehicle's own delay
  /// (MotorCommand::delay and half of its jitter); with that from 0 to kMostDelayPeriods dt.
  double command_delay = 0;
  /// Whether the errors of the sensors are inputs of the model: FlownPlant::noise.
  bool noise = false;
};

/// A linear model about a hover with the heading north. It is exact for inputs that are held over a
/// control period and for sensors that sample at any time within it.
///
/// Inputs: deviations of the law's commands from trim. Outputs: deviations of the estimates of the
/// 12 states of ned_convention() from the hover, at the time when the law computes its command.
struct FlownPlant {
  PeriodicLti plant;
  std::vector<Signal> drifts;      ///< true states that no sensor observes, e.g. px, py, yaw
  Eigen::VectorXd scale;           ///< a typical size of each state of `plant`, to compare them by
  std::vector<std::string> notes;  ///< omissions and roundings, one sentence each
  /// N matrices (nx × nw), empty unless FlownPlantOptions::noise is set. The noise adds
  /// noise[k] w[k] to x[k+1], where w is white with unit variances. `plant` then keeps the states
  /// that no input affects as well: slowly varying sensor errors, and true states that drift.
  std::vector<Eigen::MatrixXd> noise;
  /// (nx) initial variances: of a stationary sensor error its variance, of all other states 0.
  Eigen::VectorXd noise_start;
};

/// Builds the plant from the true vehicle, its sensors, and the estimator with its settled gains.
/// The model includes the sensors' sample clocks, delays, responses and scale factors, and if asked
/// their white noise, random walks, correlated errors and, as white noise, quantization. It omits
/// biases that do not change, range, vibration and lost samples.
/// @param setup  vehicle, flown vehicle, sensors, estimator and environment are used
/// @throws InvalidInput  for a period, height or delay out of range, a sensor's delay beyond
///                       kMostDelayPeriods control periods, or a vehicle that cannot hover; the
///                       message names the cause
[[nodiscard]] FlownPlant flown_plant(const FlightSetup& setup, const FlownPlantOptions& options);

/// A state feedback as a law for flown_plant(): inputs are the 12 states, outputs its commands. As
/// on board, an integral is advanced before it acts. The commands that the law remembers
/// (CommandMemory) are its own outputs.
/// @throws InvalidInput  as state_feedback_settings()
[[nodiscard]] DiscreteLti flown_law(const Vehicle& vehicle, const Gains& gains, double dt);
/// A cascade as a law for flown_plant(): inputs are the 12 states, outputs the wrench.
/// @throws InvalidInput  as cascade_law()
[[nodiscard]] DiscreteLti flown_law(const CascadeGains& gains, PidMethod method);

/// The law of a setup, and the quantities that it commands.
[[nodiscard]] DiscreteLti flown_law(const FlightSetup& setup);
[[nodiscard]] InputKind input_kind(const FlightSetup& setup);

}  // namespace quadtune
