// SPDX-License-Identifier: Apache-2.0
/// Settings of the uquad's filter for a simulated flight.
#pragma once

#include "quadtune/estimation/uquad_filter.hpp"
#include "quadtune/model/sensors.hpp"
#include "quadtune/simulation/flight.hpp"

namespace quadtune {

/// The filter of uquad_filter_in_si() for these sensors. Without GPS and vision it does not
/// estimate the horizontal position.
[[nodiscard]] UquadFilterSettings<double> uquad_filter_for(const Sensors& sensors);

/// FlightSetup::uquad_filter completed with data of the flight: control period, magnetic field of
/// the earth, pressure on the ground.
/// @param sensors           of the flight
/// @param calibration_time  for which the vehicle is stationary at the start [s]
/// @throws InvalidInput     as validate()
[[nodiscard]] UquadFilterSettings<double> uquad_filter_settings(const FlightSetup& setup,
                                                                const Sensors& sensors,
                                                                double calibration_time);

}  // namespace quadtune
