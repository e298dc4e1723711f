// SPDX-License-Identifier: Apache-2.0
// Converts a cascade to parameters, and reports what they cannot represent. docs/theory.md,
// "Cascades of autopilots".
#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "firmware/firmware_parts.hpp"
#include "firmware/px4_mixer.hpp"
#include "quadtune/errors.hpp"
#include "quadtune/exports/firmware.hpp"
#include "quadtune/exports/firmware_filters.hpp"
#include "quadtune/internal/joined.hpp"

namespace quadtune {
namespace {

using exports::kDegrees;
using exports::kStandardGravity;
using exports::kTurns;

/// The gains of a loop without their signs: positive gains damp.
struct Sizes {
  double Kp = 0, Ki = 0, Kd = 0;
  double lead = 0;  ///< as PidLoop::rate_lead [s]
};

/// The same feedback as a gain on the error followed by a PI controller of the rate.
struct Factored {
  double outer = 0;     ///< [1/s]
  double P = 0, I = 0;  ///< of the PI controller, times the scale of its output
  double D = 0;         ///< on the derivative of the rate, likewise
};

class Writer {
 public:
  Writer(const Firmware& firmware, const Vehicle& vehicle, const CascadeGains& gains)
      : firmware_(firmware), vehicle_(vehicle), gains_(gains) {
    facts_ = parameter_facts(firmware);
    name_ = to_string(firmware.kind);
  }

  void set(const std::string& name, double value) { values_.push_back({name, value}); }
  void note(std::string text) { notes_.push_back(std::move(text)); }

  [[nodiscard]] Sizes sizes(CascadeAxis axis) const {
    for (const PidLoop& loop : gains_.loops) {
      if (loop.name != to_string(axis)) continue;
      const double sign = cascade_sign(axis);
      const Sizes sizes{sign * loop.Kp, sign * loop.Ki, -sign * loop.Kd, loop.rate_lead};
      if (!(sizes.lead >= 0 && std::isfinite(sizes.lead)))
        throw InvalidInput(name_, fmt::format("the {} loop has rate_lead {} s, expected a finite "
                                              "time of 0 or more",
                                              loop.name, sizes.lead));
      if (!(std::isfinite(sizes.Kp) && std::isfinite(sizes.Ki) && std::isfinite(sizes.Kd)) ||
          !(sizes.Kp > 0) || !(sizes.Kd > 0) || !(sizes.Ki >= 0))
        throw InvalidInput(
            name_,
            fmt::format("the {} loop has Kp {:.6g}, Ki {:.6g}, Kd {:.6g}, expected "
                        "{}, because the firmware's gains are positive and damp",
                        loop.name, loop.Kp, loop.Ki, loop.Kd,
                        sign > 0 ? "Kp > 0, Ki >= 0 and Kd < 0" : "Kp < 0, Ki <= 0 and Kd > 0"));
      return sizes;
    }
    throw InvalidInput(
        name_, fmt::format("the cascade has no loop '{}', expected all of {}", to_string(axis),
                           internal::joined(cascade_axis_names(), ", ")));
  }

  /// Whether a derivative of a rate is filtered.
  [[nodiscard]] bool has_rate_filter() const {
    return std::any_of(gains_.loops.begin(), gains_.loops.end(), [](const PidLoop& loop) {
      return loop.rate_lead > 0 && loop.rate_filter > 0;
    });
  }

  /// @param of_error  D acts on the error of the rate, hence also on its set point: the loop has
  ///                  P + outer D in place of P
  [[nodiscard]] Factored factored(const Sizes& sizes, const std::string& loop,
                                  bool of_error = false) const {
    const double max = max_p_pi_integral(sizes.Kp, sizes.Kd);
    // The gains of a design may be exactly at the limit.
    if (sizes.Ki > max * (1 + 1e-9))
      throw InvalidInput(
          name_,
          fmt::format(
              "the {} loop has Kp {:.6g}, Ki {:.6g}, |Kd| {:.6g}, expected |Ki| <= "
              "Kp^2/(4 |Kd|) = {:.6g}, because a P controller of the angle with a PI controller "
              "of the rate cannot have a larger Ki; `quadtune pid V --structure p-pi` keeps this "
              "bound",
              loop, sizes.Kp, sizes.Ki, sizes.Kd, max));
    const double root = std::sqrt(std::max(0.0, sizes.Kp * sizes.Kp - 4 * sizes.Kd * sizes.Ki));
    // The smaller zero is computed from the product, because the difference would cancel.
    double outer = (sizes.Kp + root) / (2 * sizes.Kd);
    if (of_error && sizes.lead > 0) outer = outer_of_error(sizes, outer, loop);
    const double D = sizes.Kd * sizes.lead;
    return {outer, sizes.Kd - (of_error ? outer * D : 0), sizes.Ki / outer, D};
  }
  [[nodiscard]] Factored factored(CascadeAxis axis, bool of_error = false) const {
    return factored(sizes(axis), to_string(axis), of_error);
  }

