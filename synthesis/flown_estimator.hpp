// SPDX-License-Identifier: Apache-2.0
/// The estimators as they run on board, linearized about a hover.
#pragma once

#include <Eigen/Core>
#include <array>
#include <functional>
#include <string>
#include <vector>

#include "quadtune/simulation/flight.hpp"

namespace quadtune::internal {

/// The sensors that an estimator may read, in the order in which their values stand in one vector.
enum class Reading {
  specific_force,
  rates,
  magnetic_field,
  pressure,
  sonar,
  flow,
  gps_position,
  gps_velocity,
  vision,
};
inline constexpr std::size_t kReadings = 9;
inline constexpr std::array<int, kReadings> kReadingSize = {3, 3, 3, 1, 1, 2, 3, 3, 3};
inline constexpr std::array<int, kReadings> kReadingFirst = {0, 3, 6, 9, 10, 11, 13, 16, 19};
inline constexpr int kFrameSize = 22;

/// Whether the estimator looks at a sensor.
[[nodiscard]] bool reads(const FlightSetup& setup, Reading reading);

/// What the sensors say in a control period of a hover.
struct HoverFrame {
  std::array<bool, kReadings> fresh{};
  std::array<double, kReadings> age{};  ///< [s]
};

/// One control period: rows of the estimator's state after it, then of the 12 states that it
/// believes.
struct EstimatorStep {
  Eigen::MatrixXd from_state;   ///< columns: its state before
  Eigen::MatrixXd from_frame;   ///< columns: kFrameSize readings
  Eigen::MatrixXd from_speeds;  ///< columns: rotor speeds told in the period that ends [rad/s]
};

struct LinearEstimator {
  std::vector<Signal> states;
  Eigen::VectorXd scale;             ///< what counts as 1 of each state
  std::vector<EstimatorStep> steps;  ///< N, the first for period `first`
  std::size_t first = 0;  ///< a multiple of N: how many periods its covariances took to settle
  bool settled = true;    ///< whether they did
};

/// @param setup   with estimator mambo or uquad
/// @param dt      control period [s]
/// @param values  what the sensors say in the hover, kFrameSize; NaN for none
/// @param x       the hover, as the estimator believes it
/// @param speeds  of the rotors there [rad/s]
/// @param frame   of each control period
/// @param N       after which the frames repeat, but for the first of them
[[nodiscard]] LinearEstimator linear_estimator(const FlightSetup& setup, double dt,
                                               const Eigen::VectorXd& values,
                                               const StateVector<double>& x,
                                               const Eigen::VectorXd& speeds,
                                               const std::function<HoverFrame(std::size_t)>& frame,
                                               std::size_t N);

}  // namespace quadtune::internal
