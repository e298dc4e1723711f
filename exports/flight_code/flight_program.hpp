// SPDX-License-Identifier: Apache-2.0
/// A flight program computed by the library's templates: its C code must give the same results, bit
/// by bit, in `float` (BoardFloat) and in `double` (Pack<1>).
#pragma once

#include <type_traits>

#include "flight_code/program_settings.hpp"
#include "quadtune/estimation/general_filter.hpp"
#include "quadtune/estimation/mambo_estimator.hpp"
#include "quadtune/estimation/on_board.hpp"
#include "quadtune/estimation/uquad_filter.hpp"

namespace quadtune::exports {

/// Converts settings to another precision.
template <class T>
[[nodiscard]] CascadedPidSettings<T> program_cast(const CascadedPidSettings<double>& from) {
  CascadedPidSettings<T> to;
  for (std::size_t i = 0; i < kCascadeAxes; ++i) {
    const PidSettings<double>& s = from.loops[i];
    PidSettings<T>& t = to.loops[i];
    t.dt = T(s.dt);
    t.Kp = T(s.Kp);
    t.Ki = T(s.Ki);
    t.Kd = T(s.Kd);
    t.Tf = T(s.Tf);
    t.rate_lead = T(s.rate_lead);
    t.rate_share = T(s.rate_share);
    t.b = T(s.b);
    t.c = T(s.c);
    t.method = s.method;
    t.derivative = s.derivative;
    t.output_min = T(s.output_min);
    t.output_max = T(s.output_max);
    t.integral_min = T(s.integral_min);
    t.integral_max = T(s.integral_max);
    t.back_calculation = T(s.back_calculation);
  }
  to.attitude_limit = T(from.attitude_limit);
  to.weight = T(from.weight);
  to.take_off_thrust = T(from.take_off_thrust);
  to.max_thrust = T(from.max_thrust);
  to.velocity_feed_forward = from.velocity_feed_forward;
  to.conditional_integration = from.conditional_integration;
  return to;
}

template <class T>
[[nodiscard]] StateFeedbackSettings<T> program_cast(const StateFeedbackSettings<double>& from) {
  StateFeedbackSettings<T> to;
  to.input_kind = from.input_kind;
  to.inputs = from.inputs;
  to.integrals = from.integrals;
  to.integrated = from.integrated;
  convert_field(to.K, from.K);
  convert_field(to.K_int, from.K_int);
  for (std::size_t j = 0; j < from.guards.size(); ++j)
    to.guards[j] = {T(from.guards[j].dt), T(from.guards[j].error_limit),
                    T(from.guards[j].increment_limit), T(from.guards[j].integral_limit)};
  convert_field(to.x0, from.x0);
  convert_field(to.u0, from.u0);
  to.axes = from.axes;
  to.position_error_limit = T(from.position_error_limit);
  to.conditional_integration = from.conditional_integration;
  to.remembers = from.remembers;
  convert_field(to.lag_share, from.lag_share);
  convert_field(to.K_lag, from.K_lag);
  to.past = from.past;
  to.K_past.resize(from.K_past.rows(), from.K_past.cols());
  convert_field(to.K_past, from.K_past);
  return to;
}

template <class T>
[[nodiscard]] Allocation<T> program_cast(const Allocation<double>& from) {
  Allocation<T> to;
  to.rotors = from.rotors;
  convert_field(to.P, from.P);
  convert_field(to.M, from.M);
  convert_field(to.wrench0, from.wrench0);
  to.thrust0.resize(from.thrust0.size());
  convert_field(to.thrust0, from.thrust0);
  for (std::size_t i = 0; i < from.a2.size(); ++i) {
    to.a2[i] = T(from.a2[i]);
    to.a1[i] = T(from.a1[i]);
  }
  return to;
}

template <class T>
[[nodiscard]] ThrustLimits<T> program_cast(const ThrustLimits<double>& from) {
  ThrustLimits<T> to;
  for (std::size_t i = 0; i < from.min.size(); ++i) {
    to.min[i] = T(from.min[i]);
    to.max[i] = T(from.max[i]);
  }
  to.floor = T(from.floor);
  return to;
}

template <class T>
[[nodiscard]] SensorFrame<T> program_cast(const SensorFrame<double>& from) {
  SensorFrame<T> to;
  const auto cast = [](auto& sample, const auto& with) {
    convert_field(sample.value, with.value);
    sample.fresh = MaskOf<T>(with.fresh);
    sample.age = T(with.age);
  };
  cast(to.specific_force, from.specific_force);
  cast(to.rates, from.rates);
  cast(to.magnetic_field, from.magnetic_field);
  cast(to.pressure, from.pressure);
  cast(to.sonar, from.sonar);
  cast(to.flow, from.flow);
  cast(to.gps_position, from.gps_position);
  cast(to.gps_velocity, from.gps_velocity);
  cast(to.vision, from.vision);
  return to;
}

template <class T>
[[nodiscard]] Reference<T> program_cast(const Reference<double>& from) {
  Reference<T> to;
  convert_field(to.position, from.position);
  convert_field(to.velocity, from.velocity);
  to.yaw = T(from.yaw);
  to.roll = T(from.roll);
  to.pitch = T(from.pitch);
  to.track_position = from.track_position;
  to.phase = from.phase;
  return to;
}

/// Values that are known when a program starts.
struct ProgramStart {
  StateVector<double> x = StateVector<double>::Zero();
  Eigen::Vector3d gyro_bias = Eigen::Vector3d::Zero();   ///< [rad/s]
  Eigen::Vector3d force_bias = Eigen::Vector3d::Zero();  ///< [m/s²]
  double pressure_height = 0;                            ///< offset of the barometer's height [m]
};

/// The output of a program in one control period.
struct ProgramOutput {
  Eigen::VectorXd commands;  ///< (rotors) with the signs of the motors
  StateVector<double> estimate = StateVector<double>::Zero();
  bool limited = false;  ///< whether the motors cannot produce the requested wrench
  bool finite = true;    ///< whether the estimate is finite

