// SPDX-License-Identifier: Apache-2.0
/// A firmware's controllers with their parameters as a flying law: structure, filters, rates and
/// limits. Theory: docs/theory.md, "Cascades of autopilots".
#pragma once

#include "quadtune/cascade.hpp"
#include "quadtune/exports/firmware_names.hpp"
#include "quadtune/model/vehicle.hpp"
#include "quadtune/simulation/flight.hpp"

namespace quadtune {

/// Creates the law, with the period of the firmware's rate loop.
///
/// The position loop computes a velocity set point, the velocity loop an acceleration, the
/// acceleration gives tilt and thrust; angle loops compute rate set points, rate loops torques.
/// Each loop has the filters and limits of the firmware and runs at its rate there; a torque acts
/// one sample after the rates that it was computed from.
///
/// Not modelled: notch filters, filters that depend on the throttle (modelled at their lowest
/// cut-off), slew limits, set-point shaping, and gain scaling in flight (TPA, anti-gravity and
/// iterm relax of Betaflight; the square-root controllers of ArduPilot). Commands are allocated to
/// the motors by quadtune's allocation, and a unit of output is the torque that it produces at
/// hover.
///
/// @param vehicle     valid
/// @param parameters  missing ones have the firmware's defaults
/// @param pilot       loops that the firmware leaves to its pilot: x, y, altitude and heading for
///                    Betaflight
/// @throws InvalidInput, NoSolution  as firmware_loops()
[[nodiscard]] OwnController firmware_controller(const Vehicle& vehicle,
                                                const StoredParameters& parameters,
                                                const CascadeGains& pilot);

/// Replaces the inertial sensors of a flight with such a law by those of an autopilot board: one
/// sample per sample of the law, with the noise density of the vehicle's file. An estimator of kind
/// `general` runs at about 200 Hz on means of these samples, and the law uses the newest body
/// rates. The estimator keeps the numbers of FlightSetup::general_filter except the lags and
/// variances of the inertial samples, which depend on the period.
/// @param setup  with the law, the estimator and the mission
/// @throws InvalidInput  as general_filter_settings()
void fly_on_board(FlightSetup& setup);

}  // namespace quadtune
