// SPDX-License-Identifier: Apache-2.0
/// An estimator of the user's own, which fly() flies like those that come with quadtune.
#pragma once

#include <functional>
#include <memory>
#include <string>

#include "quadtune/estimation/on_board.hpp"
#include "quadtune/model/vehicle.hpp"

namespace quadtune {

/// What is known when a flight begins.
struct EstimatorStart {
  const Vehicle& vehicle;     ///< as law and estimator believe it to be
  double dt = 0;              ///< control period [s]
  StateVector<double> state;  ///< the 12 states of ned_convention() at the start
};

/// What an estimator may use in one control period.
struct EstimatorInput {
  double time = 0;                 ///< of this period [s]
  SensorFrame<double> sensors;     ///< the newest samples; which are fresh, and how old
  RotorSpeeds<double> speeds;      ///< (rotors) commanded in the period before [rad/s]
  bool on_ground = false;          ///< known to stand: before take-off and with motors switched off
  StateVector<double> true_state;  ///< which no flight program has: to measure estimation errors
};

/// Implement this, and have OwnEstimator make it. One object estimates one flight.
class FlightEstimator {
 public:
  FlightEstimator() = default;
  FlightEstimator(const FlightEstimator&) = delete;
  FlightEstimator& operator=(const FlightEstimator&) = delete;
  virtual ~FlightEstimator() = default;

  /// Called once each control period, before the law.
  /// @return  x: the 12 states of ned_convention(), yaw unwrapped. An entry that is not finite, or
  ///          Estimate::finite = false, ends the flight: its FlightResult::culprit names the entry.
  [[nodiscard]] virtual Estimate<double> update(const EstimatorInput& input) = 0;
};

/// EstimatorKind::own of a FlightSetup.
struct OwnEstimator {
  std::string name;  ///< in logs and messages
  /// Makes the estimator of one flight, in the thread that flies it.
  std::function<std::unique_ptr<FlightEstimator>(const EstimatorStart&)> make;
};

}  // namespace quadtune
