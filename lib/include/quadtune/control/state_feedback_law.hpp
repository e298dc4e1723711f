// SPDX-License-Identifier: Apache-2.0
/// State feedback with guarded integrals as it runs on board: u = sp_u + K (sp - x) + K_int x_int.
#pragma once

#include <Eigen/Core>
#include <array>

#include "quadtune/control/allocation.hpp"
#include "quadtune/control/guarded_integral.hpp"
#include "quadtune/estimation/on_board.hpp"
#include "quadtune/gains.hpp"
#include "quadtune/model/vehicle.hpp"

namespace quadtune {

/// Most states that a law integrates: each of the 12 at most once.
inline constexpr int kMostIntegrals = 12;

/// Limits of the integral of one state, in the convention of the gains.
struct IntegralGuard {
  std::string state;       ///< e.g. "theta"
  double error_limit = 0;  ///< as GuardedIntegralSettings
  double increment_limit = 0;
  double integral_limit = 0;
};

/// Limits of the last public version of the uquad's flight program.
[[nodiscard]] const std::vector<IntegralGuard>& uquad_integral_guards();

/// Set once. K stands for quadtune's own states and inputs, whatever convention it came in.
template <class T>
struct StateFeedbackSettings {
  InputKind input_kind = InputKind::rotor_speed;
  int inputs = 0;
  Eigen::Matrix<T, kMaxRotors, 12> K = Eigen::Matrix<T, kMaxRotors, 12>::Zero();
  int integrals = 0;
  Eigen::Matrix<T, kMaxRotors, kMostIntegrals> K_int =
      Eigen::Matrix<T, kMaxRotors, kMostIntegrals>::Zero();
  std::array<int, kMostIntegrals> integrated{};  ///< which of the 12 states
  std::array<GuardedIntegralSettings<T>, kMostIntegrals> guards{};
  StateVector<T> x0 = StateVector<T>::Zero();  ///< set point at which u0 holds
  Eigen::Matrix<T, kMaxRotors, 1> u0 = Eigen::Matrix<T, kMaxRotors, 1>::Zero();
};

/// What is kept from one sample to the next.
template <class T>
struct StateFeedbackState {
  std::array<GuardedIntegralState<T>, kMostIntegrals> integrals{};
};

/// Gains of any convention, sign law and input kind as a law of a vehicle.
/// @param dt      sample period [s]; that of the gains, or any for continuous gains
/// @param guards  by name of the convention's state; an integrated state without one is not limited
/// @throws InvalidInput  for gains of another vehicle's inputs, or states that are not the 12
[[nodiscard]] StateFeedbackSettings<double> state_feedback_settings(
    const Vehicle& vehicle, const Gains& gains, double dt,
    const std::vector<IntegralGuard>& guards);

/// The set point of the 12 states for a reference; states that it does not speak of are those of
/// x0.
template <class T>
[[nodiscard]] StateVector<T> set_point(const StateFeedbackSettings<T>& settings,
                                       const Estimate<T>& estimate, const Reference<T>& reference) {
  StateVector<T> sp = settings.x0;
  const Matrix3<T> R_WB = rotation_of_euler(estimate.x(3), estimate.x(4), estimate.x(5));
  sp.template segment<3>(kVelocity) += R_WB.transpose() * reference.velocity;
  sp(5) = reference.yaw;
  if (reference.track_position) {
    sp.template segment<3>(kPosition) = reference.position;
  } else {
    // Attitude is what is asked for: position across has no say, and height stays.
    sp.template segment<2>(kPosition) = estimate.x.template segment<2>(kPosition);
    sp.template segment<2>(kVelocity) = estimate.x.template segment<2>(kVelocity);
    sp(2) = reference.position(2);
    sp(3) = reference.roll;
    sp(4) = reference.pitch;
  }
  return sp;
}

/// One sample; returns u in the law's own input kind, one a rotor or [T τx τy τz].
template <class T>
[[nodiscard]] Eigen::Matrix<T, kMaxRotors, 1> step(const StateFeedbackSettings<T>& settings,
                                                   StateFeedbackState<T>& state,
                                                   const Estimate<T>& estimate,
                                                   const Reference<T>& reference) {
  const StateVector<T> error = set_point(settings, estimate, reference) - estimate.x;
  Eigen::Matrix<T, kMaxRotors, 1> u = settings.u0;
  for (int j = 0; j < 12; ++j)
    for (int i = 0; i < settings.inputs; ++i) u(i) += settings.K(i, j) * error(j);
  for (int j = 0; j < settings.integrals; ++j) {
    const auto k = static_cast<std::size_t>(j);
    const T integral =
        step(settings.guards[k], state.integrals[k], T(error(settings.integrated[k])));
    for (int i = 0; i < settings.inputs; ++i) u(i) += settings.K_int(i, j) * integral;
  }
  return u;
}

}  // namespace quadtune