  /// Gains that two loops must share: the geometric mean of both. It has the PI structure if both
  /// loops have it.
  [[nodiscard]] Sizes shared(CascadeAxis a, CascadeAxis b) {
    const Sizes one = sizes(a), other = sizes(b);
    const auto mean = [](double p, double q) { return std::sqrt(p * q); };
    const Sizes result{mean(one.Kp, other.Kp), mean(one.Ki, other.Ki), mean(one.Kd, other.Kd),
                       mean(one.lead, other.lead)};
    const double change =
        std::max({std::abs(result.Kp / one.Kp - 1), std::abs(result.Kd / one.Kd - 1),
                  one.Ki > 0 ? std::abs(result.Ki / one.Ki - 1) : (other.Ki > 0 ? 1.0 : 0.0)});
    constexpr double kTold = 1e-4;
    if (change > kTold)
      note(
          fmt::format("{} and {} share their gains: both get the geometric mean, which differs by "
                      "up to {:.1f} %",
                      to_string(a), to_string(b), 100 * change));
    return result;
  }

  /// The value that the board stores.
  [[nodiscard]] double stored(const ParameterFacts& facts, double value) {
    if (!facts.integer) {
      const float single = static_cast<float>(value);
      if (!std::isfinite(single) || (single == 0 && value != 0))
        throw InvalidInput(name_, fmt::format("{} would be {:.6g}, expected a number that fits a "
                                              "float",
                                              facts.name, value));
      return double{single};
    }
    const double rounded = std::round(value);
    if ((rounded == 0 && value != 0) || (facts.max && rounded > *facts.max) ||
        (facts.min && rounded < *facts.min))
      throw InvalidInput(name_,
                         fmt::format("{} would be {:.6g}, expected a whole number from {} to {}, "
                                     "the range of this parameter",
                                     facts.name, value, facts.min.value_or(0) > 0 ? *facts.min : 1,
                                     facts.max.value_or(65535)));
    constexpr double kTold = 1e-3;
    if (std::abs(rounded - value) > kTold * std::abs(value))
      note(fmt::format("{} is rounded from {:.4f} to {:g} ({:+.2f} %)", facts.name, value, rounded,
                       100 * (rounded / value - 1)));
    return rounded;
  }

  [[nodiscard]] FirmwareParameters finish() {
    FirmwareParameters result;
    for (const ParameterFacts& facts : facts_) {
      const auto given = std::find_if(values_.begin(), values_.end(),
                                      [&](const Parameter& one) { return one.name == facts.name; });
      if (given == values_.end()) continue;
      const double value = stored(facts, given->value);
      // Integers are limited to their range; for other parameters the range is only advice.
      const bool low = !facts.integer && facts.min && value < *facts.min * (1 - 1e-6);
      const bool high = !facts.integer && facts.max && value > *facts.max * (1 + 1e-6);
      if (low || high)
        note(fmt::format("{} is {:.4g}, {} the published range {} to {}, which is only advice",
                         facts.name, value, low ? "below" : "above",
                         facts.min ? fmt::format("{:g}", *facts.min) : "-",
                         facts.max ? fmt::format("{:g}", *facts.max) : "-"));
      result.values.push_back({facts.name, value});
    }
    result.notes = std::move(notes_);
    return result;
  }

  [[nodiscard]] const Firmware& firmware() const { return firmware_; }
  [[nodiscard]] const Vehicle& vehicle() const { return vehicle_; }
  [[nodiscard]] FirmwareScale scale() const { return firmware_scale(firmware_, vehicle_, values_); }

 private:
  /// The outer gain A if D acts on the error: lead A³ - A² + Kp/Kd A - Ki/Kd = 0, from
  /// P = Kd - A D, Kp = P A + I and Ki = I A.
  /// @param without  A if lead were 0, which is smaller
  [[nodiscard]] double outer_of_error(const Sizes& sizes, double without,
                                      const std::string& loop) const {
    const double a = sizes.Kp / sizes.Kd, b = sizes.Ki / sizes.Kd, lead = sizes.lead;
    const auto f = [&](double A) { return ((lead * A - 1) * A + a) * A - b; };
    const double lowest = (1 + std::sqrt(std::max(0.0, 1 - 3 * lead * a))) / (3 * lead);
    if (!internal::exists_with_error_lead(a, b, lead))
      throw InvalidInput(
          name_, fmt::format("the {} loop has rate_lead {:.6g} s, expected less than about {:.3g} "
                             "s, because the firmware differentiates the error of the rate",
                             loop, lead, 0.25 / a));
    double low = without, high = std::max(lowest, without);
    for (int i = 0; i < 200 && low < high; ++i) {
      const double middle = low + 0.5 * (high - low);
      if (middle == low || middle == high) break;
      (f(middle) > 0 ? low : high) = middle;
    }
    return high;
  }

