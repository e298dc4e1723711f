// SPDX-License-Identifier: Apache-2.0
#include "quadtune/workbench/firmware/firmware_law.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <memory>
#include <numbers>
#include <optional>
#include <utility>

#include "firmware/turn_parts.hpp"
#include "quadtune/control/cascaded_pid.hpp"
#include "quadtune/exports/firmware.hpp"
#include "quadtune/exports/firmware_filters.hpp"

namespace quadtune {
namespace {

constexpr double kInfinite = std::numeric_limits<double>::infinity();
constexpr double kDegree = std::numbers::pi / 180;
constexpr double kGravity = 9.80665;  // [m/s²] assumed by the firmware

/// A low pass as implemented by firmware: first order y += dt/(dt + 1/(2πf)) (x - y), second order
/// the bilinear transform of a Butterworth filter, which ignores cut-offs above half of the sample
/// rate. It starts at its first input.
class DiscreteLowPass {
 public:
  DiscreteLowPass(const internal::LowPass& filter, double dt) : order_(filter.order) {
    if (order_ == 1) {
      const double rise = 1 / (2 * std::numbers::pi * filter.cutoff);
      share_ = dt / (dt + rise);
      return;
    }
    passes_ = filter.cutoff * dt >= 0.5;
    const double w = std::tan(std::numbers::pi * filter.cutoff * dt);
    const double c = 1 + std::numbers::sqrt2 * w + w * w;
    b_ = w * w / c;
    a1_ = 2 * (w * w - 1) / c;
    a2_ = (1 - std::numbers::sqrt2 * w + w * w) / c;
  }

  double operator()(double x) {
    if (passes_) return x;
    if (!started_) {
      started_ = true;
      y_ = x1_ = x2_ = y2_ = x;
      return x;
    }
    if (order_ == 1) return y_ += share_ * (x - y_);
    const double y = b_ * (x + 2 * x1_ + x2_) - a1_ * y_ - a2_ * y2_;
    x2_ = std::exchange(x1_, x);
    y2_ = std::exchange(y_, y);
    return y;
  }

 private:
  int order_;
  bool passes_ = false, started_ = false;
  double share_ = 0, b_ = 0, a1_ = 0, a2_ = 0;
  double x1_ = 0, x2_ = 0, y_ = 0, y2_ = 0;
};

class FilterChain {
 public:
  FilterChain(const internal::LowPasses& filters, double dt) {
    for (const internal::LowPass& filter : filters) chain_.emplace_back(filter, dt);
  }
  double operator()(double x) {
    for (DiscreteLowPass& filter : chain_) x = filter(x);
    return x;
  }

 private:
  std::vector<DiscreteLowPass> chain_;
};

/// Limits of one loop.
struct LoopLimits {
  double outer_integral = kInfinite;  ///< of its contribution to the target
  double target_min = -kInfinite, target_max = kInfinite;
  double integral = kInfinite;  ///< of its contribution to the output [output]
  double output = kInfinite;    ///< [output]
};

/// One loop: an outer controller of the value computes the target of an inner controller of its
/// rate.
class FirmwareAxis {
 public:
  FirmwareAxis() = default;
  FirmwareAxis(const FirmwareLoop& loop, const internal::LoopFilters& filters,
               const LoopLimits& limits, double outer_dt, double inner_dt)
      : loop_(loop), limits_(limits), filters_(filters), outer_dt_(outer_dt), inner_dt_(inner_dt) {
    reset();
  }

  /// Resets the state as when the firmware is switched to a mode that uses this loop.
  void reset() {
    outer_integral_ = integral_ = target_ = measured_ = differentiated_ = 0;
    started_ = false;
    rate_filter_ = {filters_.rate, inner_dt_};
    derivative_filter_ = {filters_.derivative, inner_dt_};
    error_filter_ = {filters_.error, inner_dt_};
    target_filter_ = {filters_.target, inner_dt_};
    output_filter_ = {filters_.output, inner_dt_};
  }

