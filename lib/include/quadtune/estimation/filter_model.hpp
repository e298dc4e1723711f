// SPDX-License-Identifier: Apache-2.0
/// A linear filter whose noise is not known yet: what moves, what is measured, and which numbers of
/// the covariances are to be found from logs.
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

/// What is known of a parameter before the log is read: its logarithm is normal.
struct NoisePrior {
  double median = 1;     ///< of the variance, > 0
  double deviation = 1;  ///< of its logarithm, > 0
};

/// One entry of θ. Of a variance it is the logarithm; of an off-diagonal entry of a
/// FullCovariance the entry.
struct NoiseParameter {
  std::string name;  ///< e.g. "Q.vz", "R.sonar"
  std::string unit;  ///< of the variance; empty when not known
  bool logarithmic = true;
  double start = 1;    ///< the variance (> 0), or the entry, that a search begins with
  bool fixed = false;  ///< it stays there
  std::optional<NoisePrior> prior = {};
  /// Of a tuned model: between which the variance lies with 95 % probability.
  std::optional<std::pair<double, double>> interval = {};

  friend bool operator==(const NoiseParameter& a, const NoiseParameter& b) {
    return a.name == b.name;
  }
};

/// What one sensor measures, all of it in one sample: y = C x + D u + v, v of covariance R.
struct FilterSensor {
  std::string name;             ///< e.g. "sonar"
  std::vector<Signal> outputs;  ///< ny
  Eigen::MatrixXd C;            ///< (ny × nx)
  Eigen::MatrixXd D;            ///< (ny × nu); empty means zero
  CovarianceModel R;            ///< (ny × ny), of a sample
  double delay = 0;             ///< a sample logged at t is of t - delay [s], ≥ 0
  /// Degrees of freedom of Student's distribution, of scale R, where errors have long tails; > 2.
  /// 0: they are normal. Needs a diagonal R.
  double student = 0;
  /// Largest e²/S, of scalars one by one, that a measurement is believed with; ≥ 4.
  double gate = std::numeric_limits<double>::infinity();
};

/// x' = A x + B u + G w, w white of density Q [unit²/s]; or, where dt > 0, x[k+1] = A x[k] + B u[k]
/// + G w[k], w of covariance Q each dt seconds. Inputs hold from one sample to the next.
struct FilterModel {
  std::string name;            ///< e.g. "altitude"
  std::string description;     ///< one line; may be empty
  double dt = 0;               ///< [s]; 0: continuous
  std::vector<Signal> states;  ///< nx ≥ 1
  std::vector<Signal> inputs;  ///< nu
  std::vector<Signal> noises;  ///< nw, names of w
  Eigen::MatrixXd A;           ///< (nx × nx)
  Eigen::MatrixXd B;           ///< (nx × nu)
  Eigen::MatrixXd G;           ///< (nx × nw)
  CovarianceModel Q;           ///< (nw × nw)
  std::vector<FilterSensor> sensors;

  Eigen::VectorXd x0;         ///< (nx) at the first sample
  Eigen::MatrixXd P0;         ///< (nx × nx) of its error, 0 in rows and columns of diffuse states
  std::vector<bool> diffuse;  ///< (nx) nothing is known of the state at the start

  /// Of a model of inertial navigation, in world axes [m/s²]: its A, B and G are those of no
  /// attitude in particular, and its records are linearized by a nonlinear_filter().
  std::optional<Eigen::Vector3d> gravity = {};
  /// Of a model of the rigid body, name or file of the vehicle: likewise.
  std::string vehicle = {};

  std::vector<NoiseParameter> parameters;

  /// Of the tuning that the starts come from: "pass", "fail" or "too short to tell"; empty for
  /// none.
  std::string verdict;

  [[nodiscard]] bool linear() const { return !gravity && vehicle.empty(); }
  [[nodiscard]] Eigen::Index outputs() const;  ///< ny of all sensors
};

/// θ at the parameters' starts.
[[nodiscard]] Eigen::VectorXd start_of(const FilterModel& model);

/// Index of the parameter of that name.
/// @throws InvalidInput  "where: no parameter 'Q.vy', expected one of …"
[[nodiscard]] int parameter_index(const FilterModel& model, const std::string& name,
                                  const std::string& where);

/// Checks names, shapes, ranges, and that every parameter is used and every covariance is one at
/// the start.
/// @throws InvalidInput  naming the matrix or the parameter, what came and what was expected.
void validate(const FilterModel& model, const std::string& where);

}  // namespace quadtune
