// SPDX-License-Identifier: Apache-2.0
/// With which numbers a flight flies the uquad's filter.
#pragma once

#include "quadtune/estimation/uquad_filter.hpp"
#include "quadtune/model/sensors.hpp"
#include "quadtune/simulation/flight.hpp"

namespace quadtune {

/// The filter for these sensors, by uquad_filter_in_si(): without GPS and positions from images it
/// leaves the horizontal position out.
[[nodiscard]] UquadFilterSettings<double> uquad_filter_for(const Sensors& sensors);

/// FlightSetup::uquad_filter with what a flight tells it: control period, the earth's field, the
/// pressure on the ground.
/// @param sensors           that fly
/// @param calibration_time  that the vehicle stands still at the start [s]
/// @throws InvalidInput     as validate()
[[nodiscard]] UquadFilterSettings<double> uquad_filter_settings(const FlightSetup& setup,
                                                                const Sensors& sensors,
                                                                double calibration_time);

}  // namespace quadtune
