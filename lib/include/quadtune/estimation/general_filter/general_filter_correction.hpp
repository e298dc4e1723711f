// SPDX-License-Identifier: Apache-2.0
/// The general filter's correction by one scalar measurement, taken at the horizon or earlier.
/// Theory: "The general filter".
#pragma once

#include "quadtune/estimation/general_filter/general_filter_prediction.hpp"
#include "quadtune/estimation/kalman_filter.hpp"

namespace quadtune::general_filter_internal {

/// Groups of error states, as bits.
enum Group : unsigned {
  kP = 1,
  kV = 2,
  kTurn = 4,
  kGyro = 8,
  kForce = 16,
  kPressure = 32,
};
/// All groups on which a measurement before the horizon may depend.
inline constexpr unsigned kAll = 63;

/// Derivative of a scalar measurement with respect to the error states. Groups that are not used
/// are 0.
template <class T>
struct Row {
  Vector3<T> position = Vector3<T>::Zero();
  Vector3<T> velocity = Vector3<T>::Zero();
  Vector3<T> turn = Vector3<T>::Zero();
  Vector3<T> gyro = Vector3<T>::Zero();
  Vector3<T> force = Vector3<T>::Zero();
  T pressure = T(0);
};

/// The motion at an earlier time, and its errors as functions of the errors at the horizon:
/// turn_i = turn + G gyro, velocity_i = velocity + U × turn + A gyro + G force,
/// position_i = position - S velocity - W × turn + D gyro + E force.
template <class T>
struct Past {
  Motion9<T> motion;
  Vector3<T> rates;  ///< at that time, biases subtracted [rad/s]
  MaskOf<T> past{};  ///< whether that time is before the horizon
  T S = T(0);
  Vector3<T> U = Vector3<T>::Zero();
  Vector3<T> W = Vector3<T>::Zero();
  Matrix3<T> G = Matrix3<T>::Zero();
  Matrix3<T> A = Matrix3<T>::Zero();
  Matrix3<T> D = Matrix3<T>::Zero();
  Matrix3<T> E = Matrix3<T>::Zero();
};

/// Integrates the motion backward through the stored readings, with the present bias estimates.
/// @param ago  time before the horizon [s], ≥ 0; negative values count as 0
template <class T>
[[nodiscard, gnu::noinline]] Past<T> past_motion(const GeneralFilterSettings& settings,
                                                 const GeneralFilterState<T>& state,
                                                 const ReadingPlace& gyro,
                                                 const ReadingPlace& force, const T& ago) {
  Past<T> past;
  past.motion = state.motion;
  const T dt = T(settings.dt), gravity = T(settings.gravity);
  past.rates = rates_at(state, gyro, 0);
  past.past = ago > T(0);
  if (!any(past.past)) return past;
  T left = max_of(ago, T(0));
  for (int j = 0; j < kMaxHistoryPeriods && any(left > T(0)); ++j) {
    const bool last = j + 1 == kMaxHistoryPeriods;
    const T h = last ? left : min_of(left, dt);
    left = left - h;
    const Inputs<T> in = inputs_at(state, gyro, force, j);
    // Inverse of move(): first undo half of the turn, then the velocity change, then the other
    // half.
    const Eigen::Matrix<T, 4, 1> half = small_rotation<T>(in.rates * (T(-0.5) * h));
    const Eigen::Matrix<T, 4, 1> middle = product(past.motion.attitude, half);
    const Matrix3<T> R = rotation(middle);
    const Vector3<T> felt = R * in.force * h;
    Vector3<T> gained = felt;
    gained.z() += gravity * h;
    past.motion.attitude = product(middle, half);
    past.motion.velocity -= gained;
    past.motion.position -= (past.motion.velocity + gained * T(0.5)) * h;

    past.G += R * h;
    for (int c = 0; c < 3; ++c) past.A.col(c) += felt.cross(past.G.col(c));
    past.U += felt;
    past.S += h;
    past.W += past.U * h;
    past.D -= past.A * h;
    past.E -= past.G * h;
    const Vector3<T> begin = rates_at(state, gyro, j + 1);
    const T share = h / dt;
    const Vector3<T> end = rates_at(state, gyro, j);
    past.rates = select_entries<T>(h > T(0), Vector3<T>(end + (begin - end) * min_of(share, T(1))),
                                   past.rates);
  }
  return past;
}

/// Transforms the row of a measurement at the earlier time into a row for the errors at the
/// horizon.
template <class T>
void carry(const Past<T>& past, Row<T>& row) {
  const Vector3<T> p = row.position, v = row.velocity, turn = row.turn;
  row.velocity -= p * past.S;
  row.turn += v.cross(past.U) - p.cross(past.W);
  row.gyro += past.G.transpose() * turn + past.A.transpose() * v + past.D.transpose() * p;
  row.force += past.G.transpose() * v + past.E.transpose() * p;
}

/// Σ over the groups of row · P(·, i), for all i.
template <unsigned groups, class T>
[[gnu::always_inline]] inline std::array<T, kErrorStates> times_row(
    const SymmetricMatrix<T, kErrorStates>& P, const Row<T>& row) {
  std::array<T, kErrorStates> w;
  unrolled<kErrorStates>([&](int i) __attribute__((always_inline)) {
    T sum = T(0);
    const auto add = [&](int first, const Vector3<T>& c) __attribute__((always_inline)) {
      sum += P(first, i) * c(0) + P(first + 1, i) * c(1) + P(first + 2, i) * c(2);
    };
    if constexpr ((groups & kP) != 0) add(kErrorPosition, row.position);
    if constexpr ((groups & kV) != 0) add(kErrorVelocity, row.velocity);
    if constexpr ((groups & kTurn) != 0) add(kErrorTurn, row.turn);
    if constexpr ((groups & kGyro) != 0) add(kErrorGyroBias, row.gyro);
    if constexpr ((groups & kForce) != 0) add(kErrorForceBias, row.force);
    if constexpr ((groups & kPressure) != 0) sum += P(kErrorPressureHeight, i) * row.pressure;
    w[static_cast<std::size_t>(i)] = sum;
  });
  return w;
}

/// Σ over the groups of row · x.
template <unsigned groups, class T>
[[gnu::always_inline]] inline T dot_row(const std::array<T, kErrorStates>& x, const Row<T>& row) {
  T sum = T(0);
  const auto add = [&](std::size_t first, const Vector3<T>& c) __attribute__((always_inline)) {
    sum += x[first] * c(0) + x[first + 1] * c(1) + x[first + 2] * c(2);
  };
  if constexpr ((groups & kP) != 0) add(kErrorPosition, row.position);
  if constexpr ((groups & kV) != 0) add(kErrorVelocity, row.velocity);
  if constexpr ((groups & kTurn) != 0) add(kErrorTurn, row.turn);
  if constexpr ((groups & kGyro) != 0) add(kErrorGyroBias, row.gyro);
  if constexpr ((groups & kForce) != 0) add(kErrorForceBias, row.force);
  if constexpr ((groups & kPressure) != 0) sum += x[kErrorPressureHeight] * row.pressure;
  return sum;
}

/// Accumulates the corrections by the scalars of one sensor before they are applied.
template <class T>
struct Correction {
  std::array<T, kErrorStates> errors{};
  MaskOf<T> any_used{};
};

/// P ← (I - K c) P (I - K c)ᵀ + K R Kᵀ for the row c, w = P c, S = c w + R, expanded to P - K wᵀ -
/// w Kᵀ + S K Kᵀ. The result is symmetric by construction and, as in Joseph's form, an error of K
/// has only a second-order effect.
template <class T>
[[gnu::noinline]] void joseph(SymmetricMatrix<T, kErrorStates>& P,
                              const std::array<T, kErrorStates>& K,
                              const std::array<T, kErrorStates>& w, const T& S) {
  T* entry = P.entries.data();
  for (std::size_t i = 0; i < kErrorStates; ++i) {
    const T rest = w[i] - S * K[i];
    for (std::size_t j = 0; j <= i; ++j) *entry++ -= K[i] * w[j] + rest * K[j];
  }
}

/// Corrects by one scalar measurement.
///
/// The measurement is rejected if e²/S exceeds the gate, where e accounts for the corrections that
/// the previous scalars of the same sensor made. After recovery_time of rejections the variances of
/// the error group `doubted` are increased until e²/S = 1, since the state was less accurate than P
/// stated.
/// @tparam groups   error groups that the row uses
/// @param e        measurement minus prediction, both before any correction by this sensor
/// @param R        variance, > 0
/// @param doubted  first of the three error states whose variance is increased
template <unsigned groups, class T>
[[gnu::noinline]] void correct(const GeneralFilterSettings& settings, GeneralFilterState<T>& state,
                               const Row<T>& row, const T& innovation, const T& R,
                               const MaskOf<T>& fresh, std::size_t scalar, int doubted,
                               Correction<T>& correction, Estimate<T>& seen, MaskOf<T>& used) {
  if (!any(fresh)) return;
  Rejections<T>& rejections = state.rejections[scalar];
  const T e = innovation - dot_row<groups>(correction.errors, row);
  std::array<T, kErrorStates> w = times_row<groups>(state.P, row);
  T S = dot_row<groups>(w, row) + R;
  const T square = e * e;
  const MaskOf<T> sound = logical_and(logical_and(fresh, is_finite(square)), S > T(0));
  const MaskOf<T> near = square <= T(settings.gate) * S;
  const MaskOf<T> doubtful = logical_and(sound, logical_not(near));
  const MaskOf<T> again = logical_and(
      doubtful,
      logical_and(rejections.time >= T(settings.recovery_time), rejections.count >= T(3)));
  rejections.count += select(doubtful, T(1), T(0));
  const MaskOf<T> believed = logical_or(logical_and(sound, near), again);
  if (!any(believed)) return;
  rejections.count = select(believed, T(0), rejections.count);
  rejections.time = select(believed, T(0), rejections.time);
  if (any(again)) {
    const Vector3<T>& c = doubted == kErrorPosition   ? row.position
                          : doubted == kErrorVelocity ? row.velocity
                                                      : row.turn;
    const T size = c.squaredNorm();
    const T added = select(logical_and(again, size > T(0)), (square - S) / size, T(0));
    for (int i = 0; i < kErrorStates; ++i)
      if (i >= doubted && i < doubted + 3) state.P(i, i) += added;
    w = times_row<groups>(state.P, row);
    S = dot_row<groups>(w, row) + R;
  }
  seen.innovation_square += select(believed, square / S, T(0));
  seen.innovation_freedom += select(believed, T(1), T(0));
  used = logical_or(used, believed);
  correction.any_used = logical_or(correction.any_used, believed);

  const T inverse = T(1) / S;
  std::array<T, kErrorStates> K;
  for (std::size_t i = 0; i < kErrorStates; ++i) K[i] = w[i] * inverse;
  if (all(believed)) {
    joseph(state.P, K, w, S);
    for (std::size_t i = 0; i < kErrorStates; ++i) correction.errors[i] += K[i] * e;
    return;
  }
  SymmetricMatrix<T, kErrorStates> P = state.P;
  joseph(P, K, w, S);
  for (std::size_t i = 0; i < P.entries.size(); ++i)
    state.P.entries[i] = select(believed, P.entries[i], state.P.entries[i]);
  for (std::size_t i = 0; i < kErrorStates; ++i)
    correction.errors[i] =
        select(believed, T(correction.errors[i] + K[i] * e), correction.errors[i]);
}

/// Adapts the covariance to a changed velocity: velocity gains turn × change, P ← E P Eᵀ.
template <class T>
[[gnu::noinline]] void turn_with_velocity(SymmetricMatrix<T, kErrorStates>& P,
                                          const Vector3<T>& change) {
  Matrix3<T> cross;                        // cross · turn = turn × change
  cross << T(0), change.z(), -change.y(),  //
      -change.z(), T(0), change.x(),       //
      change.y(), -change.x(), T(0);
  add_rows<kErrorVelocity, kErrorTurn>(P, cross);
}

/// Adds the corrections to the state. Lanes without a correction keep their values bit for bit.
///
/// A turn about the vertical also rotates the velocity: without a heading sensor the error
/// direction (turn e_z, velocity e_z × v) is unobservable. The prediction and all rows preserve
/// this direction along one motion, but the correction changes v. If P were not adapted, the filter
/// would infer the yaw and the vertical gyroscope bias from noise.
template <class T>
void apply(const Correction<T>& correction, GeneralFilterState<T>& state) {
  if (!any(correction.any_used)) return;
  using std::sqrt;
  const auto& dx = correction.errors;
  const MaskOf<T>& used = correction.any_used;
  const auto add = [&](Vector3<T>& to, std::size_t first) {
    for (int i = 0; i < 3; ++i)
      to(i) = select(used, T(to(i) + dx[first + static_cast<std::size_t>(i)]), to(i));
  };
  add(state.motion.position, kErrorPosition);
  add(state.motion.velocity, kErrorVelocity);
  const Vector3<T> change(dx[kErrorVelocity], dx[kErrorVelocity + 1], dx[kErrorVelocity + 2]);
  if (all(used)) {
    turn_with_velocity(state.P, change);
  } else {
    SymmetricMatrix<T, kErrorStates> P = state.P;
    turn_with_velocity(P, change);
    for (std::size_t i = 0; i < P.entries.size(); ++i)
      state.P.entries[i] = select(used, P.entries[i], state.P.entries[i]);
  }
  add(state.gyro_bias, kErrorGyroBias);
  add(state.force_bias, kErrorForceBias);
  state.pressure_height =
      select(used, T(state.pressure_height + dx[kErrorPressureHeight]), state.pressure_height);
  // The rotation is applied about the world axes: q ← δq ⊗ q.
  const Eigen::Matrix<T, 4, 1> turn = {T(1), T(0.5) * dx[kErrorTurn], T(0.5) * dx[kErrorTurn + 1],
                                       T(0.5) * dx[kErrorTurn + 2]};
  Eigen::Matrix<T, 4, 1> q = product(turn, state.motion.attitude);
  q *= T(1) / T(sqrt(q.squaredNorm()));
  state.motion.attitude = select_entries<T>(used, q, state.motion.attitude);
}

}  // namespace quadtune::general_filter_internal
