// SPDX-License-Identifier: Apache-2.0
#include "quadtune/simulation/uquad_flight.hpp"

#include <cmath>

namespace quadtune {

UquadFilterSettings<double> uquad_filter_for(const Sensors& sensors) {
  UquadFilterSettings<double> settings = uquad_filter_in_si<double>();
  settings.position = sensors.gps || sensors.vision;
  return settings;
}

UquadFilterSettings<double> uquad_filter_settings(const FlightSetup& setup, const Sensors& sensors,
                                                  double calibration_time) {
  const Eigen::Vector3d& field = setup.environment.magnetic_field;
  UquadFilterSettings<double> settings = setup.uquad_filter;
  settings.dt = control_period(setup);
  settings.calibration_time = calibration_time;
  if (settings.field_norm == 0) settings.field_norm = field.norm();
  settings.declination = std::atan2(field.y(), field.x());
  if (sensors.barometer) settings.reference_pressure = sensors.barometer->ground_pressure;
  validate(settings, "estimator");
  return settings;
}

}  // namespace quadtune
