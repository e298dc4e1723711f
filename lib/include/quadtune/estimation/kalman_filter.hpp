// SPDX-License-Identifier: Apache-2.0
/// Kalman filter for flight code: small, fixed size, without allocation, a template over the scalar
/// type. Theory: "Estimators on board".
#pragma once

#include <Eigen/Core>
#include <array>
#include <cstddef>
#include <limits>
#include <type_traits>

#include "quadtune/scalar.hpp"

namespace quadtune {

/// x[k+1] = F x[k] + G u[k] + w, w with covariance Q.
template <class T, int nx, int nu>
struct KalmanModel {
  Eigen::Matrix<T, nx, nx> F = Eigen::Matrix<T, nx, nx>::Identity();  ///< dynamics per step
  Eigen::Matrix<T, nx, nu> G = Eigen::Matrix<T, nx, nu>::Zero();      ///< input matrix per step
  Eigen::Matrix<T, nx, nx> Q = Eigen::Matrix<T, nx, nx>::Zero();  ///< symmetric, ≥ 0, per step
};

/// Filter state between steps. A copy resumes identically.
template <class T, int nx>
struct KalmanState {
  Eigen::Matrix<T, nx, 1> x = Eigen::Matrix<T, nx, 1>::Zero();  ///< estimate
  /// covariance of the error of x; symmetric
  Eigen::Matrix<T, nx, nx> P = Eigen::Matrix<T, nx, nx>::Zero();
};

/// Result of one measurement update.
template <class T>
struct KalmanUpdate {
  MaskOf<T> used{};            ///< false: state and covariance are unchanged
  T innovation_square = T(0);  ///< eᵀ S⁻¹ e, also of rejected measurements; 0 without a measurement
};

/// A row of C with few nonzero entries.
template <class T, int entries>
struct SparseRow {
  std::array<int, entries> column;  ///< column indices, all different
  std::array<T, entries> value;     ///< the entries in these columns
};

/// Gate that rejects no innovation.
template <class T>
[[nodiscard]] T no_gate() {
  return T(std::numeric_limits<double>::infinity());
}

/// a where the mask is true and b elsewhere, entry by entry.
template <class T, int rows, int cols>
[[nodiscard]] Eigen::Matrix<T, rows, cols> select_entries(const MaskOf<T>& mask,
                                                          const Eigen::Matrix<T, rows, cols>& a,
                                                          const Eigen::Matrix<T, rows, cols>& b) {
  Eigen::Matrix<T, rows, cols> result;
  for (int i = 0; i < rows * cols; ++i) result(i) = select(mask, a(i), b(i));
  return result;
}

/// Whether all entries are finite.
template <class T, int rows, int cols>
[[nodiscard]] MaskOf<T> entries_are_finite(const Eigen::Matrix<T, rows, cols>& a) {
  MaskOf<T> finite = is_finite(a(0));
  for (int i = 1; i < rows * cols; ++i) finite = logical_and(finite, is_finite(a(i)));
  return finite;
}

/// P ← (P + Pᵀ)/2. Rounding makes P asymmetric, and without this step the asymmetry would grow.
template <class T, int nx>
void symmetrize(Eigen::Matrix<T, nx, nx>& P) {
  for (int j = 0; j < nx; ++j)
    for (int i = 0; i < j; ++i) {
      const T mean = T(0.5) * (P(i, j) + P(j, i));
      P(i, j) = mean;
      P(j, i) = mean;
    }
}

/// x ← F x + G u,  P ← F P Fᵀ + Q.
template <class T, int nx, int nu>
void predict(const KalmanModel<T, nx, nu>& model, KalmanState<T, nx>& state,
             const std::type_identity_t<Eigen::Matrix<T, nu, 1>>& u) {
  const Eigen::Matrix<T, nx, 1> x = model.F.lazyProduct(state.x) + model.G.lazyProduct(u);
  const Eigen::Matrix<T, nx, nx> FP = model.F.lazyProduct(state.P);
  state.x = x;
  state.P = FP.lazyProduct(model.F.transpose()) + model.Q;
  symmetrize(state.P);
}

/// Updates by one scalar measurement y = C x + v, v with variance R.
///
/// Gain K = P Cᵀ (C P Cᵀ + R)⁻¹, covariance (I - K C) P (I - K C)ᵀ + K R Kᵀ (Joseph). State and
/// covariance remain unchanged, bit for bit, if the measurement is not fresh or not finite, if its
/// eᵀ S⁻¹ e exceeds the gate, or if S ≤ 0, which cannot occur with valid P and R.
/// @param state  receives the corrected state
/// @param C      row of the measurement
/// @param y      measured value
/// @param R      variance, ≥ 0
/// @param fresh  whether y was measured in this step
/// @param gate   largest accepted eᵀ S⁻¹ e; 10.8 rejects one valid measurement in a thousand
template <class T, int nx>
KalmanUpdate<T> update(KalmanState<T, nx>& state,
                       const std::type_identity_t<Eigen::Matrix<T, 1, nx>>& C,
                       const std::type_identity_t<T>& y, const std::type_identity_t<T>& R,
                       const MaskOf<T>& fresh, const std::type_identity_t<T>& gate = no_gate<T>()) {
  KalmanUpdate<T> result;
  if (!any(fresh)) return result;
  const Eigen::Matrix<T, nx, 1> PC = state.P.lazyProduct(C.transpose());
  T S = R;
  T e = y;
  for (int i = 0; i < nx; ++i) {
    S += C(i) * PC(i);
    e -= C(i) * state.x(i);
  }
  const MaskOf<T> measured = logical_and(logical_and(fresh, is_finite(e)), S > T(0));
  result.innovation_square = select(measured, e * e / S, T(0));
  result.used = logical_and(measured, result.innovation_square <= gate);
  if (!any(result.used)) return result;

  const Eigen::Matrix<T, nx, 1> K = PC / S;
  Eigen::Matrix<T, nx, nx> A = Eigen::Matrix<T, nx, nx>::Identity();  // I - K C
  A -= K.lazyProduct(C);
  const Eigen::Matrix<T, nx, nx> AP = A.lazyProduct(state.P);
  Eigen::Matrix<T, nx, nx> P = AP.lazyProduct(A.transpose());
  P += K.lazyProduct(K.transpose()) * R;
  symmetrize(P);
  const Eigen::Matrix<T, nx, 1> x = state.x + K * e;
  state.x = select_entries<T>(result.used, x, state.x);
  state.P = select_entries<T>(result.used, P, state.P);
  return result;
}

/// Updates by two simultaneous measurements, y = C x + v, v with covariance R (2 × 2, symmetric, ≥
/// 0). Otherwise as for a scalar; S must be positive definite.
template <class T, int nx>
KalmanUpdate<T> update(KalmanState<T, nx>& state,
                       const std::type_identity_t<Eigen::Matrix<T, 2, nx>>& C,
                       const std::type_identity_t<Eigen::Matrix<T, 2, 1>>& y,
                       const std::type_identity_t<Eigen::Matrix<T, 2, 2>>& R,
                       const MaskOf<T>& fresh, const std::type_identity_t<T>& gate = no_gate<T>()) {
  KalmanUpdate<T> result;
  if (!any(fresh)) return result;
  const Eigen::Matrix<T, nx, 2> PC = state.P.lazyProduct(C.transpose());
  const Eigen::Matrix<T, 2, 2> S = C.lazyProduct(PC) + R;
  const Eigen::Matrix<T, 2, 1> e = y - C.lazyProduct(state.x);
  const T determinant = S(0, 0) * S(1, 1) - S(0, 1) * S(1, 0);
  Eigen::Matrix<T, 2, 2> S_inv;
  S_inv << S(1, 1) / determinant, -S(0, 1) / determinant,  //
      -S(1, 0) / determinant, S(0, 0) / determinant;
  const MaskOf<T> measured =
      logical_and(logical_and(fresh, logical_and(is_finite(e(0)), is_finite(e(1)))),
                  logical_and(S(0, 0) > T(0), determinant > T(0)));
  const T square = e(0) * (S_inv(0, 0) * e(0) + S_inv(0, 1) * e(1)) +
                   e(1) * (S_inv(1, 0) * e(0) + S_inv(1, 1) * e(1));
  result.innovation_square = select(measured, square, T(0));
  result.used = logical_and(measured, result.innovation_square <= gate);
  if (!any(result.used)) return result;

  const Eigen::Matrix<T, nx, 2> K = PC.lazyProduct(S_inv);
  Eigen::Matrix<T, nx, nx> A = Eigen::Matrix<T, nx, nx>::Identity();  // I - K C
  A -= K.lazyProduct(C);
  const Eigen::Matrix<T, nx, nx> AP = A.lazyProduct(state.P);
  const Eigen::Matrix<T, nx, 2> KR = K.lazyProduct(R);
  Eigen::Matrix<T, nx, nx> P = AP.lazyProduct(A.transpose());
  P += KR.lazyProduct(K.transpose());
  symmetrize(P);
  const Eigen::Matrix<T, nx, 1> x = state.x + K.lazyProduct(e);
  state.x = select_entries<T>(result.used, x, state.x);
  state.P = select_entries<T>(result.used, P, state.P);
  return result;
}

/// Updates an extended filter by one scalar measurement, given its innovation e and a sparse C.
/// Joseph's form in two rank-one steps with 4 nx² operations (Bierman 1977, section V.5):
///
///     M = (I - K C) P = P - K (P Cᵀ)ᵀ,   P ← M (I - K C)ᵀ + K R Kᵀ = M + (R K - M Cᵀ) Kᵀ
///
/// P is not made symmetric here; the caller calls symmetrize() once per step.
template <class T, int nx, int entries>
KalmanUpdate<T> update(KalmanState<T, nx>& state, const SparseRow<T, entries>& C,
                       const std::type_identity_t<T>& e, const std::type_identity_t<T>& R,
                       const MaskOf<T>& fresh, const std::type_identity_t<T>& gate = no_gate<T>()) {
  using Column = Eigen::Matrix<T, nx, 1>;
  constexpr std::size_t n = entries;
  KalmanUpdate<T> result;
  if (!any(fresh)) return result;
  Column PC = state.P.col(C.column[0]) * C.value[0];
  for (std::size_t k = 1; k < n; ++k) PC += state.P.col(C.column[k]) * C.value[k];
  T S = R;
  for (std::size_t k = 0; k < n; ++k) S += C.value[k] * PC(C.column[k]);
  const MaskOf<T> measured = logical_and(logical_and(fresh, is_finite(e)), S > T(0));
  result.innovation_square = select(measured, e * e / S, T(0));
  result.used = logical_and(measured, result.innovation_square <= gate);
  if (!any(result.used)) return result;

  const Column K = PC / S;
  const auto correct = [&](Eigen::Matrix<T, nx, nx>& P) {
    for (int j = 0; j < nx; ++j) P.col(j) -= K * PC(j);
    Column MC = P.col(C.column[0]) * C.value[0];
    for (std::size_t k = 1; k < n; ++k) MC += P.col(C.column[k]) * C.value[k];
    const Column rest = K * R - MC;
    for (int j = 0; j < nx; ++j) P.col(j) += rest * K(j);
  };
  const Column x = state.x + K * e;
  if (all(result.used)) {
    state.x = x;
    correct(state.P);
  } else {
    Eigen::Matrix<T, nx, nx> P = state.P;
    correct(P);
    state.x = select_entries<T>(result.used, x, state.x);
    state.P = select_entries<T>(result.used, P, state.P);
  }
  return result;
}

}  // namespace quadtune
