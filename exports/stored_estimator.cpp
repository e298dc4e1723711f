// SPDX-License-Identifier: Apache-2.0
#include "quadtune/exports/stored_estimator.hpp"

namespace quadtune {

void take_numbers(const StoredEstimator& estimator, FlightSetup& setup) {
  if (estimator.general) setup.general_filter = estimator.general;
  if (!estimator.uquad) return;
  // Settings that depend on the sensors are kept.
  const bool position = setup.uquad_filter.position;
  setup.uquad_filter = *estimator.uquad;
  setup.uquad_filter.position = position;
}

bool feed_estimator(const Sensors& sensors, const std::string& estimator) {
  switch (estimator_kind(estimator, "exporter")) {
    case EstimatorKind::mambo:
      return sensors.sonar.has_value();
    case EstimatorKind::uquad:
      return sensors.barometer && sensors.magnetometer;
    case EstimatorKind::general:
      return general_filter_lacks(sensors).empty();
    case EstimatorKind::truth:
    case EstimatorKind::own:
      break;
  }
  return true;
}

}  // namespace quadtune
