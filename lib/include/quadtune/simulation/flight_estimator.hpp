// SPDX-License-Identifier: Apache-2.0
/// Interface for user-defined estimators, which fly() treats like the built-in ones.
#pragma once

#include <functional>
#include <memory>
#include <string>

#include "quadtune/estimation/on_board.hpp"
#include "quadtune/model/vehicle.hpp"

namespace quadtune {

/// Data available at the start of a flight.
struct EstimatorStart {
  const Vehicle& vehicle;     ///< the model that law and estimator use
  double dt = 0;              ///< control period [s]
  StateVector<double> state;  ///< the 12 states of ned_convention() at the start
};

/// Input of an estimator in one control period.
struct EstimatorInput {
  double time = 0;              ///< beginning of this period [s]
  SensorFrame<double> sensors;  ///< newest samples, which of them are fresh, and their ages
  RotorSpeeds<double> speeds;   ///< (rotors) commanded in the previous period [rad/s]
  /// Known to be on the ground: before take-off and after motor stop
  bool on_ground = false;
  /// Not available to real flight programs; for computing estimation errors
  StateVector<double> true_state;
};

/// Base class of user-defined estimators; OwnEstimator creates the objects. One object serves one
/// flight.
class FlightEstimator {
 public:
  FlightEstimator() = default;
  FlightEstimator(const FlightEstimator&) = delete;
  FlightEstimator& operator=(const FlightEstimator&) = delete;
  virtual ~FlightEstimator() = default;

  /// Called once per control period, before the law.
  /// @return  x: the 12 states of ned_convention(), yaw not wrapped. An entry that is not finite,
  ///          or Estimate::finite = false, ends the flight; FlightResult::culprit names the entry.
  [[nodiscard]] virtual Estimate<double> update(const EstimatorInput& input) = 0;
};

/// A user-defined estimator for EstimatorKind::own.
struct OwnEstimator {
  std::string name;  ///< shown in logs and messages
  /// Creates the estimator of one flight, in the thread that simulates it.
  std::function<std::unique_ptr<FlightEstimator>(const EstimatorStart&)> make;
};

}  // namespace quadtune
