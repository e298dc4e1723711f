// SPDX-License-Identifier: Apache-2.0
/// Kalman filter with constant (steady-state) gains for flight code. Theory: "Kalman filter".
#pragma once

#include <Eigen/Core>

#include "quadtune/filter.hpp"
#include "quadtune/scalar.hpp"

namespace quadtune {

/// Filter state between periods. A copy resumes identically.
template <class T>
struct SteadyFilterState {
  Eigen::Matrix<T, Eigen::Dynamic, 1> x;  ///< predicted for the next measurement
  /// innovation of the measurement since then; 0 if there was none
  Eigen::Matrix<T, Eigen::Dynamic, 1> e;
};

/// The state before the first measurement, with the predicted state x (nx).
template <class T>
[[nodiscard]] SteadyFilterState<T> steady_filter_start(
    const KalmanFilter& filter, const Eigen::Matrix<T, Eigen::Dynamic, 1>& x) {
  return {x, Eigen::Matrix<T, Eigen::Dynamic, 1>::Constant(filter.model.C.rows(), T(0))};
}

/// Estimate that includes the present measurement y (ny): e = y - C x, x + M e. Entries of y that
/// are not finite are not used.
///
/// @return   (nx)
template <class T>
[[nodiscard]] Eigen::Matrix<T, Eigen::Dynamic, 1> correct(
    const KalmanFilter& filter, SteadyFilterState<T>& state,
    const Eigen::Matrix<T, Eigen::Dynamic, 1>& y) {
  for (Eigen::Index i = 0; i < y.size(); ++i) {
    T e = y(i);
    for (Eigen::Index j = 0; j < state.x.size(); ++j) e -= T(filter.model.C(i, j)) * state.x(j);
    state.e(i) = select(is_finite(e), e, T(0));
  }
  Eigen::Matrix<T, Eigen::Dynamic, 1> estimate = state.x;
  for (Eigen::Index i = 0; i < estimate.size(); ++i)
    for (Eigen::Index j = 0; j < y.size(); ++j) estimate(i) += T(filter.M(i, j)) * state.e(j);
  return estimate;
}

/// Predicts the next period from the input u (nu): x ← A x + B u + L e. This advances the estimate
/// x + M e and includes the correlation between process and measurement noise. Entries of u that
/// are not finite count as 0. If correct() was not called since the previous call, because nothing
/// was measured, e is 0.
template <class T>
void predict(const KalmanFilter& filter, SteadyFilterState<T>& state,
             const Eigen::Matrix<T, Eigen::Dynamic, 1>& u) {
  const Eigen::Matrix<T, Eigen::Dynamic, 1> x = state.x;
  for (Eigen::Index i = 0; i < x.size(); ++i) {
    T next = T(0);
    for (Eigen::Index j = 0; j < x.size(); ++j) next += T(filter.model.A(i, j)) * x(j);
    for (Eigen::Index j = 0; j < u.size(); ++j)
      next += T(filter.model.B(i, j)) * select(is_finite(u(j)), u(j), T(0));
    for (Eigen::Index j = 0; j < state.e.size(); ++j) next += T(filter.L(i, j)) * state.e(j);
    state.x(i) = next;
  }
  state.e.setConstant(T(0));
}

}  // namespace quadtune
