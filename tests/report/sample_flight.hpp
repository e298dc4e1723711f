// SPDX-License-Identifier: Apache-2.0
/// A made-up flight with all that a report can show, for its tests and for looking at it.
#pragma once

#include <string>

#include "report/page/flight_report.hpp"

namespace quadtune::testing {

/// A figure of eight at 2.5 m, 9 m long, after a climb from the ground: attitude as the
/// accelerations ask for, a gust, an estimate that drifts a little, a slow position sensor.
///
/// @param duration  [s]
/// @param rate      rows a second [Hz]
[[nodiscard]] report::FlightReport sample_flight(double duration = 40, double rate = 200);

/// A vehicle that stands still in the air with one attitude [rad], heading north at yaw 0.
[[nodiscard]] report::FlightReport still_flight(double roll, double pitch, double yaw);

}  // namespace quadtune::testing