  /// The outer controller.
  /// @param forward  added to the target: the rate of the reference
  /// @param blocked  as in drive(): a pilot does not integrate errors that the vehicle cannot
  ///                 correct
  void aim(double error, double forward = 0, double blocked = 0) {
    target_ = std::clamp(
        loop_.outer * error + outer_integral_ - loop_.outer_derivative * measured_ + forward,
        limits_.target_min, limits_.target_max);
    if (!loop_.flies && error * blocked > 0) return;
    outer_integral_ = std::clamp(outer_integral_ + loop_.outer_integral * error * outer_dt_,
                                 -limits_.outer_integral, limits_.outer_integral);
  }
  [[nodiscard]] double target() const { return target_; }
  void set_target(double target) { target_ = target; }

  /// The inner controller, in SI units.
  /// @param blocked  sign in which the output cannot grow; the integral does not grow in this sign
  /// @param stands   whether the vehicle is on the ground, where the integral would only wind up
  [[nodiscard]] double drive(double rate, double blocked, bool stands = false) {
    measured_ = rate_filter_(rate);
    const double target = target_filter_(target_);
    const double error = error_filter_(target - measured_);
    const double of_D = loop_.of_error ? error : -measured_;
    if (!started_) differentiated_ = of_D;
    started_ = true;
    const double slope = derivative_filter_((of_D - differentiated_) / inner_dt_);
    differentiated_ = of_D;
    const double output =
        output_filter_(loop_.P * error + integral_ + loop_.D * slope + loop_.forward * target);
    const double growth = loop_.I * error * inner_dt_;
    if (!stands && !(growth * blocked > 0))
      integral_ = std::clamp(integral_ + growth, -limits_.integral, limits_.integral);
    return loop_.scale * std::clamp(output, -limits_.output, limits_.output);
  }

