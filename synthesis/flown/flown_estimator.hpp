// SPDX-License-Identifier: Apache-2.0
/// The on-board estimators, linearized about a hover.
#pragma once

#include <Eigen/Core>
#include <array>
#include <functional>
#include <string>
#include <vector>

#include "quadtune/simulation/flight.hpp"

namespace quadtune::internal {

/// The sensors that an estimator may use, in the order of their values in the vector of readings.
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

/// Whether the estimator uses a sensor.
[[nodiscard]] bool reads(const FlightSetup& setup, Reading reading);

/// Which sensors have a new sample in a control period of a hover, and the age of each sample.
struct HoverFrame {
  std::array<bool, kReadings> fresh{};
  std::array<double, kReadings> age{};  ///< [s]
};

/// The Jacobian of one estimator step. Rows: the estimator's next state, then its estimates of the
/// 12 states.
struct EstimatorStep {
  Eigen::MatrixXd from_state;   ///< columns: the estimator's previous state
  Eigen::MatrixXd from_frame;   ///< columns: kFrameSize readings
  Eigen::MatrixXd from_speeds;  ///< columns: rotor speeds commanded in the previous period [rad/s]
};

struct LinearEstimator {
  std::vector<Signal> states;
  Eigen::VectorXd scale;             ///< typical magnitude of each state, for comparisons
  std::vector<EstimatorStep> steps;  ///< N steps; the first is that of control period `first`
  std::size_t first = 0;             ///< periods until the covariances converged, a multiple of N
  bool settled = true;               ///< whether the covariances converged
};

/// Computes the Jacobians of the estimator of a setup after its covariances have converged.
/// @param setup   with an estimator other than truth
/// @param dt      control period [s]
/// @param values  readings in the hover, kFrameSize; NaN for a sensor that is not used
/// @param x       the estimates of the 12 states in the hover
/// @param speeds  rotor speeds in the hover [rad/s]
/// @param frame   new samples in each control period
/// @param N       number of control periods after which the frames repeat, except for the first
[[nodiscard]] LinearEstimator linear_estimator(const FlightSetup& setup, double dt,
                                               const Eigen::VectorXd& values,
                                               const StateVector<double>& x,
                                               const Eigen::VectorXd& speeds,
                                               const std::function<HoverFrame(std::size_t)>& frame,
                                               std::size_t N);

}  // namespace quadtune::internal
