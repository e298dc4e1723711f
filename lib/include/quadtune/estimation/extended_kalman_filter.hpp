// SPDX-License-Identifier: Apache-2.0
/// An extended Kalman filter for models of your own, with exact Jacobians. Theory: "Estimators on
/// board".
#pragma once

#include <Eigen/Core>
#include <functional>
#include <limits>

#include "quadtune/estimation/dual.hpp"

namespace quadtune {

/// Options of one update.
struct ExtendedUpdateOptions {
  /// Largest accepted eᵀ S⁻¹ e, > 0; for one measurement, 10.8 rejects a valid one in a thousand.
  double gate = std::numeric_limits<double>::infinity();
  /// Computes the innovation (ny) from y and h(x, u); y - h(x, u) if empty. An angle needs
  /// wrap_angle(). The Jacobian of the innovation must be that of -h.
  std::function<Eigen::VectorXd(const Eigen::VectorXd& y, const Eigen::VectorXd& expected)>
      innovation = {};
};

/// What an update computed, also if the gate rejected the measurement.
struct ExtendedUpdate {
  bool used = false;             ///< false: the gate rejected it; x and P are unchanged
  Eigen::VectorXd innovation;    ///< (ny) e
  Eigen::MatrixXd S;             ///< (ny × ny) covariance of e, H P Hᵀ + R
  Eigen::MatrixXd H;             ///< (ny × nx) ∂h/∂x at the prediction
  double innovation_square = 0;  ///< eᵀ S⁻¹ e, whose mean is ny if the filter is consistent
  double log_likelihood = 0;     ///< log of the density of e, -½ (eᵀ S⁻¹ e + log det 2π S)
};

/// x[k+1] = f(x[k], u[k], dt) + w, w with covariance Q;  y = h(x, u) + v, v with covariance R.
///
/// f and h are templates over the scalar T (double or Dual): they receive x as a ModelVector<T> and
/// return a vector of T; h may also return a single T. Elementary functions are called unqualified
/// after `using std::sin;`. u is passed on unchanged and may have any type; {} is an empty
/// VectorXd. After an exception, the filter is as before the call.
class ExtendedKalmanFilter {
 public:
  /// Corrects x after each prediction and each update, such as a quaternion to unit length. P is
  /// not changed, so the correction must be small, of the second order in the error of x.
  using Correction = std::function<void(Eigen::VectorXd& x)>;

  /// @param x0  (nx) initial state, nx ≥ 1
  /// @param P0  (nx × nx) covariance of its error, symmetric, ≥ 0
  /// @param correction  none: x is not corrected
  /// @throws InvalidInput  for wrong shapes, entries that are not finite, and an indefinite P0
  ExtendedKalmanFilter(Eigen::VectorXd x0, Eigen::MatrixXd P0, Correction correction = {});

  [[nodiscard]] const Eigen::VectorXd& x() const { return x_; }  ///< (nx) estimate
  [[nodiscard]] const Eigen::MatrixXd& P() const { return P_; }  ///< (nx × nx) its covariance

  /// x ← f(x, u, dt),  P ← F P Fᵀ + Q,  F = ∂f/∂x.
  /// @param f   the model, a template as above
  /// @param u   the input of f
  /// @param dt  [s], > 0
  /// @param Q   (nx × nx) per step, symmetric, ≥ 0
  /// @throws InvalidInput  for wrong shapes, an indefinite Q, and values or derivatives of f that
  ///                       are not finite
  template <class Transition, class Input = Eigen::VectorXd>
  void predict(const Transition& f, const Input& u, double dt, const Eigen::MatrixXd& Q) {
    require_prediction(dt, Q);
    finish_prediction(linearized([&](const ModelVector<Dual>& x) { return f(x, u, dt); }, x_), Q);
  }

  /// Updates by y in Joseph's form; see ExtendedUpdate.
  /// @param h  the measurement model, a template as above
  /// @param u  the input of h
  /// @param y  (ny) the measurement
  /// @param R  (ny × ny) symmetric, > 0
  /// @param options  the gate and the innovation
  /// @throws InvalidInput  for wrong shapes, entries that are not finite, an R that is not positive
  ///                       definite, and values or derivatives of h that are not finite
  template <class Measurement, class Input = Eigen::VectorXd>
  ExtendedUpdate update(const Measurement& h, const Input& u, const Eigen::VectorXd& y,
                        const Eigen::MatrixXd& R, const ExtendedUpdateOptions& options = {}) {
    require_update(y, R, options);
    return finish_update(linearized([&](const ModelVector<Dual>& x) { return h(x, u); }, x_), y, R,
                         options);
  }

 private:
  void require_prediction(double dt, const Eigen::MatrixXd& Q) const;
  void finish_prediction(const Linearized& f, const Eigen::MatrixXd& Q);
  static void require_update(const Eigen::VectorXd& y, const Eigen::MatrixXd& R,
                             const ExtendedUpdateOptions& options);
  ExtendedUpdate finish_update(const Linearized& h, const Eigen::VectorXd& y,
                               const Eigen::MatrixXd& R, const ExtendedUpdateOptions& options);
  void take(Eigen::VectorXd x, Eigen::MatrixXd P);

  Eigen::VectorXd x_;
  Eigen::MatrixXd P_;
  Correction correction_;
};

}  // namespace quadtune
