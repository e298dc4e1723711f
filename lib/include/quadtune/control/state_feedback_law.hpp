// SPDX-License-Identifier: Apache-2.0
/// State feedback with guarded integrals as it runs on board: u = u0 + K (sp - x) + K_int x_int,
/// and the terms of CommandMemory if the law has one.
#pragma once

#include <Eigen/Core>
#include <array>
#include <limits>

#include "quadtune/control/allocation.hpp"
#include "quadtune/control/guarded_integral.hpp"
#include "quadtune/estimation/on_board.hpp"
#include "quadtune/gains.hpp"
#include "quadtune/model/vehicle.hpp"

namespace quadtune {

/// Maximum number of integrals of a law: one for each of the 12 states.
inline constexpr int kMaxIntegrals = 12;

/// Limits of the integral of one state, in the convention of the gains.
struct IntegralGuard {
  std::string state;           ///< e.g. "theta"
  double error_limit = 0;      ///< as in GuardedIntegralSettings
  double increment_limit = 0;  ///< as in GuardedIntegralSettings
  double integral_limit = 0;   ///< as in GuardedIntegralSettings
};

/// The limits of the last public version of the uquad flight code.
[[nodiscard]] const std::vector<IntegralGuard>& uquad_integral_guards();

/// Settings of the law. K applies to the states and inputs of ned_convention(), whatever the
/// convention of the original gains.
template <class T>
struct StateFeedbackSettings {
  InputKind input_kind = InputKind::rotor_speed;  ///< quantities that the law commands
  int inputs = 0;                                 ///< number of inputs
  /// The first `inputs` rows are used.
  Eigen::Matrix<T, kMaxRotors, 12> K = Eigen::Matrix<T, kMaxRotors, 12>::Zero();
  int integrals = 0;  ///< number of integrated states
  /// The first `inputs` rows and `integrals` columns are used.
  Eigen::Matrix<T, kMaxRotors, kMaxIntegrals> K_int =
      Eigen::Matrix<T, kMaxRotors, kMaxIntegrals>::Zero();
  std::array<int, kMaxIntegrals> integrated{};                     ///< indices into the 12 states
  std::array<GuardedIntegralSettings<T>, kMaxIntegrals> guards{};  ///< one for each integral
  StateVector<T> x0 = StateVector<T>::Zero();  ///< set point at which u0 is the trim input
  /// Trim of the inputs, the first `inputs` are used.
  Eigen::Matrix<T, kMaxRotors, 1> u0 = Eigen::Matrix<T, kMaxRotors, 1>::Zero();
  PositionAxes axes = PositionAxes::world;  ///< axes of the horizontal position errors
  /// The horizontal position error that the law uses is limited to this length [m], > 0.
  T position_error_limit = T(std::numeric_limits<double>::infinity());
  /// Whether integrals stop growing in a direction in which the motors are saturated.
  bool conditional_integration = false;
  /// Whether the law has CommandMemory, here in the inputs of ned_convention().
  bool remembers = false;
  Eigen::Matrix<T, kMaxRotors, 1> lag_share =
      Eigen::Matrix<T, kMaxRotors, 1>::Zero();  ///< 1 - e^(-dt/lag)
  /// Gain on the modelled actuator states, see CommandMemory.
  Eigen::Matrix<T, kMaxRotors, kMaxRotors> K_lag = Eigen::Matrix<T, kMaxRotors, kMaxRotors>::Zero();
  int past = 0;                                              ///< 0 to kMaxPastCommands
  Eigen::Matrix<T, kMaxRotors, Eigen::Dynamic> K_past = {};  ///< (kMaxRotors × past · inputs)
};

/// The state kept from one sample to the next.
template <class T>
struct StateFeedbackState {
  /// One for each integrated state.
  std::array<GuardedIntegralState<T>, kMaxIntegrals> integrals{};
  /// Requested minus produced input of the last sample with conditional_integration; otherwise 0.
  Eigen::Matrix<T, kMaxRotors, 1> excess = Eigen::Matrix<T, kMaxRotors, 1>::Zero();
  /// For a law with command memory: the actuators' state and the past commands, minus u0.
  Eigen::Matrix<T, kMaxRotors, 1> actuators = Eigen::Matrix<T, kMaxRotors, 1>::Zero();
  Eigen::Matrix<T, Eigen::Dynamic, 1> commands = {};  ///< newest first; empty: none yet
};

/// The transformation of gains from a convention to the states x_ned and inputs u_ned of
/// ned_convention(); x and u are those of the gains.
struct FeedbackTransformation {
  Eigen::MatrixXd inputs;     ///< (nu × nu) u_ned = inputs · u: a signed permutation
  Eigen::MatrixXd states;     ///< (nx × 12) x = states · x_ned
  Eigen::VectorXd integrals;  ///< (ni) sign of each integral
  double law = 1;             ///< 1, or -1 if the gains multiply x - sp