 private:
  FirmwareLoop loop_;
  LoopLimits limits_;
  internal::LoopFilters filters_;
  double outer_dt_ = 0, inner_dt_ = 0;
  double outer_integral_ = 0, integral_ = 0, target_ = 0;
  double measured_ = 0;        ///< the filtered rate
  double differentiated_ = 0;  ///< previous input of D
  bool started_ = false;
  FilterChain rate_filter_{{}, 1}, derivative_filter_{{}, 1}, error_filter_{{}, 1},
      target_filter_{{}, 1}, output_filter_{{}, 1};
};

/// Properties of a firmware besides its loops.
struct FirmwareHabits {
  double tilt = 0;           ///< maximum tilt set point [rad]
  double speed = kInfinite;  ///< maximum horizontal speed set point [m/s]
  /// Whether position and velocity are controlled along north and east, with tilt and speed limited
  /// as vectors; otherwise along and across the heading, each limited separately.
  bool in_world = false;
  bool velocity_forward = false;   ///< whether the velocity of the reference is added to the target
  bool tilt_compensation = false;  ///< whether the thrust is divided by the cosine of the tilt
  bool guards = true;              ///< whether integrals stop while the motors saturate
  double mass = 0;                 ///< [kg]
  double weight = 0;               ///< feed-forward thrust [N]
  double min_thrust = 0;           ///< [N]
  /// ArduPilot's loop of the vertical acceleration: thrust per error [N s²/m] and per integral of
  /// it, the limit of the integral's part [N], and the low pass of the error [Hz].
  struct Acceleration {
    double P = 0, I = 0, integral = 0, cutoff = 0;
  };
  std::optional<Acceleration> acceleration;
};

FirmwareHabits habits_of(const Firmware& firmware, const Vehicle& vehicle,
                         const ParameterValues& value, const FirmwareScale& scale) {
  FirmwareHabits habits;
  habits.mass = vehicle.mass;
  habits.weight = vehicle.mass * vehicle.gravity;
  switch (firmware.kind) {
    case FirmwareKind::px4:
      habits.tilt = value("MPC_TILTMAX_AIR") * kDegree;
      habits.speed = value("MPC_XY_VEL_MAX");
      habits.in_world = true;
      habits.velocity_forward = true;
      habits.tilt_compensation = true;
      break;
    case FirmwareKind::ardupilot: {
      const bool renamed = value.has("PSC_D_ACC_P");
      habits.tilt = (renamed ? value("ATC_ANGLE_MAX") : 0.01 * value("ANGLE_MAX")) * kDegree;
      habits.speed = 10;  // WPNAV_SPEED
      habits.in_world = true;
      habits.velocity_forward = true;
      habits.tilt_compensation = true;
      // Throttle per m/s²; up to 4.6 in thousandths per cm/s².
      const double unit = scale.thrust * (renamed ? 1 : 0.1);
      habits.acceleration = {unit * value(renamed ? "PSC_D_ACC_P" : "PSC_ACCZ_P"),
                             unit * value(renamed ? "PSC_D_ACC_I" : "PSC_ACCZ_I"),
                             0.8 * scale.thrust,  // PSC_ACCZ_IMAX
                             value(renamed ? "PSC_D_ACC_FLTE" : "PSC_ACCZ_FLTE")};
      break;
    }
    case FirmwareKind::betaflight:
      habits.tilt = 0.5;  // limit of the pilot
      habits.velocity_forward = true;
      break;
    case FirmwareKind::crazyflie:
      habits.tilt = std::min(value("posCtlPid.rLimit"), value("posCtlPid.pLimit")) * kDegree;
      habits.guards = false;
      habits.weight = scale.thrust * value("posCtlPid.thrustBase");
      habits.min_thrust = scale.thrust * value("posCtlPid.thrustMin");
      break;
  }
  return habits;
}

LoopLimits px4_limits(CascadeAxis axis, const ParameterValues& value) {
  LoopLimits limits;
  switch (axis) {
    case CascadeAxis::roll:
      limits.target_max = value("MC_ROLLRATE_MAX") * kDegree;
      limits.integral = value("MC_RR_INT_LIM");
      break;
    case CascadeAxis::pitch:
      limits.target_max = value("MC_PITCHRATE_MAX") * kDegree;
      limits.integral = value("MC_PR_INT_LIM");
      break;
    case CascadeAxis::yaw:
      limits.target_max = value("MC_YAWRATE_MAX") * kDegree;
      limits.integral = value("MC_YR_INT_LIM");
      break;
    case CascadeAxis::altitude:  // downward
      limits.target_max = value("MPC_Z_VEL_MAX_DN");
      limits.target_min = -value("MPC_Z_VEL_MAX_UP");
      limits.integral = kGravity;
      return limits;
    case CascadeAxis::x:
    case CascadeAxis::y:  // the speed is limited as a vector
      limits.integral = kGravity;
      return limits;
  }
  limits.target_min = -limits.target_max;
  return limits;
}

LoopLimits ardupilot_limits(CascadeAxis axis, const ParameterValues& value) {
  LoopLimits limits;
  const bool renamed = value.has("PSC_NE_VEL_IMAX");
  switch (axis) {
    case CascadeAxis::roll:
    case CascadeAxis::pitch:
    case CascadeAxis::yaw:
      limits.integral = value(axis == CascadeAxis::roll    ? "ATC_RAT_RLL_IMAX"
                              : axis == CascadeAxis::pitch ? "ATC_RAT_PIT_IMAX"
                                                           : "ATC_RAT_YAW_IMAX");
      limits.output = 1;
      break;
    case CascadeAxis::altitude:  // downward; WPNAV_SPEED_DN, WPNAV_SPEED_UP, PSC_VELZ_IMAX
      limits.target_max = 1.5;
      limits.target_min = -2.5;
      limits.integral = 10;
      break;
    case CascadeAxis::x:
    case CascadeAxis::y:  // the speed is limited as a vector
      limits.integral = renamed ? value("PSC_NE_VEL_IMAX") : 0.01 * value("PSC_VELXY_IMAX");
      break;
  }
  return limits;
}

LoopLimits betaflight_limits(CascadeAxis axis, const ParameterValues& value) {
  LoopLimits limits;
  if (!internal::turns(axis)) return limits;
  limits.integral = value("iterm_limit");
  limits.output = value(axis == CascadeAxis::yaw ? "pidsum_limit_yaw" : "pidsum_limit");
  return limits;
}

LoopLimits crazyflie_limits(const FirmwareLoop& loop, const ParameterValues& value) {
  // For velocities: 1.1 times the parameter.
  constexpr double kOverhead = 1.1;
  LoopLimits limits;
  const bool yaw = loop.axis == CascadeAxis::yaw;
  switch (loop.axis) {
    case CascadeAxis::roll:
    case CascadeAxis::pitch:
    case CascadeAxis::yaw:  // limits of the integrals of the errors: deg s and deg
      limits.outer_integral = loop.outer_integral * (yaw ? 360 : 20) * kDegree;
      limits.integral = loop.I * (yaw ? 166.7 : 33.3) * kDegree;
      limits.output = 32767;
      return limits;
    case CascadeAxis::altitude:
      limits.target_max = kOverhead * value("posCtlPid.zVelMax");
      limits.output = 32.767;  // in thousands of the thrust unit
      break;
    case CascadeAxis::x:
    case CascadeAxis::y:
      limits.target_max = kOverhead * value(loop.axis == CascadeAxis::x ? "posCtlPid.xVelMax"
                                                                        : "posCtlPid.yVelMax");
      break;
  }
  limits.target_min = -limits.target_max;
  return limits;
}

LoopLimits limits_of(const Firmware& firmware, const FirmwareLoop& loop,
                     const ParameterValues& value) {
  switch (firmware.kind) {
    case FirmwareKind::px4:
      return px4_limits(loop.axis, value);
    case FirmwareKind::ardupilot:
      return ardupilot_limits(loop.axis, value);
    case FirmwareKind::betaflight:
      return betaflight_limits(loop.axis, value);
    case FirmwareKind::crazyflie:
      return crazyflie_limits(loop, value);
  }
  return {};
}

/// A pilot's loop in the same form: |Kd| as P, Kp/|Kd| as the outer gain and Ki/|Kd| as its
/// integral.
FirmwareLoop pilots_loop(CascadeAxis axis, const CascadeGains& pilot) {
  FirmwareLoop result;
  result.axis = axis;
  result.flies = false;
  result.scale = 1;
  for (const PidLoop& loop : pilot.loops) {
    if (loop.name != to_string(axis) || loop.Kd == 0) continue;
    result.P = std::abs(loop.Kd);
    result.outer = std::abs(loop.Kp / loop.Kd);
    result.outer_integral = std::abs(loop.Ki / loop.Kd);
  }
  return result;
}

/// All constants of the law.
struct FirmwareSettings {
  double dt = 0;  ///< period of the rate loop [s]
  int attitude_every = 1, position_every = 1;
  FirmwareHabits habits;
  CascadedPidSettings<double> frame;  ///< for its thrusts
  std::array<FirmwareAxis, kCascadeAxes> axes;
};

FirmwareSettings settings_of(const Vehicle& vehicle, const StoredParameters& parameters,
                             const CascadeGains& pilot) {
  const Firmware& firmware = parameters.firmware;
  const ParameterValues value(firmware, parameters.values);
  const internal::LoopRates rates = internal::loop_rates(firmware, value);
  const auto every = [&](double rate) {
    return std::max(1, static_cast<int>(std::lround(rates.rate / rate)));
  };
  FirmwareSettings settings;
  settings.dt = 1 / rates.rate;
  settings.attitude_every = every(rates.attitude);
  settings.position_every = every(rates.position);
  settings.habits =
      habits_of(firmware, vehicle, value, firmware_scale(firmware, vehicle, parameters.values));
  CascadeGains none;
  none.dt = settings.dt;
  settings.frame =
      cascaded_pid_settings(vehicle, none, PidMethod::forward_euler, settings.habits.tilt, 0, 0);
  for (FirmwareLoop loop : firmware_loops(firmware, vehicle, parameters.values)) {
    const bool turns = internal::turns(loop.axis);
    if (!loop.flies) loop = pilots_loop(loop.axis, pilot);
    // The pilot holds the heading if the firmware does not.
    if (loop.axis == CascadeAxis::yaw && loop.outer == 0 && loop.outer_integral == 0)
      loop.outer = pilots_loop(loop.axis, pilot).outer;
    const double position_dt = settings.dt * settings.position_every;
    settings.axes[index_of(loop.axis)] = FirmwareAxis(
        loop, internal::loop_filters(firmware, loop.axis, value), limits_of(firmware, loop, value),
        turns ? settings.dt * settings.attitude_every : position_dt,
        turns ? settings.dt : position_dt);
  }
  return settings;
}

/// Wraps an angle to half a turn in either direction.
double wrap_angle(double angle) { return std::remainder(angle, 2 * std::numbers::pi); }

class FirmwareLaw final : public FlightLaw {
 public:
  explicit FirmwareLaw(FirmwareSettings settings) : s_(std::move(settings)) {}