  friend bool operator==(const ProgramOutput& a, const ProgramOutput& b) {
    return a.commands == b.commands && a.estimate == b.estimate && a.limited == b.limited &&
           a.finite == b.finite;
  }
};

/// The program qt, as implemented in source/program.c.
template <class T>
class FlightProgram {
 public:
  FlightProgram(const ProgramSettings& settings, const ProgramStart& start)
      : settings_(settings),
        allocation_(program_cast<T>(settings.allocation)),
        limits_(program_cast<T>(settings.limits)) {
    if (settings.cascade())
      cascade_settings_ = program_cast<T>(std::get<0>(settings.law));
    else
      feedback_settings_ = program_cast<T>(settings.feedback());
    StateVector<T> x;
    convert_field(x, start.x);
    Vector3<T> rates, force;
    convert_field(rates, start.gyro_bias);
    convert_field(force, start.force_bias);
    if (settings.mambo) {
      mambo_settings_ = mambo_estimator_cast<T>(*settings.mambo);
      mambo_ = mambo_estimator_start(mambo_settings_, x);
      mambo_.attitude.gyro_bias = rates;
      mambo_.force_bias = force;
    }
    if (settings.uquad) {
      uquad_settings_ = uquad_filter_cast<T>(settings.uquad->filter);
      uquad_ = uquad_filter_start(uquad_settings_, x);
      uquad_.gyro_offset = rates;
      uquad_.kalman.x.template tail<3>() = force;
      speeds_ = settings.uquad->hover.cast<T>();
    }
    if (!settings.general) return;
    filter_ = general_filter_start(*settings.general, x);
    set_biases(filter_, rates, force);
    filter_.pressure_height = T(start.pressure_height);
  }