  /// Sets K and K_int of a law from gains of this convention.
  void set_gain(const Eigen::MatrixXd& K, const Eigen::MatrixXd& K_int,
                StateFeedbackSettings<double>& settings) const;
  /// Sets x0 and u0.
  void set_trim(const Eigen::VectorXd& x0, const Eigen::VectorXd& u0,
                StateFeedbackSettings<double>& settings) const;
};

/// The transformation of these gains.
/// @throws InvalidInput  as validate(Gains) and convention(); if a state is not one of the 12 of
///                       the convention, if K does not have one row for each input of the vehicle,
///                       or if there are more than kMaxIntegrals integrals or kMaxRotors rotors
[[nodiscard]] FeedbackTransformation feedback_words(const Vehicle& vehicle, const Gains& gains);

/// Converts gains of any convention, sign law and input kind to a law of a vehicle.
/// @param vehicle  whose rotors the law commands
/// @param gains   of any convention and sign law
/// @param dt      sample period [s]: that of the gains, or any for continuous gains
/// @param guards  by state name of the convention; an integrated state without guard is not limited
/// @throws InvalidInput  as feedback_words(); if the gains have a sample period other than dt; or
///                       if dt or a guard is out of range
[[nodiscard]] StateFeedbackSettings<double> state_feedback_settings(
    const Vehicle& vehicle, const Gains& gains, double dt,
    const std::vector<IntegralGuard>& guards);

/// The set point of the 12 states for a reference. States that the reference does not define are
/// those of x0, and Reference::velocity is added to the velocities. If the reference does not track
/// position, the horizontal position and the body velocities u and v are those of the estimate, so
/// that their errors are 0.
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
    // The reference is an attitude: horizontal position is not controlled, the height is held.
    sp.template segment<2>(kPosition) = estimate.x.template segment<2>(kPosition);
    sp.template segment<2>(kVelocity) = estimate.x.template segment<2>(kVelocity);
    sp(2) = reference.position(2);
    sp(3) = reference.roll;
    sp(4) = reference.pitch;
  }
  return sp;
}

/// Rotates (north, east) from the heading of the trim to that of the vehicle, for
/// PositionAxes::heading.
template <class T>
[[nodiscard]] Eigen::Matrix<T, 2, 1> in_position_axes(const StateFeedbackSettings<T>& settings,
                                                      const Estimate<T>& estimate, const T& north,
                                                      const T& east) {
  using std::cos, std::sin;
  if (settings.axes == PositionAxes::world) return {north, east};
  const T turned = estimate.x(5) - settings.x0(5);
  const T c = cos(turned), s = sin(turned);
  return {c * north + s * east, c * east - s * north};
}

