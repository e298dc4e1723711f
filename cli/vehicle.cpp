// SPDX-License-Identifier: Apache-2.0
/// quadtune vehicle: the built-in vehicles, one in full, or whether a file is right.
#include "quadtune/model/vehicle.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <Eigen/SVD>
#include <algorithm>
#include <cmath>
#include <memory>
#include <ostream>

#include "program/command_line.hpp"
#include "program/program.hpp"
#include "quadtune/exports/export.hpp"
#include "quadtune/internal/json.hpp"
#include "quadtune/internal/suggest.hpp"
#include "quadtune/linearize/trim.hpp"
#include "quadtune/model/assumed_values.hpp"
#include "quadtune/model/mixer.hpp"
#include "quadtune/model/plausibility.hpp"
#include "report/text/print.hpp"

namespace quadtune::cli {
namespace {

using internal::Json;

/// Hover speed [rad/s] of the first rotor, where the vehicle can hover.
double hover_speed(const TrimResult& hover) { return hover.u(0); }

Json warnings_json(const Vehicle& vehicle) {
  Json warnings = Json::array();
  for (const Implausibility& figure : implausible(vehicle))
    warnings.push_back({{"quantity", figure.quantity},
                        {"value", figure.value},
                        {"unit", figure.unit},
                        {"plausible", {figure.low, figure.high}},
                        {"cause", figure.cause}});
  return warnings;
}

/// The vehicle file's keys, what follows from them, what is assumed, and what is odd.
Json vehicle_json(const Vehicle& vehicle) {
  Json json = Json::parse(vehicle_json_text(vehicle));
  const TrimResult hover = trim(vehicle, FlightCondition{});
  json["assumed"] = Json::object();
  for (const AssumedValue& assumed : assumed_values(vehicle))
    json["assumed"][assumed.key] = assumed.value;
  json["warnings"] = warnings_json(vehicle);
  json["derived"]["can_hover"] = hover.solved();
  if (hover.solved()) json["derived"]["hover_speed_rad_s"] = hover_speed(hover);
  json["derived"]["thrust_to_weight"] = greatest_thrust(vehicle) / (vehicle.mass * vehicle.gravity);
  return json;
}

std::string rotor_table(const Vehicle& vehicle) {
  std::string text = fmt::format("{:<4}{:>26}  {:>4}{:>28}{:>28}", "", "position x y z [m]", "spin",
                                 "thrust [N]", "drag torque [N m]");
  for (std::size_t i = 0; i < vehicle.rotors.size(); ++i) {
    const Rotor& rotor = vehicle.rotors[i];
    text += fmt::format("\n{:<4}{:>26}  {:>4}{:>28}{:>28}", i + 1,
                        fmt::format("{:.4f} {:.4f} {:.4f}", rotor.position.x(), rotor.position.y(),
                                    rotor.position.z()),
                        to_string(rotor.spin),
                        fmt::format("{:.4g} w2 {:+.4g} w", rotor.thrust_a2, rotor.thrust_a1),
                        fmt::format("{:.4g} w2 {:+.4g} w", rotor.torque_d2, rotor.torque_d1));
  }
  return text;
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

/// "0.1 0.2 0.3"
std::string list(const Eigen::VectorXd& values) {
  std::string text;
  for (const double value : values) text += (text.empty() ? "" : " ") + number(value);
  return text;
}

std::string drag_text(const Drag& drag) {
  return fmt::format("area {} m2, linear {} N s/m along x y z", list(drag.cda), list(drag.linear));
}

/// One sensor a line: what its file may say, without what it says of its place.
std::string sensors_text(const Vehicle& vehicle) {
  std::string text;
  const auto add = [&](const char* name, const SensorFaults& f, int axes, const char* unit) {
    const auto values = [axes](const Eigen::Vector3d& v) {
      return (v.head(axes).array() == v(0)).all() ? number(v(0)) : list(v.head(axes));
    };
    text += fmt::format("{}{:<14}{} Hz, noise {} {}", text.empty() ? "" : "\n", name,
                        number(f.rate), values(f.noise), unit);
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
  };
  const Sensors& s = vehicle.sensors;
  if (s.accelerometer) add("accelerometer", *s.accelerometer, 3, "m/s2");
  if (s.gyroscope) {
    add("gyroscope", *s.gyroscope, 3, "rad/s");
    if (!s.g_sensitivity.isZero(0))
      text += fmt::format(", {} {} {} rad/s per m/s2", number(s.g_sensitivity.x()),
                          number(s.g_sensitivity.y()), number(s.g_sensitivity.z()));
  }
  if (s.magnetometer) add("magnetometer", *s.magnetometer, 3, "uT");
  if (s.barometer) {
    add("barometer", s.barometer->faults, 1, "Pa");
    text += fmt::format(", {} Pa at the ground", number(s.barometer->ground_pressure));
    if (!std::isnan(s.barometer->fall)) text += fmt::format(", {} Pa/m", number(s.barometer->fall));
  }
  if (s.sonar) {
    add("sonar", s.sonar->faults, 1, "m");
    text += fmt::format(", range {} ... {} m, tilt up to {} rad", number(s.sonar->least_range),
                        number(s.sonar->greatest_range), number(s.sonar->greatest_tilt));
  }
  if (s.flow) {
    add("flow", s.flow->faults, 2, "rad/s");
    text += fmt::format(", half field {} {} rad, above {} m", number(s.flow->half_field_x),
                        number(s.flow->half_field_y), number(s.flow->least_height));
    if (std::isfinite(s.flow->greatest_height))
      text += fmt::format(" and below {} m", number(s.flow->greatest_height));
    if (s.flow->noise_per_height > 0)
      text += fmt::format(", noise {} rad/s/m more with height", number(s.flow->noise_per_height));
  }
  if (s.gps) {
    add("gps", s.gps->position, 3, "m");
    text += fmt::format(", velocity noise {} m/s", number(s.gps->velocity_noise.x()));
  }
  if (s.vision) add("vision", *s.vision, 3, "m");
  if (text.empty()) return "none";
  return vehicle.sensors_known ? text : text + "\nassumed: the file has no [sensors]";
}

std::string battery_text(const std::optional<Battery>& battery) {
  if (!battery) return "assumed: a supply that never falls, as the file has no [battery]";
  return fmt::format(
      "{} A h, {} ... {} V, cut-off {} V, rated {} V, {} ohm, efficiency {}, idle {} W; {}",
      number(battery->capacity / 3600), number(battery->empty_voltage),
      number(battery->full_voltage), number(battery->cutoff_voltage),
      number(battery->rated_voltage), number(battery->resistance), number(battery->efficiency),
      number(battery->idle_power),
      battery->regulated ? "only the greatest speed falls with the voltage"
                         : "every speed falls with the voltage");
}

std::string assumed_text(const Vehicle& vehicle) {
  std::string text;
  for (const AssumedValue& assumed : assumed_values(vehicle))
    text += fmt::format("{}{} = {}", text.empty() ? "" : "\n", assumed.key, assumed.value);
  return text.empty() ? "nothing: the file has every key" : text;
}

std::string warnings_text(const Vehicle& vehicle) {
  std::string text;
  for (const Implausibility& figure : implausible(vehicle))
    text += (text.empty() ? "" : "\n") + to_string(figure);
  return text.empty() ? "" : section("warnings", text);
}

std::string vehicle_text(const Vehicle& vehicle) {
  const TrimResult hover = trim(vehicle, FlightCondition{});
  const double ratio = greatest_thrust(vehicle) / (vehicle.mass * vehicle.gravity);
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
  text += section("flight", fmt::format("thrust at take-off {} m g; {} of the greatest thrust for "
                                        "the altitude loop",
                                        number(1 + vehicle.takeoff_gain),
                                        number(vehicle.altitude_thrust_fraction)));
  if (vehicle.published_cascade)
    text += section("published", fmt::format("PID cascade every {} s: {}",
                                             number(vehicle.published_cascade->gains.dt),
                                             vehicle.published_cascade->source));
  text += section("hover", hover.solved()
                               ? fmt::format("{} rad/s ({:.6g} {}), thrust-to-weight {:.3f}",
                                             number(hover_speed(hover)),
                                             command_of_speed(vehicle.motor, hover_speed(hover)),
                                             vehicle.motor.unit, ratio)
                               : "impossible: " + hover.culprit);
  text += section("assumed", assumed_text(vehicle));
  return text + warnings_text(vehicle);
}

void list(Context& context) {
  if (context.json) {
    Json json = {{"vehicles", built_in_vehicles()}};
    context.out << internal::readable(json) << "\n";
    return;
  }
  for (const std::string& name : built_in_vehicles()) {
    const Vehicle vehicle = load_vehicle(name);
    context.out << fmt::format("{:<16}{:<10}{}\n", name, number(vehicle.mass) + " kg",
                               vehicle.description);
  }
}

void show(const std::string& name, Context& context) {
  const Vehicle vehicle = load_vehicle(name);
  context.out << (context.json ? internal::readable(vehicle_json(vehicle)) + "\n"
                               : vehicle_text(vehicle));
}

/// A vehicle hovers by luck alone unless its rotors can change thrust and all three torques.
void require_authority(const Vehicle& vehicle, const TrimResult& hover, const std::string& name) {
  Eigen::MatrixXd J = wrench_jacobian(vehicle, hover.u);
  const char* axes[] = {"thrust", "roll", "pitch", "yaw"};
  for (Eigen::Index i = 0; i < 4; ++i)
    if (J.row(i).norm() == 0)
      throw NoSolution(fmt::format("{}: no authority: no rotor changes {}", name, axes[i]), name);
  J.rowwise().normalize();
  const Eigen::VectorXd singular = Eigen::JacobiSVD<Eigen::MatrixXd>(J).singularValues();
  if (singular.size() < 4 || singular(3) < 1e-9)
    throw NoSolution(name +
                         ": no authority: the rotors cannot change thrust and the three torques "
                         "independently of one another",
                     name);
}

/// Reads the file, which refuses what is wrong in it, and asks whether it can hover.
void check(const std::string& name, Context& context) {
  const Vehicle vehicle = load_vehicle(name);
  const TrimResult hover = trim(vehicle, FlightCondition{});
  const std::vector<Implausibility> odd = implausible(vehicle);
  if (!hover.solved())
    throw NoSolution(fmt::format("{}: cannot hover: {}{}", name, hover.culprit,
                                 odd.empty() ? "" : "; " + to_string(odd.front())),
                     name);
  require_authority(vehicle, hover, name);
  if (context.json) {
    context.out << internal::readable(vehicle_json(vehicle)) << "\n";
    return;
  }
  context.out << fmt::format("{}: {} is complete and can hover at {} rad/s\n", name, vehicle.name,
                             number(hover_speed(hover)));
  for (const Implausibility& figure : odd)
    context.out << fmt::format("{}: warning: {}\n", name, to_string(figure));
}

}  // namespace

Verb vehicle_verb() {
  struct Options {
    std::string action, vehicle;
  };
  return {"vehicle", "list | show V | check FILE", "list, show or check vehicles",
          "quadtune vehicle show mambo", [](CommandLine& line) -> Action {
            auto options = std::make_shared<Options>();
            line.add_option("ACTION", options->action, "list, show or check");
            line.add_option("V", options->vehicle, "a built-in vehicle's name or a vehicle file");
            return [options](Context& context) {
              const std::string& action = options->action;
              if (action != "list" && action != "show" && action != "check")
                throw UsageError(
                    fmt::format("quadtune vehicle: {}, expected list, show V or check FILE{}",
                                action.empty() ? "no action came" : "'" + action + "'",
                                internal::did_you_mean(action, {"list", "show", "check"})),
                    "ACTION");
              if (action == "list") {
                if (!options->vehicle.empty())
                  throw UsageError(
                      fmt::format("quadtune vehicle: unexpected argument '{}' after list",
                                  options->vehicle),
                      options->vehicle);
                return list(context);
              }
              if (options->vehicle.empty())
                throw UsageError(
                    fmt::format("quadtune vehicle: {} needs a built-in vehicle's name or a file",
                                action),
                    "V");
              return action == "show" ? show(options->vehicle, context)
                                      : check(options->vehicle, context);
            };
          }};
}

}  // namespace quadtune::cli