  [[nodiscard]] Eigen::VectorXd command(const Estimate<double>& estimate,
                                        const Reference<double>& reference) override {
    const StateVector<double>& x = estimate.x;
    const bool takes_off = reference.phase == FlightPhase::take_off;
    if (count_ % s_.position_every == 0) steer(x, reference, takes_off);
    if (count_ % s_.attitude_every == 0) aim_turns(x, reference);
    ++count_;
    Eigen::Vector4d wrench;
    wrench(0) = takes_off ? s_.frame.take_off_thrust : thrust_;
    for (int i = 0; i < 3; ++i)
      wrench(1 + i) =
          axis(kTurns[static_cast<std::size_t>(i)]).drive(x(9 + i), excess_(1 + i), takes_off);
    const Eigen::Vector4d now = started_ ? late_ : wrench;
    started_ = true;
    late_ = wrench;
    return now;
  }

  void on_realized(const Eigen::VectorXd& asked, const Eigen::VectorXd& made) override {
    if (!s_.habits.guards) return;
    constexpr double kRounding = 1e-9;
    for (int i = 0; i < 4; ++i) {
      const double left = asked(i) - made(i);
      excess_(i) = std::abs(left) > kRounding * std::abs(asked(i)) ? left : 0;
    }
  }

 private:
  static constexpr std::array<CascadeAxis, 3> kTurns = {CascadeAxis::roll, CascadeAxis::pitch,
                                                        CascadeAxis::yaw};
  FirmwareAxis& axis(CascadeAxis which) { return s_.axes[index_of(which)]; }