/// One sample; returns u in the law's own input kind: one entry per rotor, or [T τx τy τz].
///
/// Afterwards, call on_realized() with the input that the motors produce.
template <class T>
[[nodiscard]] Eigen::Matrix<T, kMaxRotors, 1> step(const StateFeedbackSettings<T>& settings,
                                                   StateFeedbackState<T>& state,
                                                   const Estimate<T>& estimate,
                                                   const Reference<T>& reference) {
  using std::sqrt;
  StateVector<T> error = set_point(settings, estimate, reference) - estimate.x;
  const StateVector<T> integrated = error;
  const T distance = sqrt(error(0) * error(0) + error(1) * error(1));
  const MaskOf<T> far = distance > settings.position_error_limit;
  for (int i = 0; i < 2; ++i)
    error(i) = select(far, error(i) * (settings.position_error_limit / distance), error(i));
  error.template head<2>() = in_position_axes(settings, estimate, error(0), error(1));
  Eigen::Matrix<T, kMaxRotors, 1> u = settings.u0;
  for (int j = 0; j < 12; ++j)
    for (int i = 0; i < settings.inputs; ++i) u(i) += settings.K(i, j) * error(j);
  // Integrals are kept in world axes, in which a steady wind is constant.
  std::array<T, kMaxIntegrals> integrals{};
  std::array<int, 2> of_position = {-1, -1};
  for (int j = 0; j < settings.integrals; ++j) {
    const int of = settings.integrated[static_cast<std::size_t>(j)];
    if (of < 2) of_position[static_cast<std::size_t>(of)] = j;
  }
  for (int j = 0; j < settings.integrals; ++j) {
    const auto k = static_cast<std::size_t>(j);
    const int of = settings.integrated[k];
    const GuardedIntegralState<T> before = state.integrals[k];
    T pushes = T(0);  // > 0 if the integral acts in a direction in which the motors are saturated
    if (settings.conditional_integration) {
      // A north error has a component along and one across the heading, so both columns contribute.
      Eigen::Matrix<T, 2, 1> turned = Eigen::Matrix<T, 2, 1>::Zero();
      if (of < 2)
        turned = in_position_axes<T>(settings, estimate, of == 0 ? integrated(0) : T(0),
                                     of == 1 ? integrated(1) : T(0));
      for (int i = 0; i < settings.inputs; ++i) {
        T answer = T(0);
        if (of >= 2) answer = settings.K_int(i, j) * integrated(of);
        for (std::size_t axis = 0; of < 2 && axis < 2; ++axis)
          if (of_position[axis] >= 0)
            answer +=
                settings.K_int(i, of_position[axis]) * turned(static_cast<Eigen::Index>(axis));
        pushes += max_of(T(state.excess(i) * answer), T(0));
      }
    }
    integrals[k] = step(settings.guards[k], state.integrals[k], T(integrated(of)));
    if (settings.conditional_integration) {
      const MaskOf<T> winds_up = pushes > T(0);
      integrals[k] = select(winds_up, before.integral, integrals[k]);
      state.integrals[k].integral = integrals[k];
    }
  }
  if (settings.axes == PositionAxes::heading && (of_position[0] >= 0 || of_position[1] >= 0)) {
    const auto sum = [&](int j) { return j < 0 ? T(0) : integrals[static_cast<std::size_t>(j)]; };
    const Eigen::Matrix<T, 2, 1> turned =
        in_position_axes(settings, estimate, sum(of_position[0]), sum(of_position[1]));
    for (std::size_t axis = 0; axis < 2; ++axis)
      if (of_position[axis] >= 0)
        integrals[static_cast<std::size_t>(of_position[axis])] =
            turned(static_cast<Eigen::Index>(axis));
  }
  for (int j = 0; j < settings.integrals; ++j)
    for (int i = 0; i < settings.inputs; ++i)
      u(i) += settings.K_int(i, j) * integrals[static_cast<std::size_t>(j)];
  if (!settings.remembers) return u;
  for (int j = 0; j < settings.inputs; ++j)
    for (int i = 0; i < settings.inputs; ++i) u(i) -= settings.K_lag(i, j) * state.actuators(j);
  for (Eigen::Index j = 0; j < state.commands.size(); ++j)
    for (int i = 0; i < settings.inputs; ++i) u(i) -= settings.K_past(i, j) * state.commands(j);
  return u;
}

/// Gives the law the input that the motors produce in this control period.
/// @param settings  accepted by step()
/// @param state     of the law; its integrals and memory are corrected
/// @param asked     the result of step(), or `made` if step() was not called
/// @param made      the input that the motors produce, of the same kind
template <class T>
void on_realized(const StateFeedbackSettings<T>& settings, StateFeedbackState<T>& state,
                 const Eigen::Matrix<T, kMaxRotors, 1>& asked,
                 const Eigen::Matrix<T, kMaxRotors, 1>& made) {
  const int n = settings.inputs;
  if (settings.conditional_integration)
    for (int i = 0; i < n; ++i)
      state.excess(i) = select(is_finite(asked(i)), asked(i) - made(i), T(0));
  if (!settings.remembers) return;
  if (state.commands.size() == 0 && settings.past > 0)
    state.commands.setZero(static_cast<Eigen::Index>(settings.past) * n);
  const Eigen::Index kept = state.commands.size();
  for (int i = 0; i < n; ++i) {
    const T now = made(i) - settings.u0(i);
    const T arrives = kept > 0 ? state.commands(kept - n + i) : now;
    state.actuators(i) += settings.lag_share(i) * (arrives - state.actuators(i));
  }
  for (Eigen::Index j = kept - 1; j >= n; --j) state.commands(j) = state.commands(j - n);
  for (int i = 0; i < n && kept > 0; ++i) state.commands(i) = made(i) - settings.u0(i);
}

}  // namespace quadtune