  const Firmware& firmware_;
  const Vehicle& vehicle_;
  const CascadeGains& gains_;
  std::vector<ParameterFacts> facts_;
  std::string name_;
  std::vector<Parameter> values_;
  std::vector<std::string> notes_;
};

void write_px4(Writer& w) {
  const Vehicle& vehicle = w.vehicle();
  const std::vector<std::size_t> order = exports::px4_order(vehicle);
  // Only four rotors in X have the same order on every board.
  const bool in_x = exports::px4_is_x(vehicle);
  if (in_x) w.set("CA_ROTOR_COUNT", static_cast<double>(order.size()));
  for (std::size_t i = 0; i < order.size() && in_x; ++i) {
    const Rotor& rotor = vehicle.rotors[order[i]];
    const std::string name = fmt::format("CA_ROTOR{}_", i);
    w.set(name + "PX", rotor.position.x());
    w.set(name + "PY", rotor.position.y());
    w.set(name + "KM", -spin_sign(rotor.spin) * exports::px4_torque_ratio(rotor));
  }
  w.note(in_x
             ? "CA_ROTOR* hold the rotors of the vehicle in PX4's order: 1 front right, 2 back "
               "left, 3 "
               "front left, 4 back right"
             : "CA_ROTOR* are not written, because boards with such rotors are wired in different "
               "orders: set the position and the direction of rotation of each rotor on the board");
  w.note("THR_MDL_FAC is 0, because the gains assume it");
  w.set("THR_MDL_FAC", 0);
  const FirmwareScale scale = w.scale();
  w.set("MPC_THR_HOVER", scale.hover);
  for (const exports::TurnWords& turn : kTurns) {
    const Factored loop = w.factored(turn.axis);
    const std::string rate = fmt::format("MC_{}RATE_", turn.px4);
    const double G = scale.torque[turn.index];
    w.set(fmt::format("MC_{}_P", turn.px4), loop.outer);
    w.set(rate + "P", loop.P / G);
    w.set(rate + "I", loop.I / G);
    w.set(rate + "D", loop.D / G);
    w.set(rate + "FF", 0);
    w.set(rate + "K", 1);
  }
  if (exports::is_from(w.firmware(), "1.16")) {
    w.set("MC_YAW_TQ_CUTOFF", 0);
    w.note(
        "MC_YAW_TQ_CUTOFF is 0, which turns this filter off, because the design does not model it "
        "(the default of 2 Hz is a lag of 80 ms)");
  }
  const auto velocity = [&](const Factored& loop, double of_output, const std::string& name) {
    w.set(name + "P", loop.outer);
    w.set(name + "VEL_P_ACC", loop.P / of_output);
    w.set(name + "VEL_I_ACC", loop.I / of_output);
    w.set(name + "VEL_D_ACC", loop.D / of_output);
  };
  velocity(w.factored(w.shared(CascadeAxis::x, CascadeAxis::y), "x and y"), 1 / kStandardGravity,
           "MPC_XY_");
  velocity(w.factored(CascadeAxis::altitude), scale.thrust * scale.hover / kStandardGravity,
           "MPC_Z_");
}

/// The curve that makes ArduPilot's thrust proportional to its command, apart from the thrust of
/// the slowest rotor: a second-order curve through both ends and the middle.
double thrust_expo(const Vehicle& vehicle, double low, double high) {
  const auto thrust = [&](double x) {
    const double signal = low + (high - low) * x;
    const MotorCommand& motor = vehicle.motor;
    return rotor_thrust(vehicle.rotors.front(),
                        speed_of_command(motor, motor.min + signal * (motor.max - motor.min)));
  };
  const double min = thrust(0), all = thrust(1) - min;
  return std::clamp(2 - 4 * (thrust(0.5) - min) / all, -1.0, 1.0);
}

void write_ardupilot(Writer& w) {
  constexpr double kSpinMin = 0.15, kSpinMax = 0.95;  // defaults
  w.set("MOT_SPIN_MIN", kSpinMin);
  w.set("MOT_SPIN_MAX", kSpinMax);
  w.set("MOT_THST_EXPO", thrust_expo(w.vehicle(), kSpinMin, kSpinMax));
  const FirmwareScale scale = w.scale();
  w.set("MOT_THST_HOVER", scale.hover);
  constexpr double kMinHover = 0.125, kMaxHover = 0.6875;  // AP_MOTORS_THST_HOVER_MIN and _MAX
  if (scale.hover < kMinHover || scale.hover > kMaxHover)
    w.note(
        fmt::format("ArduPilot limits MOT_THST_HOVER to {} to {}, so the integral of the vertical "
                    "acceleration supplies the rest of the thrust",
                    kMinHover, kMaxHover));
  w.note(
      "MOT_SPIN_MIN, MOT_SPIN_MAX, MOT_THST_EXPO and MOT_THST_HOVER are written, because the gains "
      "assume them; if a motor does not start at 15 %, set its own values and design the gains "
      "again");
  w.note("FRAME_CLASS and FRAME_TYPE are not written: they must be those of the vehicle's rotors");
  w.note(
      "the filters of the velocity, PSC_*_FLTE and FLTD of 5 Hz, are not modelled in the design: x "
      "and y "
      "have "
      "32 ms more delay");
  for (const exports::TurnWords& turn : kTurns) {
    const Factored loop = w.factored(turn.axis, true);
    const std::string rate = fmt::format("ATC_RAT_{}_", turn.ardupilot);
    const double G = scale.torque[turn.index];
    w.set(fmt::format("ATC_ANG_{}_P", turn.ardupilot), loop.outer);
    w.set(rate + "P", loop.P / G);
    w.set(rate + "I", loop.I / G);
    w.set(rate + "D", loop.D / G);
    w.set(rate + "FF", 0);
    w.set(rate + "FLTE", 0);
  }
  w.note(
      "ATC_RAT_YAW_FLTE is 0, off, because its 64 ms are not modelled in the design (default 2.5 "
      "Hz)");
  const exports::ArdupilotNames names = exports::ardupilot_names(w.firmware());
  const auto velocity = [&](const Factored& loop, double of_output, const std::string& position,
                            const std::string& name) {
    w.set(position + "P", loop.outer);
    w.set(name + "P", loop.P / of_output);
    w.set(name + "I", loop.I / of_output);
    w.set(name + "D", loop.D / of_output);
  };
  velocity(w.factored(w.shared(CascadeAxis::x, CascadeAxis::y), "x and y", true),
           1 / kStandardGravity, names.horizontal_position, names.horizontal_velocity);
  velocity(w.factored(CascadeAxis::altitude, true), scale.mass, names.vertical_position,
           names.vertical_velocity);
  // The project's own rule. In 4.7 and later, the gains are a tenth of the former ones.
  const double unit = exports::is_from(w.firmware(), "4.7") ? 0.1 : 1;
  w.set(names.acceleration + "P", unit * scale.hover);
  w.set(names.acceleration + "I", unit * 2 * scale.hover);
  w.note(fmt::format(
      "{0}P and {0}I follow ArduPilot's rule, the hover throttle and twice that, because "
      "the loop of the vertical acceleration is not designed. This loop initially gives "
      "about half of the required acceleration, so the height is damped less than in "
      "the design",
      names.acceleration));
}

void write_betaflight(Writer& w) {
  const FirmwareScale scale = w.scale();
  const bool renamed = exports::is_from(w.firmware(), "2025.12");
  const Factored roll = w.factored(CascadeAxis::roll), pitch = w.factored(CascadeAxis::pitch);
  const double outer = std::sqrt(roll.outer * pitch.outer);
  if (std::abs(outer / roll.outer - 1) > 1e-4)
    w.note(
        fmt::format("roll and pitch share angle_p_gain: both get the geometric mean of {:.3f} "
                    "and {:.3f} 1/s",
                    roll.outer, pitch.outer));
  w.set("angle_p_gain", 10 * outer);
  for (const exports::TurnWords& turn : kTurns) {
    const double G = scale.torque[turn.index];
    const std::string axis = turn.small;
    const double D = w.sizes(turn.axis).Kd * w.sizes(turn.axis).lead / (G * exports::kBetaflightD);
    if (turn.axis == CascadeAxis::yaw) {
      const Sizes yaw = w.sizes(turn.axis);
      w.set("p_yaw", yaw.Kd / (G * exports::kBetaflightP));
      w.set("i_yaw", yaw.Kp / (G * exports::kBetaflightI * exports::kBetaflightYaw));
      w.note(fmt::format(
          "the firmware has no loop of the heading: i_yaw, which acts on the integral of the yaw "
          "rate, takes the place of the heading's Kp; the heading's Ki, {:.4g}, is omitted",
          yaw.Ki));
    } else {
      const Factored& loop = turn.axis == CascadeAxis::roll ? roll : pitch;
      w.set("p_" + axis, loop.P / (G * exports::kBetaflightP));
      w.set("i_" + axis, loop.I / (G * exports::kBetaflightI));
    }
    w.set("d_" + axis, D);
    w.set("f_" + axis, 0);
    w.set((renamed ? "d_max_" : "d_min_") + axis, 0);
  }
  w.set("tpa_rate", 0);
  w.set("anti_gravity_gain", 0);
  w.note(
      "f_*, d_min_* or d_max_*, tpa_rate and anti_gravity_gain are 0 in profile 0, as the design "
      "has no such terms; these zeros also apply in acro mode");
  w.note("x, y and altitude are the pilot's: the firmware has no such loops");
}

void write_crazyflie(Writer& w) {
  const FirmwareScale scale = w.scale();
  const auto cascade = [&](CascadeAxis axis, double of_output, const std::string& outer,
                           const std::string& inner, const char* mark, const char* forward) {
    const Sizes loop = w.sizes(axis);
    const std::string k = mark;
    w.set(outer + k + "p", loop.Kp / loop.Kd);
    w.set(outer + k + "i", loop.Ki / loop.Kd);
    w.set(outer + k + "d", 0);
    w.set(outer + forward, 0);
    w.set(inner + k + "p", loop.Kd / of_output);
    w.set(inner + k + "i", 0);
    w.set(inner + k + "d", loop.Kd * loop.lead / of_output);
    w.set(inner + (k == "K" ? "KFF" : "kff"), 0);
  };
  for (const exports::TurnWords& turn : kTurns)
    cascade(turn.axis, scale.torque[turn.index] * kDegrees,
            fmt::format("pid_attitude.{}_", turn.small), fmt::format("pid_rate.{}_", turn.small),
            "k", "kff");
  cascade(CascadeAxis::x, 1 / kDegrees, "posCtlPid.x", "velCtlPid.vx", "K", "Kff");
  cascade(CascadeAxis::y, 1 / kDegrees, "posCtlPid.y", "velCtlPid.vy", "K", "Kff");
  cascade(CascadeAxis::altitude, scale.thrust * exports::kCrazyflieThrust, "posCtlPid.z",
          "velCtlPid.vz", "K", "Kff");
  constexpr double kMaxThrust = 65535;
  if (scale.hover > kMaxThrust)
    throw InvalidInput(
        "crazyflie",
        fmt::format("'{}' hovers at {:.0f} % of the thrust of this Crazyflie's motors, expected a "
                    "vehicle that they lift; another set-up may have stronger motors",
                    w.vehicle().name, 100 * scale.hover / kMaxThrust));
  w.set("posCtlPid.thrustBase", scale.hover);
  constexpr double kUsualLeast = 20000;
  w.set("posCtlPid.thrustMin", std::min(kUsualLeast, scale.hover / 2));
  for (const exports::TurnWords& turn : kTurns) {
    const double kp = w.sizes(turn.axis).Kd / (scale.torque[turn.index] * kDegrees);
    constexpr double kMaxOutput = 32767;
    if (kp * kDegrees > kMaxOutput)
      throw InvalidInput("crazyflie",
                         fmt::format("pid_rate.{}_kp would be {:.6g}, expected at most {:.4g}, at "
                                     "which an error of 1 rad/s saturates the output",
                                     turn.small, kp, kMaxOutput / kDegrees));
  }
  if (w.has_rate_filter())
    w.note(
        "rate_filter_s is not written: the firmware has no parameter for the filter of the rate's "
        "derivative");
  w.note(
      "the firmware limits the integral of the angle's error to 20 deg s (yaw 360); there is no "
      "parameter for this limit");
}

}  // namespace

FirmwareParameters firmware_parameters(const Firmware& firmware, const Vehicle& vehicle,
                                       const CascadeGains& gains) {
  Writer writer(firmware, vehicle, gains);
  switch (firmware.kind) {
    case FirmwareKind::px4:
      write_px4(writer);
      break;
    case FirmwareKind::ardupilot:
      write_ardupilot(writer);
      break;
    case FirmwareKind::betaflight:
      write_betaflight(writer);
      break;
    case FirmwareKind::crazyflie:
      write_crazyflie(writer);
      break;
  }
  return writer.finish();
}

}  // namespace quadtune
