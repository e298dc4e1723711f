// SPDX-License-Identifier: Apache-2.0
/// From what the law asks of the motors to the speeds that they are told: the driver's steps and
/// limits, the start-up ramp and the battery's voltage.
#pragma once

#include "quadtune/estimation/on_board.hpp"
#include "quadtune/model/battery.hpp"
#include "quadtune/model/mixer.hpp"
#include "quadtune/model/vehicle.hpp"
#include "quadtune/simulation/pack_math.hpp"

namespace quadtune::internal {

/// Of the vehicles of N flights with one kind of command.
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
      set_lane(greatest_speed_, l, greatest_speed(vehicle));
      quantized_ = quantized_ || vehicle.motor.quantum > 0;
    }
  }

  /// Told speeds of asked ones.
  /// @param saturated  whether some motor met a limit; set
  void limit(RotorSpeeds<P>& speeds, Mask<N>& saturated) const {
    saturated = false;
    for (Eigen::Index i = 0; i < speeds.size(); ++i) {
      P command = squared_ ? P(speeds(i) * speeds(i) / gain_) : P(speeds(i) / gain_);
      if (quantized_)
        command = select(quantum_ > P(0), nearest(command / quantum_) * quantum_, command);
      saturated = either(saturated, either(command<min_, command> max_));
      speeds(i) = speed(clamped(command, min_, max_));
    }
  }

  /// Told speeds while the motors run up: a ramp to the least command, with values that jump above
  /// and below it, which is how the uquad's driver gets its motors to turn.
  /// @param share  of the ramp, 0 … 1
  void start_up(double share, std::uint64_t index, RotorSpeeds<P>& speeds) const {
    const double jump = index % 2 == 0 ? 0.9 : 1.1;
    speeds.setConstant(speed(lesser(min_ * P(share * jump), min_)));
  }

  /// Told speeds of shares of the range: 0 the least command, 1 the greatest; negative: none.
  void shares(const Eigen::Matrix<double, kMaxRotors, 1>& of_range, RotorSpeeds<P>& speeds) const {
    for (Eigen::Index i = 0; i < speeds.size(); ++i)
      speeds(i) = of_range(i) < 0 ? P(0) : speed(min_ + (max_ - min_) * P(of_range(i)));
  }

  /// Speeds of commands as a law gives them; below 0 is 0.
  void speeds_of_commands(const Eigen::Matrix<P, kMaxRotors, 1>& commands,
                          RotorSpeeds<P>& speeds) const {
    for (Eigen::Index i = 0; i < speeds.size(); ++i) speeds(i) = speed(greater(commands(i), P(0)));
  }

  /// The inverse: commands that give these speeds.
  void commands_of_speeds(const RotorSpeeds<P>& speeds,
                          Eigen::Matrix<P, kMaxRotors, 1>& commands) const {
    for (Eigen::Index i = 0; i < speeds.size(); ++i)
      commands(i) = squared_ ? P(speeds(i) * speeds(i) / gain_) : P(speeds(i) / gain_);
  }

  /// What a battery leaves of the speeds.
  void supply(const Battery& battery, const BatteryState<P>& state, RotorSpeeds<P>& speeds,
              Mask<N>& saturated) const {
    const P ratio = voltage_ratio(battery, state);
    for (Eigen::Index i = 0; i < speeds.size(); ++i) {
      if (battery.regulated) {
        const P most = ratio * greatest_speed_;
        saturated = either(saturated, speeds(i) > most);
        speeds(i) = lesser(speeds(i), most);
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
  P gain_, min_, max_, quantum_, greatest_speed_;
};

}  // namespace quadtune::internal