  /// One period of the estimator.
  [[nodiscard]] Estimate<T> estimate(const SensorFrame<double>& frame, bool on_ground) {
    if (settings_.mambo) return step(mambo_settings_, mambo_, program_cast<T>(frame));
    if (settings_.uquad)
      return step(uquad_settings_, uquad_, program_cast<T>(frame), settings_.uquad->body, speeds_,
                  MaskOf<T>(on_ground));
    return step<T>(*settings_.general, filter_, program_cast<T>(frame), MaskOf<T>(on_ground));
  }

  /// Law, allocation and motor commands of one period.
  [[nodiscard]] ProgramOutput control(const Estimate<T>& estimate,
                                      const Reference<double>& reference) {
    ProgramOutput output = output_of(estimate);
    speeds_.setConstant(allocation_.rotors, T(0));
    if (!output.finite) return output;
    const Reference<T> to = program_cast<T>(reference);
    if (settings_.cascade()) {
      const Eigen::Matrix<T, 4, 1> asked = step(cascade_settings_, cascade_, estimate, to);
      const LimitedWrench<T> made = prioritized(allocation_, limits_, asked);
      output.limited = any(made.limited);
      speeds_ = speeds_of_wrench(allocation_, made.wrench);
      drive(speeds_, output.commands);
      on_realized(cascade_settings_, cascade_, asked, made.wrench);
      return output;
    }
    const Inputs asked = step(feedback_settings_, feedback_, estimate, to);
    output.limited = make_speeds(asked, speeds_);
    drive(speeds_, output.commands);
    on_realized(feedback_settings_, feedback_, asked,
                output.limited ? inputs_of_speeds(speeds_) : asked);
    return output;
  }

  /// One period in which the motors get these commands instead of those of the law.
  [[nodiscard]] ProgramOutput idle(const Estimate<T>& estimate, const Eigen::VectorXd& commands) {
    ProgramOutput output = output_of(estimate);
    speeds_.setConstant(allocation_.rotors, T(0));
    if (!output.finite) return output;
    convert_field(output.commands, commands);
    for (Eigen::Index i = 0; i < speeds_.size(); ++i)
      speeds_(i) = speed_of(max_of(direction(i) * T(commands(i)), T(0)));
    if (settings_.cascade() || !feedback_settings_.remembers) return output;
    const Inputs told = inputs_of_speeds(speeds_);
    on_realized(feedback_settings_, feedback_, told, told);
    return output;
  }

 private:
  using Inputs = Eigen::Matrix<T, kMaxRotors, 1>;

  [[nodiscard]] ProgramOutput output_of(const Estimate<T>& estimate) const {
    ProgramOutput output;
    output.commands.setZero(allocation_.rotors);
    for (int i = 0; i < 12; ++i) output.estimate(i) = lane(estimate.x(i), 0);
    output.finite = all(estimate.finite) && output.estimate.allFinite();
    return output;
  }
  [[nodiscard]] T direction(Eigen::Index i) const {
    return T(settings_.direction[static_cast<std::size_t>(i)]);
  }
  [[nodiscard]] bool squared() const { return settings_.motor.law == CommandLaw::speed_squared; }
  [[nodiscard]] T speed_of(const T& command) const {
    using std::sqrt;
    const T gain = T(settings_.motor.gain);
    return squared() ? T(sqrt(gain * command)) : T(gain * command);
  }
  [[nodiscard]] T command_of(const T& speed) const {
    const T gain = T(settings_.motor.gain);
    return squared() ? T(speed * speed / gain) : T(speed / gain);
  }

  /// Computes the commands for the speeds, within the motors' limits; the speeds become those of
  /// the commands.
  void drive(RotorSpeeds<T>& speeds, Eigen::VectorXd& commands) const {
    const MotorCommand& motor = settings_.motor;
    for (Eigen::Index i = 0; i < speeds.size(); ++i) {
      T command = command_of(speeds(i));
      if (motor.quantum > 0) command = nearest(T(command / T(motor.quantum))) * T(motor.quantum);
      command = clamped(command, T(motor.min), T(motor.max));
      speeds(i) = speed_of(command);
      commands(i) = lane(T(direction(i) * command), 0);
    }
  }