  /// Position and velocity loops: compute the set points of tilt and thrust.
  void steer(const StateVector<double>& x, const Reference<double>& reference, bool takes_off) {
    if (takes_off) {
      for (const CascadeAxis which : {CascadeAxis::x, CascadeAxis::y, CascadeAxis::altitude})
        axis(which).reset();
      tilted_out_.setZero();
      lifted_out_ = 0;
      acceleration_ = {};
    }
    const Eigen::Vector3d velocity =
        rotation_of_euler(x(3), x(4), x(5)) * Eigen::Vector3d(x.segment<3>(kVelocity));
    roll_ = reference.roll;
    pitch_ = reference.pitch;
    if (reference.track_position && !takes_off) steer_level(x, velocity, reference);
    const double tilt = s_.habits.tilt;
    roll_ = std::clamp(roll_, -tilt, tilt);
    pitch_ = std::clamp(pitch_, -tilt, tilt);
    if (!takes_off) lift(x, velocity, reference);
  }

  /// Horizontal position and velocity, in the axes selected by FirmwareHabits::in_world.
  void steer_level(const StateVector<double>& x, const Eigen::Vector3d& velocity,
                   const Reference<double>& reference) {
    const FirmwareHabits& habits = s_.habits;
    Eigen::Matrix2d to_heading;
    to_heading << std::cos(x(5)), std::sin(x(5)), -std::sin(x(5)), std::cos(x(5));
    const Eigen::Matrix2d to_axes =
        habits.in_world ? Eigen::Matrix2d(Eigen::Matrix2d::Identity()) : to_heading;
    const Eigen::Vector2d error =
        to_axes * Eigen::Vector2d(reference.position.head<2>() - x.head<2>());
    const Eigen::Vector2d speed = to_axes * velocity.head<2>();
    const Eigen::Vector2d forward = habits.velocity_forward
                                        ? Eigen::Vector2d(to_axes * reference.velocity.head<2>())
                                        : Eigen::Vector2d(Eigen::Vector2d::Zero());
    const std::array<CascadeAxis, 2> level = {CascadeAxis::x, CascadeAxis::y};
    Eigen::Vector2d target, tilt;
    for (int i = 0; i < 2; ++i) {
      FirmwareAxis& one = axis(level[static_cast<std::size_t>(i)]);
      one.aim(error(i), forward(i), tilted_out_(i));
      target(i) = one.target();
    }
    target = within(target, habits.speed);
    for (int i = 0; i < 2; ++i) {
      FirmwareAxis& one = axis(level[static_cast<std::size_t>(i)]);
      one.set_target(target(i));
      tilt(i) = one.drive(speed(i), habits.guards ? tilted_out_(i) : 0);
    }
    const Eigen::Vector2d limited =
        habits.in_world ? within(tilt, habits.tilt)
                        : Eigen::Vector2d(tilt.cwiseMax(-habits.tilt).cwiseMin(habits.tilt));
    tilted_out_ = tilt - limited;
    const Eigen::Vector2d ahead = habits.in_world ? Eigen::Vector2d(to_heading * limited) : limited;
    pitch_ = -ahead(0);  // forward requires nose down, which is negative
    roll_ = ahead(1);
  }

