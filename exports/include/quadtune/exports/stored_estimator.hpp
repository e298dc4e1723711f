// SPDX-License-Identifier: Apache-2.0
/// The estimator that a law was designed with, as gains.json holds it.
#pragma once

#include <optional>
#include <string>

#include "quadtune/estimation/general_filter_settings.hpp"
#include "quadtune/estimation/uquad_filter.hpp"
#include "quadtune/model/sensors.hpp"
#include "quadtune/simulation/flight.hpp"

namespace quadtune {

struct StoredEstimator {
  /// "general", "mambo" or "uquad", as `quadtune fly --estimator` has them. True states are no
  /// estimator: a file that named them would hide later that nothing is estimated.
  std::string name;
  std::optional<GeneralFilterSettings> general = {};
  /// Of the uquad's filter its period, Q and R, where they are others than uquad_filter_in_si():
  /// covariances from logs. Nothing else of these settings is in the file.
  std::optional<UquadFilterSettings<double>> uquad = {};

  friend bool operator==(const StoredEstimator&, const StoredEstimator&) = default;
};

/// Gives the numbers of an estimator to a flight that has this estimator.
void take_numbers(const StoredEstimator& estimator, FlightSetup& setup);

/// Whether sensors are those that an estimator needs at least.
/// @throws InvalidInput  if there is no such estimator
[[nodiscard]] bool feed_estimator(const Sensors& sensors, const std::string& estimator);

}  // namespace quadtune
