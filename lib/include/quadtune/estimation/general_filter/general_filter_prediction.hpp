// SPDX-License-Identifier: Apache-2.0
/// Prediction of the general filter: the motion driven by the inertial sensors, forward and
/// backward in time, and the covariance of its errors. Theory: "The general filter".
#pragma once

#include "quadtune/estimation/general_filter/general_filter_state.hpp"

namespace quadtune::general_filter_internal {

/// Position of the horizon between the stored readings of one inertial sensor. The reading at the
/// time of the horizon is (1 - part) · readings[whole] + part · readings[whole + 1].
struct ReadingPlace {
  int whole = 0;
  double part = 0;
};
[[nodiscard]] inline ReadingPlace reading_place(double lag, double dt, int horizon) {
  const double place = std::max(0.0, static_cast<double>(horizon) - lag / dt);
  const double whole = std::floor(place + 1e-9);
  return {static_cast<int>(whole), std::max(0.0, place - whole) < 1e-9 ? 0 : place - whole};
}

/// Inputs of the motion over one control period, biases subtracted.
template <class T>
struct Inputs {
  Vector3<T> rates;  ///< mean [rad/s]
  Vector3<T> force;  ///< mean [m/s²]
};

/// Mean inputs over the period that ended `age` periods before the horizon: three consecutive
/// readings with the weights (1 - part)/2, 1/2, part/2, the trapezoidal rule of a linear
/// interpolation.
template <class T>
[[nodiscard]] inline Inputs<T> inputs_at(const GeneralFilterState<T>& state,
                                         const ReadingPlace& gyro, const ReadingPlace& force,
                                         int age) {
  const auto mean = [&](const ReadingPlace& at, auto member) {
    const int first = at.whole + age;
    Vector3<T> sum = state.readings[first].*member * T(0.5 * (1 - at.part)) +
                     state.readings[first + 1].*member * T(0.5);
    if (at.part > 0) sum += state.readings[first + 2].*member * T(0.5 * at.part);
    return sum;
  };
  return {mean(gyro, &InertialReading<T>::rates) - state.gyro_bias,
          mean(force, &InertialReading<T>::force) - state.force_bias};
}

/// Gyroscope reading `age` periods before the horizon, interpolated, bias subtracted.
template <class T>
[[nodiscard]] inline Vector3<T> rates_at(const GeneralFilterState<T>& state,
                                         const ReadingPlace& gyro, int age) {
  const int first = gyro.whole + age;
  Vector3<T> rates = state.readings[first].rates * T(1 - gyro.part) - state.gyro_bias;
  if (gyro.part > 0) rates += state.readings[first + 1].rates * T(gyro.part);
  return rates;
}

/// Quaternion of a small rotation vector, accurate to its fourth power.
template <class T>
[[nodiscard]] inline Eigen::Matrix<T, 4, 1> small_rotation(const Vector3<T>& turn) {
  const T square = turn.squaredNorm();
  const T s = T(0.5) - square * T(1.0 / 48);
  return {T(1) - square * (T(0.125) - square * T(1.0 / 384)), s * turn(0), s * turn(1),
          s * turn(2)};
}

/// Quaternion product a ⊗ b.
template <class T>
[[nodiscard]] inline Eigen::Matrix<T, 4, 1> product(const Eigen::Matrix<T, 4, 1>& a,
                                                    const Eigen::Matrix<T, 4, 1>& b) {
  return {a(0) * b(0) - a(1) * b(1) - a(2) * b(2) - a(3) * b(3),
          a(0) * b(1) + a(1) * b(0) + a(2) * b(3) - a(3) * b(2),
          a(0) * b(2) - a(1) * b(3) + a(2) * b(0) + a(3) * b(1),
          a(0) * b(3) + a(1) * b(2) - a(2) * b(1) + a(3) * b(0)};
}

template <class T>
[[nodiscard]] inline Matrix3<T> rotation(const Eigen::Matrix<T, 4, 1>& q) {
  return rotation_of_quaternion(q(0), q(1), q(2), q(3));
}

/// Advances the motion by a time h [s] under constant inputs. Gravity and force act in the middle
/// of the turn.
template <class T>
inline void move(Motion9<T>& motion, const Vector3<T>& turn, const Vector3<T>& force,
                 const T& gravity, const T& h) {
  const Eigen::Matrix<T, 4, 1> half = small_rotation<T>(turn * T(0.5));
  const Eigen::Matrix<T, 4, 1> middle = product(motion.attitude, half);
  Vector3<T> gained = rotation(middle) * force * h;
  gained.z() += gravity * h;
  motion.position += (motion.velocity + gained * T(0.5)) * h;
  motion.velocity += gained;
  motion.attitude = product(middle, half);
}

/// Normalizes q by one Newton step for 1/|q|.
template <class T>
inline void restore_norm(Eigen::Matrix<T, 4, 1>& q) {
  q *= T(1.5) - T(0.5) * q.squaredNorm();
}

/// P ← E P Eᵀ for an E that adds rows: target += Σ blocks[b] · sources[b]. The blocks are 3 × 3;
/// the template arguments are the first rows of target and sources, all different.
template <int target, int... sources, class T, class... Blocks>
[[gnu::always_inline]] inline void add_rows(SymmetricMatrix<T, kErrorStates>& P,
                                            const Blocks&... blocks) {
  // With t the target and s a source: P_ts ← P_ts + A P_ss …, P_tt ← P_tt + P_ts(before) Aᵀ +
  // A P_st(after).
  SymmetricMatrix<T, 3> own;
  unrolled<3>([&](int i) __attribute__((always_inline)) {
    unrolled<3>([&](int j) __attribute__((always_inline)) {
      if (j > i) return;
      T sum = P(target + i, target + j);
      unrolled<3>([&](int k) __attribute__((always_inline)) {
        ((sum += P(target + i, sources + k) * blocks(j, k)), ...);
      });
      own(i, j) = sum;
    });
  });
  unrolled<kErrorStates>([&](int j) __attribute__((always_inline)) {
    if (j >= target && j < target + 3) return;
    // Compute the sums before changing any entry: the sources' columns include those of the target.
    std::array<T, 3> sum = {P(target, j), P(target + 1, j), P(target + 2, j)};
    unrolled<3>([&](int i) __attribute__((always_inline)) {
      unrolled<3>([&](int k) __attribute__((always_inline)) {
        ((sum[static_cast<std::size_t>(i)] += blocks(i, k) * P(sources + k, j)), ...);
      });
    });
    unrolled<3>([&](int i) __attribute__((always_inline)) {
      P(target + i, j) = sum[static_cast<std::size_t>(i)];
    });
  });
  unrolled<3>([&](int i) __attribute__((always_inline)) {
    unrolled<3>([&](int j) __attribute__((always_inline)) {
      if (j > i) return;
      T sum = own(i, j);
      unrolled<3>([&](int k) __attribute__((always_inline)) {
        ((sum += blocks(i, k) * P(target + j, sources + k)), ...);
      });
      P(target + i, target + j) = sum;
    });
  });
}

/// Covariance of position += h · velocity.
template <class T>
[[gnu::always_inline]] inline void add_velocity(SymmetricMatrix<T, kErrorStates>& P, const T& h) {
  constexpr int p = kErrorPosition, v = kErrorVelocity;
  unrolled<3>([&](int i) __attribute__((always_inline)) {
    unrolled<3>([&](int j) __attribute__((always_inline)) {
      if (j > i) return;
      P(p + i, p + j) += h * (P(v + i, p + j) + P(v + j, p + i) + h * P(v + i, v + j));
    });
  });
  unrolled<kErrorStates - 3>([&](int j) __attribute__((always_inline)) {
    unrolled<3>([&](int i)
                    __attribute__((always_inline)) { P(p + i, v + j) += h * P(v + i, v + j); });
  });
}

/// Propagates the covariance over a time h: position gains h velocity, velocity gains
/// -[a]× h turn - R h force_bias, and turn gains -R h gyro_bias.
/// @param R_WB    in the middle of the period
/// @param gained  R_WB force h, without gravity [m/s]
template <class T>
[[gnu::noinline]] void spread(SymmetricMatrix<T, kErrorStates>& P, const Matrix3<T>& R_WB,
                              const Vector3<T>& gained, const T& h) {
  add_velocity(P, h);
  const Matrix3<T> minus_R = R_WB * (-h);
  Matrix3<T> minus_cross;
  minus_cross << T(0), gained.z(), -gained.y(),  //
      -gained.z(), T(0), gained.x(),             //
      gained.y(), -gained.x(), T(0);
  add_rows<kErrorVelocity, kErrorTurn, kErrorForceBias>(P, minus_cross, minus_R);
  add_rows<kErrorTurn, kErrorGyroBias>(P, minus_R);
}

/// P += R_WB diag(density²) R_WBᵀ h for the three errors that begin at `first`.
template <class T>
inline void add_body_noise(SymmetricMatrix<T, kErrorStates>& P, int first, const Matrix3<T>& R_WB,
                           const Eigen::Vector3d& density, double h) {
  for (int i = 0; i < 3; ++i)
    for (int j = 0; j <= i; ++j)
      for (int k = 0; k < 3; ++k)
        P(first + i, first + j) += R_WB(i, k) * R_WB(j, k) * T(density(k) * density(k) * h);
}

/// Adds the process noise of a time h in motion.
template <class T>
inline void add_noise(const GeneralFilterSettings& settings, SymmetricMatrix<T, kErrorStates>& P,
                      const Matrix3<T>& R_WB, double h) {
  add_body_noise(P, kErrorVelocity, R_WB, settings.accelerometer.density, h);
  add_body_noise(P, kErrorTurn, R_WB, settings.gyroscope.density, h);
}

/// Adds the random walks of the biases over a time h.
template <class T>
inline void add_walks(const GeneralFilterSettings& settings, SymmetricMatrix<T, kErrorStates>& P,
                      double h) {
  for (int i = 0; i < 3; ++i) {
    P(kErrorGyroBias + i, kErrorGyroBias + i) +=
        T(settings.gyroscope.walk * settings.gyroscope.walk * h);
    P(kErrorForceBias + i, kErrorForceBias + i) +=
        T(settings.accelerometer.walk * settings.accelerometer.walk * h);
  }
  if (settings.pressure)
    P(kErrorPressureHeight, kErrorPressureHeight) +=
        T(settings.pressure->walk * settings.pressure->walk * h);
}

}  // namespace quadtune::general_filter_internal