  /// Limits the length of a vector.
  static Eigen::Vector2d within(const Eigen::Vector2d& v, double length) {
    const double norm = v.norm();
    return norm > length ? Eigen::Vector2d(v * (length / norm)) : v;
  }

  /// Computes the thrust. Down is positive in the loop and negative in the thrust.
  void lift(const StateVector<double>& x, const Eigen::Vector3d& velocity,
            const Reference<double>& reference) {
    FirmwareAxis& altitude = axis(CascadeAxis::altitude);
    const double blocked = s_.habits.guards ? -(lifted_out_ + excess_(0)) : 0;
    altitude.aim(reference.position(2) - x(2),
                 s_.habits.velocity_forward ? reference.velocity(2) : 0, blocked);
    double force = altitude.drive(velocity(2), blocked);
    if (s_.habits.acceleration) force = by_acceleration(force, velocity(2), blocked);
    const double tilt = std::cos(x(3)) * std::cos(x(4));
    const double share = s_.habits.tilt_compensation ? std::max(tilt, 0.5) : 1.0;
    const double asked = (s_.habits.weight - force) / share;
    thrust_ = std::clamp(asked, s_.habits.min_thrust, s_.frame.max_thrust);
    lifted_out_ = asked - thrust_;
  }

  /// The response of ArduPilot's acceleration loop to a requested force. The acceleration is the
  /// slope of the estimated velocity, which may be constant for some samples.
  [[nodiscard]] double by_acceleration(double force, double speed, double blocked) {
    const FirmwareHabits::Acceleration& loop = *s_.habits.acceleration;
    const double dt = s_.dt * s_.position_every;
    Acceleration& now = acceleration_;
    if (!now.filter)
      now.filter.emplace(
          loop.cutoff > 0 ? internal::LowPasses{{1, loop.cutoff}} : internal::LowPasses{}, dt);
    ++now.samples;
    if (now.speed && speed != *now.speed) now.measured = (speed - *now.speed) / (now.samples * dt);
    if (!now.speed || speed != *now.speed) {
      now.speed = speed;
      now.samples = 0;
    }
    const double error = (*now.filter)(force / s_.habits.mass - now.measured);
    const double result = loop.P * error + now.integral;
    const double growth = loop.I * error * dt;
    if (!(growth * blocked > 0))
      now.integral = std::clamp(now.integral + growth, -loop.integral, loop.integral);
    return result;
  }

  /// Angle loops: compute the set points of the rates.
  void aim_turns(const StateVector<double>& x, const Reference<double>& reference) {
    axis(CascadeAxis::roll).aim(roll_ - x(3));
    axis(CascadeAxis::pitch).aim(pitch_ - x(4));
    axis(CascadeAxis::yaw).aim(wrap_angle(reference.yaw - x(5)));
  }

  FirmwareSettings s_;
  long count_ = 0;
  bool started_ = false;
  double roll_ = 0, pitch_ = 0, thrust_ = 0;  // set points of the inner loops
  Eigen::Vector4d late_ = Eigen::Vector4d::Zero();
  Eigen::Vector4d excess_ = Eigen::Vector4d::Zero();  // requested minus produced
  Eigen::Vector2d tilted_out_ =
      Eigen::Vector2d::Zero();  // excess of the tilt set point over its limit
  double lifted_out_ = 0;       // excess of the thrust set point over its limits
  struct Acceleration {
    std::optional<double> speed;  // the newest estimate
    int samples = 0;              // number of samples since it changed
    double measured = 0, integral = 0;
    std::optional<FilterChain> filter;
  };
  Acceleration acceleration_;
};

}  // namespace

OwnController firmware_controller(const Vehicle& vehicle, const StoredParameters& parameters,
                                  const CascadeGains& pilot) {
  OwnController controller;
  controller.name = to_string(parameters.firmware.kind);
  controller.dt = settings_of(vehicle, parameters, pilot).dt;
  controller.input_kind = InputKind::wrench;
  controller.make = [parameters, pilot](const Vehicle& believed) {
    return std::make_unique<FirmwareLaw>(settings_of(believed, parameters, pilot));
  };
  return controller;
}

}  // namespace quadtune
