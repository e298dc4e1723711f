// SPDX-License-Identifier: Apache-2.0
#include "report/vehicles/vehicle_report.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>
#include <utility>

#include "quadtune/exports/export.hpp"
#include "quadtune/internal/json.hpp"
#include "quadtune/model/assumed_values.hpp"
#include "quadtune/model/mixer.hpp"
#include "quadtune/model/sensors.hpp"
#include "quadtune/model/vehicle.hpp"
#include "quadtune/model/vehicle_spread.hpp"
#include "quadtune/workbench/vehicle/vehicle_check.hpp"
#include "report/text/print.hpp"
#include "report/text/rows.hpp"

namespace quadtune::report {
namespace {

/// One number where all axes have the same, else one for each of them.
std::string of_axes(const Eigen::Vector3d& v, int axes) {
  return (v.head(axes).array() == v(0)).all() ? number(v(0)) : numbers(v.head(axes));
}

/// "gyroscope     200 Hz, noise 0.01 rad/s, delay 0.005 s"
std::string line_of(const char* name, const SensorFaults& f, int axes, const char* unit) {
  const auto values = [axes](const Eigen::Vector3d& v) { return of_axes(v, axes); };
  std::string text =
      fmt::format("{:<14}{} Hz, noise {} {}", name, number(f.rate), values(f.noise), unit);
  if (f.delay > 0) text += fmt::format(", delay {} s", number(f.delay));
  if (!f.bias.isZero(0)) text += fmt::format(", bias {} {}", values(f.bias), unit);
  if (!f.scale.isOnes(0)) text += fmt::format(", scale {}", values(f.scale));
  if (f.natural_frequency > 0)
    text += fmt::format(", response {} rad/s damped {}", number(f.natural_frequency),
                        number(f.damping));
  if (std::isfinite(f.limit)) text += fmt::format(", limit {} {}", number(f.limit), unit);
  if (f.quantum > 0) text += fmt::format(", steps of {} {}", number(f.quantum), unit);
  if (f.dropout > 0) text += fmt::format(", {} lost", number(f.dropout));
  if (!f.turn_on_bias.isZero(0))
    text += fmt::format(", bias at turn-on {} {}", values(f.turn_on_bias), unit);
  if (!f.bias_walk.isZero(0))
    text += fmt::format(", bias walk {} {}/sqrt(s)", values(f.bias_walk), unit);
  if (!f.correlated_noise.isZero(0))
    text += fmt::format(", correlated over {} s {} {}", number(f.correlation),
                        values(f.correlated_noise), unit);
  if (!f.vibration.isZero(0))
    text += fmt::format(", vibration {} {} s2/rad2", values(f.vibration), unit);
  return text;
}

std::string gyroscope_text(const SensorFaults& faults, const Eigen::Vector3d& g_sensitivity) {
  std::string text = line_of("gyroscope", faults, 3, "rad/s");
  if (!g_sensitivity.isZero(0)) text += fmt::format(", {} rad/s per m/s2", numbers(g_sensitivity));
  return text;
}

std::string barometer_text(const BarometerSensor& barometer) {
  std::string text = line_of("barometer", barometer.faults, 1, "Pa");
  text += fmt::format(", {} Pa at the ground", number(barometer.ground_pressure));
  if (!std::isnan(barometer.fall)) text += fmt::format(", {} Pa/m", number(barometer.fall));
  return text;
}

std::string sonar_text(const SonarSensor& sonar) {
  return line_of("sonar", sonar.faults, 1, "m") +
         fmt::format(", range {} ... {} m, tilt up to {} rad", number(sonar.min_range),
                     number(sonar.max_range), number(sonar.max_tilt));
}

std::string flow_text(const FlowSensor& flow) {
  std::string text = line_of("flow", flow.faults, 2, "rad/s");
  text += fmt::format(", half field {} {} rad, above {} m", number(flow.half_field_x),
                      number(flow.half_field_y), number(flow.min_height));
  if (std::isfinite(flow.max_height))
    text += fmt::format(" and below {} m", number(flow.max_height));
  if (flow.noise_per_height > 0)
    text += fmt::format(", noise {} rad/s/m more with height", number(flow.noise_per_height));
  return text;
}

/// One sensor a line: rate, noise and faults, without its place on the vehicle.
std::string sensors_text(const Vehicle& vehicle) {
  const Sensors& s = vehicle.sensors;
  std::string text;
  const auto add = [&](const std::string& line) { text += (text.empty() ? "" : "\n") + line; };
  if (s.accelerometer) add(line_of("accelerometer", *s.accelerometer, 3, "m/s2"));
  if (s.gyroscope) add(gyroscope_text(*s.gyroscope, s.g_sensitivity));
  if (s.magnetometer) add(line_of("magnetometer", *s.magnetometer, 3, "uT"));
  if (s.barometer) add(barometer_text(*s.barometer));
  if (s.sonar) add(sonar_text(*s.sonar));
  if (s.flow) add(flow_text(*s.flow));
  if (s.gps)
    add(line_of("gps", s.gps->position, 3, "m") +
        fmt::format(", velocity noise {} m/s", number(s.gps->velocity_noise.x())));
  if (s.vision) add(line_of("vision", *s.vision, 3, "m"));
  if (text.empty()) return "none";
  return vehicle.sensors_known ? text : text + "\nassumed: the file has no [sensors]";
}

using internal::Json;

/// Hover speed [rad/s] of the first rotor, where the vehicle can hover.
double hover_speed(const TrimResult& hover) { return hover.u(0); }

Json warnings_json(const Vehicle& vehicle) {
  Json warnings = Json::array();
  for (const Implausibility& figure : find_implausible_values(vehicle))
    warnings.push_back({{"quantity", figure.quantity},
                        {"value", figure.value},
                        {"unit", figure.unit},
                        {"plausible", {figure.low, figure.high}},
                        {"cause", figure.cause}});
  return warnings;
}

std::string rotor_table(const Vehicle& vehicle) {
  Cells cells = {{"", "position x y z [m]", "spin", "thrust [N]", "drag torque [N m]"}};
  for (std::size_t i = 0; i < vehicle.rotors.size(); ++i) {
    const Rotor& rotor = vehicle.rotors[i];
    cells.push_back({fmt::format("{}", i + 1),
                     fmt::format("{:.4f} {:.4f} {:.4f}", rotor.position.x(), rotor.position.y(),
                                 rotor.position.z()),
                     to_string(rotor.spin),
                     fmt::format("{:.4g} w2 {:+.4g} w", rotor.thrust_a2, rotor.thrust_a1),
                     fmt::format("{:.4g} w2 {:+.4g} w", rotor.torque_d2, rotor.torque_d1)});
  }
  return aligned(cells);
}

/// "0.072 s", or of rotors that differ "0.05 0.06 0.05 0.06 s".
std::string of_rotors(const Vehicle& vehicle, double Rotor::*member, const char* unit) {
  std::string all;
  bool same = true;
  for (const Rotor& rotor : vehicle.rotors) {
    all += number(rotor.*member) + " ";
    same = same && rotor.*member == vehicle.rotors.front().*member;
  }
  return (same ? number(vehicle.rotors.front().*member) + " " : all) + unit;
}

/// With the lag of slowing down written out where it is that of both.
Vehicle slowing(Vehicle vehicle) {
  for (Rotor& rotor : vehicle.rotors) rotor.lag_down = lag_down(rotor);
  return vehicle;
}

/// What of a rotor is in no column of the table.
std::string propeller_text(const Vehicle& vehicle) {
  const Rotor& rotor = vehicle.rotors.front();
  std::string text = fmt::format("lag {}; inertia {}", of_rotors(vehicle, &Rotor::lag, "s"),
                                 of_rotors(vehicle, &Rotor::inertia, "kg m2"));
  if (!std::isnan(rotor.radius)) text += "; radius " + of_rotors(vehicle, &Rotor::radius, "m");
  if (!std::isnan(rotor.chord)) text += "; chord " + of_rotors(vehicle, &Rotor::chord, "m");
  if (rotor.blades > 0) text += fmt::format("; {} blades", rotor.blades);
  const auto any = [&](auto&& has) {
    return std::any_of(vehicle.rotors.begin(), vehicle.rotors.end(), has);
  };
  if (any([](const Rotor& r) { return lag_down(r) != r.lag; }))
    text += "; slowing down with lag " + of_rotors(slowing(vehicle), &Rotor::lag_down, "s");
  if (any([](const Rotor& r) { return r.drag > 0; }))
    text += "; drag " + of_rotors(vehicle, &Rotor::drag, "N s2/(rad m)");
  if (any([](const Rotor& r) { return r.inflow > 0; }))
    text += "; inflow " + of_rotors(vehicle, &Rotor::inflow, "N s2/(rad m)");
  if (any([](const Rotor& r) { return r.flapping > 0; }))
    text += "; flapping " + of_rotors(vehicle, &Rotor::flapping, "N s2/rad");
  if (any([](const Rotor& r) { return r.ground_effect; })) text += "; ground effect";
  return text;
}

std::string motors_text(const MotorCommand& motor) {
  std::string text = fmt::format("{} = {} x command, command {} ... {} {}",
                                 motor.law == CommandLaw::speed ? "w" : "w2", number(motor.gain),
                                 number(motor.min), number(motor.max), motor.unit);
  if (motor.quantum > 0)
    text += fmt::format(", in steps of {} {}", number(motor.quantum), motor.unit);
  if (motor.delay > 0) text += fmt::format(", {} s late", number(motor.delay));
  if (motor.delay_jitter > 0)
    text += fmt::format(", up to {} s of jitter", number(motor.delay_jitter));
  const bool turned = std::any_of(motor.direction.begin(), motor.direction.end(),
                                  [](int sign) { return sign < 0; });
  if (turned) text += fmt::format("; signs {}", fmt::join(motor.direction, " "));
  return text;
}

std::string drag_text(const Drag& drag) {
  return fmt::format("area {} m2, linear {} N s/m along x y z", numbers(drag.cda),
                     numbers(drag.linear));
}

std::string battery_text(const std::optional<Battery>& battery) {
  if (!battery) return "assumed: a supply that never falls, as the file has no [battery]";
  return fmt::format(
      "{} A h, {} ... {} V, cut-off {} V, rated {} V, {} ohm, efficiency {}, idle {} W; {}",
      number(battery->capacity / 3600), number(battery->empty_voltage),
      number(battery->full_voltage), number(battery->cutoff_voltage),
      number(battery->rated_voltage), number(battery->resistance), number(battery->efficiency),
      number(battery->idle_power),
      battery->regulated ? "only the maximum speed falls with the voltage"
                         : "every speed falls with the voltage");
}

/// The stated members of a spread with their names.
std::vector<std::pair<const char*, double>> stated(const VehicleSpread& spread) {
  std::vector<std::pair<const char*, double>> all = {{"mass", spread.mass},
                                                     {"inertia", spread.inertia},
                                                     {"thrust", spread.thrust},
                                                     {"motor_lag", spread.motor_lag}};
  std::erase_if(all, [](const auto& one) { return !(one.second > 0); });
  return all;
}

std::string spread_text(const VehicleSpread& spread) {
  std::string text;
  for (const auto& [name, half_width] : stated(spread))
    text += fmt::format("{}{} {} %", text.empty() ? "" : ", ", name, number(100 * half_width));
  return text + ": 95 % intervals about the numbers of the file";
}

std::string assumed_text(const Vehicle& vehicle) {
  std::string text;
  for (const AssumedValue& assumed : assumed_values(vehicle))
    text += fmt::format("{}{} = {}", text.empty() ? "" : "\n", assumed.key, assumed.value);
  return text.empty() ? "nothing: the file has every key" : text;
}

std::string warnings_text(const Vehicle& vehicle) {
  std::string text;
  for (const Implausibility& figure : find_implausible_values(vehicle))
    text += (text.empty() ? "" : "\n") + to_string(figure);
  return text.empty() ? "" : section("warnings", text);
}

}  // namespace

Json to_json(const Vehicle& vehicle) {
  Json json = Json::parse(vehicle_json_text(vehicle));
  const TrimResult hover = trim(vehicle, FlightCondition{});
  json["assumed"] = Json::object();
  for (const AssumedValue& assumed : assumed_values(vehicle))
    json["assumed"][assumed.key] = assumed.value;
  for (const auto& [name, half_width] : stated(spread_of(vehicle)))
    json["spread"][name] = half_width;
  json["warnings"] = warnings_json(vehicle);
  json["derived"]["can_hover"] = hover.solved();
  if (hover.solved()) json["derived"]["hover_speed_rad_s"] = hover_speed(hover);
  json["derived"]["thrust_to_weight"] = thrust_to_weight(vehicle);
  return json;
}

std::string to_text(const Vehicle& vehicle) {
  const TrimResult hover = trim(vehicle, FlightCondition{});
  std::string text = section("vehicle", vehicle.name + ": " + vehicle.description);
  text += section("source", vehicle.source);
  text += section("environment", fmt::format("gravity {} m/s2, air density {} kg/m3",
                                             number(vehicle.gravity), number(vehicle.air_density)));
  text += section("mass", number(vehicle.mass) + " kg");
  text += section("inertia", plain(vehicle.inertia) + " kg m2" +
                                 (vehicle.inertia_tolerance > 0
                                      ? fmt::format(", tolerance {} of the triangle inequality",
                                                    number(vehicle.inertia_tolerance))
                                      : ""));
  std::string size;
  if (!std::isnan(vehicle.airframe_height))
    size += fmt::format("height {} m ", number(vehicle.airframe_height));
  if (!std::isnan(vehicle.airframe_diameter))
    size += fmt::format("diameter {} m", number(vehicle.airframe_diameter));
  if (!size.empty()) text += section("airframe", size);
  text += section("rotors", rotor_table(vehicle) + "\n" + propeller_text(vehicle));
  text += section("motors", motors_text(vehicle.motor));
  text += section("drag", drag_text(vehicle.drag));
  text += section("sensors", sensors_text(vehicle));
  text += section("battery", battery_text(vehicle.battery));
  text += section("flight", fmt::format("thrust at take-off {} m g; {} of the maximum thrust for "
                                        "the altitude loop",
                                        number(1 + vehicle.takeoff_gain),
                                        number(vehicle.altitude_thrust_fraction)));
  if (vehicle.published_cascade)
    text += section("published", fmt::format("PID cascade every {} s: {}",
                                             number(vehicle.published_cascade->gains.dt),
                                             vehicle.published_cascade->source));
  text += section(
      "hover", hover.solved() ? fmt::format("{} rad/s (command {:.6g} {}), thrust-to-weight {:.3f}",
                                            number(hover_speed(hover)),
                                            command_of_speed(vehicle.motor, hover_speed(hover)),
                                            vehicle.motor.unit, thrust_to_weight(vehicle))
                              : "impossible: " + hover.culprit);
  if (const VehicleSpread spread = spread_of(vehicle); spread.stated())
    text += section("spread", spread_text(spread));
  text += section("assumed", assumed_text(vehicle));
  return text + warnings_text(vehicle);
}

std::string to_text(const VehicleCheck& check, const std::string& name) {
  std::string text = fmt::format("{}: {} is complete and can hover at {} rad/s\n", name,
                                 check.vehicle.name, number(hover_speed(check.hover)));
  for (const Implausibility& figure : check.warnings)
    text += fmt::format("{}: warning: {}\n", name, to_string(figure));
  for (const std::string& obstacle : check.obstacles)
    text += fmt::format("{}: warning: {}\n", name, obstacle);
  return text;
}

std::string vehicle_list(const std::vector<std::string>& names) {
  std::string text;
  for (const std::string& name : names) {
    const Vehicle vehicle = load_vehicle(name);
    text +=
        fmt::format("{:<16}{:<10}{}\n", name, number(vehicle.mass) + " kg", vehicle.description);
  }
  return text;
}

}  // namespace quadtune::report
