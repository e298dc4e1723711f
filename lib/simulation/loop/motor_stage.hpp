// SPDX-License-Identifier: Apache-2.0
/// Converts the speeds that the law requests to those that the motors are commanded: quantization
/// and limits of the driver, the start-up ramp and the battery voltage.
#pragma once

#include "quadtune/estimation/on_board.hpp"
#include "quadtune/model/battery.hpp"
#include "quadtune/model/mixer.hpp"
#include "quadtune/model/vehicle.hpp"
#include "quadtune/simulation/pack_math.hpp"

namespace quadtune::internal {

/// Motor stages of N vehicles with the same kind of command.
template <int N>
class MotorStage {
 public:
  using P = Pack<N>;

  MotorStage() = default;
  explicit MotorStage(const std::array<const Vehicle*, N>& vehicles)
      : squared_(vehicles[0]->motor.law == CommandLaw::speed_squared) {
    for (int l = 0; l < N; ++l) {
      const Vehicle& vehicle = *vehicles[static_cast<std::size_t>(l)];
      set_lane(gain_, l, vehicle.motor.gain);
      set_lane(min_, l, vehicle.motor.min);
      set_lane(max_, l, vehicle.motor.max);
      set_lane(quantum_, l, vehicle.motor.quantum);
      set_lane(max_speed_, l, max_speed(vehicle));
      quantized_ = quantized_ || vehicle.motor.quantum > 0;
    }
  }

  /// Quantizes and limits requested speeds.
  /// @param saturated  output: whether any motor was at a limit
  void limit(RotorSpeeds<P>& speeds, Mask<N>& saturated) const {
    saturated = false;
    for (Eigen::Index i = 0; i < speeds.size(); ++i) {
      P command = squared_ ? P(speeds(i) * speeds(i) / gain_) : P(speeds(i) / gain_);
      if (quantized_)
        command = select(quantum_ > P(0), nearest(command / quantum_) * quantum_, command);
      saturated = logical_or(saturated, logical_or(command<min_, command> max_));
      speeds(i) = speed(clamped(command, min_, max_));
    }
  }

  /// Speeds during start-up: a ramp to the minimum command that alternates between values above and
  /// below it, as the uquad's driver does to start its motors.
  /// @param share  fraction of the ramp, 0 … 1
  void start_up(double share, std::uint64_t index, RotorSpeeds<P>& speeds) const {
    const double jump = index % 2 == 0 ? 0.9 : 1.1;
    speeds.setConstant(speed(min_of(min_ * P(share * jump), min_)));
  }

  /// Speeds from fractions of the command range: 0 is the minimum, 1 the maximum; negative:
  /// stopped.
  void shares(const Eigen::Matrix<double, kMaxRotors, 1>& of_range, RotorSpeeds<P>& speeds) const {
    for (Eigen::Index i = 0; i < speeds.size(); ++i)
      speeds(i) = of_range(i) < 0 ? P(0) : speed(min_ + (max_ - min_) * P(of_range(i)));
  }

  /// Speeds from commands of a law; negative commands count as 0.
  void speeds_of_commands(const Eigen::Matrix<P, kMaxRotors, 1>& commands,
                          RotorSpeeds<P>& speeds) const {
    for (Eigen::Index i = 0; i < speeds.size(); ++i) speeds(i) = speed(max_of(commands(i), P(0)));
  }

  /// Inverse of speeds_of_commands().
  void commands_of_speeds(const RotorSpeeds<P>& speeds,
                          Eigen::Matrix<P, kMaxRotors, 1>& commands) const {
    for (Eigen::Index i = 0; i < speeds.size(); ++i)
      commands(i) = squared_ ? P(speeds(i) * speeds(i) / gain_) : P(speeds(i) / gain_);
  }

  /// Limits the speeds to what the battery voltage allows.
  void supply(const Battery& battery, const BatteryState<P>& state, RotorSpeeds<P>& speeds,
              Mask<N>& saturated) const {
    const P ratio = voltage_ratio(battery, state);
    for (Eigen::Index i = 0; i < speeds.size(); ++i) {
      if (battery.regulated) {
        const P max = ratio * max_speed_;
        saturated = logical_or(saturated, speeds(i) > max);
        speeds(i) = min_of(speeds(i), max);
      } else {
        speeds(i) = speeds(i) * ratio;
      }
    }
  }

 private:
  [[nodiscard]] P speed(const P& command) const {
    return squared_ ? sqrt(gain_ * command) : P(gain_ * command);
  }

  bool squared_ = false, quantized_ = false;
  P gain_, min_, max_, quantum_, max_speed_;
};

}  // namespace quadtune::internal