  [[nodiscard]] RotorSpeeds<T> thrusts_of(const RotorSpeeds<T>& speeds) const {
    RotorSpeeds<T> thrusts(speeds.size());
    for (Eigen::Index i = 0; i < speeds.size(); ++i) {
      const auto k = static_cast<std::size_t>(i);
      thrusts(i) = (allocation_.a2[k] * speeds(i) + allocation_.a1[k]) * speeds(i);
    }
    return thrusts;
  }

  [[nodiscard]] Inputs inputs_of_speeds(const RotorSpeeds<T>& speeds) const {
    Inputs inputs = Inputs::Constant(T(0));
    const Eigen::Index rotors = speeds.size();
    switch (feedback_settings_.input_kind) {
      case InputKind::wrench:
        inputs.template head<4>() = wrench_of_thrusts(allocation_, thrusts_of(speeds));
        break;
      case InputKind::rotor_speed:
        inputs.head(rotors) = speeds;
        break;
      case InputKind::rotor_thrust:
        inputs.head(rotors) = thrusts_of(speeds);
        break;
      case InputKind::command:
        for (Eigen::Index i = 0; i < rotors; ++i) inputs(i) = command_of(speeds(i));
        break;
    }
    return inputs;
  }

  /// Computes the feasible speeds nearest to those of a state feedback; returns whether they
  /// differ.
  [[nodiscard]] bool make_speeds(const Inputs& asked, RotorSpeeds<T>& speeds) const {
    if (feedback_settings_.input_kind == InputKind::wrench) {
      const LimitedWrench<T> made =
          prioritized(allocation_, limits_, Eigen::Matrix<T, 4, 1>(asked.template head<4>()));
      speeds = speeds_of_wrench(allocation_, made.wrench);
      return any(made.limited);
    }
    speeds.resize(allocation_.rotors);
    bool limited = false;
    for (Eigen::Index i = 0; i < speeds.size(); ++i) {
      const auto k = static_cast<std::size_t>(i);
      if (feedback_settings_.input_kind == InputKind::rotor_speed)
        speeds(i) = max_of(asked(i), T(0));
      else if (feedback_settings_.input_kind == InputKind::rotor_thrust)
        speeds(i) = speed_for_thrust(asked(i), allocation_.a2[k], allocation_.a1[k]);
      else
        speeds(i) = speed_of(max_of(asked(i), T(0)));
    }
    const RotorSpeeds<T> thrusts = thrusts_of(speeds);
    for (Eigen::Index i = 0; i < speeds.size(); ++i) {
      const auto k = static_cast<std::size_t>(i);
      limited = limited || any(thrusts(i) < limits_.min[k]) || any(thrusts(i) > limits_.max[k]);
    }
    const LimitedWrench<T> made =
        prioritized(allocation_, limits_, wrench_of_thrusts(allocation_, thrusts));
    limited = limited || any(made.limited);
    if (limited) speeds = speeds_of_wrench(allocation_, made.wrench);
    return limited;
  }

  ProgramSettings settings_;
  Allocation<T> allocation_;
  ThrustLimits<T> limits_;
  GeneralFilterState<T> filter_;
  MamboEstimatorSettings<T> mambo_settings_;
  MamboEstimatorState<T> mambo_;
  UquadFilterSettings<T> uquad_settings_;
  UquadFilterState<T> uquad_;
  RotorSpeeds<T> speeds_;  ///< of the last commands [rad/s]
  CascadedPidSettings<T> cascade_settings_;
  CascadedPidState<T> cascade_;
  StateFeedbackSettings<T> feedback_settings_;
  StateFeedbackState<T> feedback_;
};

}  // namespace quadtune::exports
