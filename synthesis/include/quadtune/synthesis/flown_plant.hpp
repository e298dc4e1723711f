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
  double height = 1.1;                   ///< height of the hover above the ground [m], > 0
  /// Delay from the output of the law to the rotor commands [s], in addition to the vehicle's own
  /// delay (MotorCommand::delay and half of its jitter). The sum is in [0, kMaxDelayPeriods dt].
  double command_delay = 0;
  /// Whether the errors of the sensors are inputs of the model: FlownPlant::noise.
  bool noise = false;
  /// Whether the model leaves out the couplings between north, east, altitude and yaw that unequal
  /// rotors, arms and products of inertia cause. With wrench inputs, the plant of each of these axes
  /// then is a part of its own, as gains for a single axis require. Without rotors for all four, or
  /// with other inputs, this has no effect.
  bool separate_axes = false;
};

/// A linear model about a hover with the heading north. It is exact for inputs that are held over a
/// control period and for sensors that sample at any time within it.
///
/// Inputs: deviations of the law's commands from trim. Outputs: deviations of the estimates of the
/// 12 states of ned_convention() from the hover, at the time when the law computes its command.
struct FlownPlant {
  PeriodicLti plant;               ///< sampled with the control period, from commands to estimates
  std::vector<Signal> drifts;      ///< true states that no sensor observes, e.g. px, py, yaw
  Eigen::VectorXd scale;           ///< typical magnitude of each state of `plant`, for comparisons
  std::vector<std::string> notes;  ///< omissions and roundings, one sentence each
  /// N matrices (nx × nw), empty unless FlownPlantOptions::noise is set. The noise adds
  /// noise[k] w[k] to x[k+1], where w is white with unit variances. `plant` then keeps the states
  /// that no input affects as well: slowly varying sensor errors, and true states that drift.
  std::vector<Eigen::MatrixXd> noise;
  /// (nx) initial variances: that of a stationary sensor error is its variance, all others are 0.
  Eigen::VectorXd noise_start;
};

/// Builds the plant from the true vehicle, its sensors, and the estimator with its steady-state
/// gains. The model includes the sensors' sample clocks, delays, responses and scale factors and,
/// if FlownPlantOptions::noise is set, their white noise, random walks, correlated errors and, as
/// white noise, quantization. It omits biases that do not change, range, vibration and lost
/// samples.
/// @param setup    vehicle, flown vehicle, sensors, estimator and environment are used
/// @param options  height, inputs, delay and noise of the plant
/// @throws InvalidInput  if the period, the height or the delay is out of range, if the delay of a
///                       sensor exceeds kMaxDelayPeriods control periods, or if the vehicle cannot
///                       hover; the message names the cause
[[nodiscard]] FlownPlant flown_plant(const FlightSetup& setup, const FlownPlantOptions& options);

/// Converts a state feedback to a law for flown_plant(): the inputs are the 12 states, the outputs
/// are its commands. As on board, an integral is advanced before it is used. The past commands in
/// CommandMemory are the law's own outputs.
/// @throws InvalidInput  for the reasons of state_feedback_settings()
[[nodiscard]] DiscreteLti flown_law(const Vehicle& vehicle, const Gains& gains, double dt);
/// Converts a cascade to a law for flown_plant(): the inputs are the 12 states, the outputs are the
/// wrench.
/// @throws InvalidInput  for the reasons of cascade_law()
[[nodiscard]] DiscreteLti flown_law(const CascadeGains& gains, PidMethod method);

/// The law of a setup. input_kind() returns the quantities that it commands.
[[nodiscard]] DiscreteLti flown_law(const FlightSetup& setup);

/// The quantities that the law of a setup commands.
[[nodiscard]] InputKind input_kind(const FlightSetup& setup);

}  // namespace quadtune
