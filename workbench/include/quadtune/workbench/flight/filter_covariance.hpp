// SPDX-License-Identifier: Apache-2.0
/// The error covariance of the optimal filter along a flight, for sensors with their own rates and
/// delays. Theory: docs/theory.md, "What the sensors can know".
#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <vector>

namespace quadtune {

/// The largest number of states of an error model.
inline constexpr int kMaxErrorStates = 12;

/// A sensor that samples one linear combination of the states.
struct LinearSensor {
  double rate = 0;    ///< [Hz], > 0; sample n is taken at n/rate
  double delay = 0;   ///< from the sample to its arrival [s], ≥ 0
  Eigen::VectorXd H;  ///< (n): the sample is H x + noise
  double R = 0;       ///< variance of a sample [unit²], ≥ 0
};

/// Errors that follow x' = (A - diag(decay)) x + w, and the sensors that measure them.
struct ErrorModel {
  Eigen::MatrixXd A;                  ///< (n × n), nilpotent with A⁴ = 0: chains of integrators
  Eigen::MatrixXd Q;                  ///< (n × n) spectral density of w [unit²/s], ≥ 0
  Eigen::MatrixXd P0;                 ///< (n × n) covariance at the beginning, ≥ 0
  std::vector<LinearSensor> sensors;  ///< at least one
  /// (n), or empty for none [1/s], ≥ 0: a decaying state neither drives another nor is driven.
  Eigen::VectorXd decay;
};

/// The error of one state over a flight.
struct ErrorCovariance {
  Eigen::VectorXd variance;         ///< (outputs) at each output time
  std::vector<std::size_t> starts;  ///< outputs that have a row in `covariance`
  /// (starts × outputs): between the error at the start's output and at a later one; 0 for earlier
  /// outputs.
  Eigen::MatrixXd covariance;
};

/// Propagates the covariance of the Kalman filter that uses every sample that has arrived.
///
/// The filter runs at the time of the oldest sample that may still arrive; the covariance of an
/// output is predicted from it with the samples that have arrived since. If a sensor has more than
/// 20,000 samples, neighbouring samples are replaced by one with the variance of their mean.
///
/// @param model   n = 1 to kMaxErrorStates
/// @param begin   time at which the errors begin to grow from P0 [s]
/// @param times   of the outputs [s], increasing; before `begin` the error has the variance P0
/// @param starts  indices into `times`, increasing
/// @return        error of the first state
/// @throws InvalidInput  if shapes, rates, delays or variances are out of range
[[nodiscard]] ErrorCovariance best_filter_error(const ErrorModel& model, double begin,
                                                const std::vector<double>& times,
                                                const std::vector<std::size_t>& starts);

/// The covariance of all states at the time `duration`, from P0 at 0, with the samples taken from 0
/// on that have arrived by then, each applied at its own sampling time.
/// @return  (n × n)
/// @throws InvalidInput  as best_filter_error()
[[nodiscard]] Eigen::MatrixXd best_filter_covariance(const ErrorModel& model, double duration);

}  // namespace quadtune
