// SPDX-License-Identifier: Apache-2.0
/// A synthetic flight with everything that a report can show, for its tests and for viewing.
#pragma once

#include <string>

#include "report/page/flight_report.hpp"

namespace quadtune::testing {

/// A figure of eight at 2.5 m, 9 m long, after a climb from the ground: an attitude that matches
/// the accelerations, a gust, an estimate that drifts slightly, a slow position sensor.
///
/// @param duration  [s]
/// @param rate      rows per second [Hz]
[[nodiscard]] report::FlightReport sample_flight(double duration = 40, double rate = 200);

/// A vehicle that hovers with a constant attitude [rad], heading north at yaw 0.
[[nodiscard]] report::FlightReport still_flight(double roll, double pitch, double yaw);

}  // namespace quadtune::testing
