// SPDX-License-Identifier: Apache-2.0
/// A linear filter with unknown noise: its dynamics, its sensors, and the parameters of its
/// covariances that are estimated from logs.
#pragma once

#include <Eigen/Core>
#include <limits>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "quadtune/estimation/covariance_model.hpp"
#include "quadtune/lti.hpp"

namespace quadtune {

/// Prior distribution of a parameter: its logarithm is normally distributed.
struct NoisePrior {
  double median = 1;     ///< of the variance, > 0
  double deviation = 1;  ///< standard deviation of the logarithm, > 0
};

/// One entry of θ: the logarithm of a variance, or an off-diagonal entry a of a FullCovariance.
struct NoiseParameter {
  std::string name;         ///< e.g. "Q.vz", "R.sonar"
  std::string unit;         ///< of the variance; empty if unknown
  bool logarithmic = true;  ///< true: θ is the logarithm of the value; false: the value itself
  double start = 1;         ///< initial value of a search: a variance (> 0), or the entry itself
  bool fixed = false;       ///< the search keeps the parameter at its start
  /// Prior of the variance; empty: all values are equally likely.
  std::optional<NoisePrior> prior = {};
  /// Set by tuning: the interval in which the variance lies with 95 % probability.
  std::optional<std::pair<double, double>> interval = {};

  /// Whether the names are equal.
  friend bool operator==(const NoiseParameter& a, const NoiseParameter& b) {
    return a.name == b.name;
  }
};

/// A sensor, all of whose outputs are measured in one sample: y = C x + D u + v, v with covariance
/// R.
struct FilterSensor {
  std::string name;             ///< e.g. "sonar"
  std::vector<Signal> outputs;  ///< ny
  Eigen::MatrixXd C;            ///< (ny × nx)
  Eigen::MatrixXd D;            ///< (ny × nu); empty means zero
  CovarianceModel R;            ///< (ny × ny), per sample
  double delay = 0;             ///< a sample logged at time t was taken at t - delay [s], ≥ 0
  /// Degrees of freedom of Student's t distribution with scale R, for errors with long tails; > 2.
  /// 0: the errors are normally distributed. Requires a diagonal R.
  double student = 0;
  /// Largest e²/S with which a measurement is accepted, tested for each scalar; ≥ 4.
  double gate = std::numeric_limits<double>::infinity();
};

/// x' = A x + B u + G w, w white with density Q [unit²/s]; or, if dt > 0,
/// x[k+1] = A x[k] + B u[k] + G w[k], w with covariance Q per step of dt seconds. Inputs are
/// constant from one sample to the next.
struct FilterModel {
  std::string name;                   ///< e.g. "altitude"
  std::string description;            ///< one line; may be empty
  double dt = 0;                      ///< [s]; 0: continuous
  std::vector<Signal> states;         ///< nx ≥ 1
  std::vector<Signal> inputs;         ///< nu
  std::vector<Signal> noises;         ///< nw, names of w
  Eigen::MatrixXd A;                  ///< (nx × nx)
  Eigen::MatrixXd B;                  ///< (nx × nu)
  Eigen::MatrixXd G;                  ///< (nx × nw)
  CovarianceModel Q;                  ///< (nw × nw)
  std::vector<FilterSensor> sensors;  ///< at least one

  Eigen::VectorXd x0;  ///< (nx) estimate of the initial state
  /// (nx × nx) covariance of the error of x0; 0 in rows and columns of diffuse states
  Eigen::MatrixXd P0;
  std::vector<bool> diffuse;  ///< (nx) true: the initial state is completely unknown

  /// Set for a model of inertial navigation: gravity in world axes [m/s²]. A, B and G then do not
  /// refer to any particular attitude, and nonlinear_filter() linearizes the records.
  std::optional<Eigen::Vector3d> gravity = {};
  /// Set for a model of a rigid body: name or file of the vehicle. A, B and G are linearized
  /// likewise.
  std::string vehicle = {};

  std::vector<NoiseParameter> parameters;  ///< p, in the order of θ

  /// Result of the tuning that computed the starts: "pass", "fail" or "too short to tell"; empty if
  /// the model is not tuned.
  std::string verdict;

  /// False for models that nonlinear_filter() linearizes.
  [[nodiscard]] bool linear() const { return !gravity && vehicle.empty(); }
  [[nodiscard]] Eigen::Index outputs() const;  ///< sum of ny over all sensors
};

/// θ with every parameter at its start.
[[nodiscard]] Eigen::VectorXd start_of(const FilterModel& model);

/// Index of the parameter with that name.
/// @throws InvalidInput  "where: no parameter 'Q.vy', expected one of …"
[[nodiscard]] int parameter_index(const FilterModel& model, const std::string& name,
                                  const std::string& where);

/// Checks names, shapes and ranges, that every parameter is used, and that every covariance is
/// symmetric and positive semidefinite at the starts.
/// @throws InvalidInput  naming the matrix or the parameter, its value and the expected one
void validate(const FilterModel& model, const std::string& where);

}  // namespace quadtune
