// SPDX-License-Identifier: Apache-2.0
/// The estimator with which a law was designed, as stored in gains.json.
#pragma once

#include <optional>
#include <string>

#include "quadtune/estimation/general_filter_settings.hpp"
#include "quadtune/estimation/uquad_filter.hpp"
#include "quadtune/model/sensors.hpp"
#include "quadtune/simulation/flight.hpp"

namespace quadtune {

/// An estimator and the numbers that differ from its defaults.
struct StoredEstimator {
  /// "general", "mambo" or "uquad", as in `quadtune fly --estimator`. "truth" is not allowed: a
  /// file that named it would later hide that no state is estimated.
  std::string name;
  /// Settings of the general filter; empty: those of the vehicle's sensors.
  std::optional<GeneralFilterSettings> general = {};
  /// Period, Q and R of the uquad's filter if they differ from uquad_filter_in_si(), e.g.
  /// covariances from logs. No other settings are stored.
  std::optional<UquadFilterSettings<double>> uquad = {};

  friend bool operator==(const StoredEstimator&, const StoredEstimator&) = default;
};

/// Copies the numbers of an estimator to a flight that uses this estimator.
void take_numbers(const StoredEstimator& estimator, FlightSetup& setup);

/// Whether the sensors include all that an estimator requires.
/// @throws InvalidInput  if there is no such estimator
[[nodiscard]] bool feed_estimator(const Sensors& sensors, const std::string& estimator);

}  // namespace quadtune
