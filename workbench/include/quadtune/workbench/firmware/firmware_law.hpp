// SPDX-License-Identifier: Apache-2.0
/// A firmware's controllers with their parameters as a law that flies: its structure, filters,
/// rates and limits. Theory: docs/theory.md, "Cascades of autopilots".
#pragma once

#include "quadtune/cascade.hpp"
#include "quadtune/exports/firmware_names.hpp"
#include "quadtune/model/vehicle.hpp"
#include "quadtune/simulation/flight.hpp"

namespace quadtune {

/// The law, at the period of the firmware's loop of the rates.
///
/// Position gives velocity, velocity an acceleration, acceleration the tilt and the thrust; angles
/// give rates, rates torques. Each loop has the filters and the limits of the firmware and is
/// computed as often as there; a torque acts one sample after the rates that it answers.
///
/// Left out: notches, filters that follow the throttle (they stand at their lowest cut-off), slew
/// limits, the shaping of set points, and what scales gains in flight (TPA, anti-gravity, iterm
/// relax of Betaflight; the square-root controllers of ArduPilot). Commands reach the motors by
/// quadtune's allocation, and a unit of output is the torque that it is at hover.
///
/// @param pilot  loops that the firmware leaves to its pilot: x, y, altitude and heading of
///               Betaflight
/// @throws InvalidInput, NoSolution  as firmware_loops()
[[nodiscard]] OwnController firmware_controller(const Vehicle& vehicle,
                                                const StoredParameters& parameters,
                                                const CascadeGains& pilot);

/// Gives a flight with such a law the inertial sensors of an autopilot's board: a reading for each
/// of its samples, with the noise density of the vehicle's file. An estimator of the kind `general`
/// runs at about 200 Hz on means of these readings, and the law has the newest body rates. It keeps
/// the numbers of FlightSetup::general_filter but the lags and variances of the inertial readings,
/// which depend on the period.
/// @param setup  with the law, the estimator and the mission
/// @throws InvalidInput  as general_filter_settings()
void fly_on_board(FlightSetup& setup);

}  // namespace quadtune
