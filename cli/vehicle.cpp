// SPDX-License-Identifier: Apache-2.0
/// quadtune vehicle: the built-in vehicles, one in full, or whether a file is right.
#include "quadtune/model/vehicle.hpp"

#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <Eigen/SVD>
#include <cmath>
#include <memory>
#include <ostream>

#include "print.hpp"
#include "program.hpp"
#include "quadtune/internal/json.hpp"
#include "quadtune/internal/suggest.hpp"
#include "quadtune/linearize/trim.hpp"
#include "quadtune/model/mixer.hpp"

namespace quadtune::cli {
namespace {

using internal::Json;

/// NaN in a vehicle means "not known": null in JSON.
Json known(double value) { return std::isfinite(value) ? Json(value) : Json(nullptr); }

std::string spin_word(Spin spin) { return spin == Spin::clockwise ? "cw" : "ccw"; }

Json rotor_json(const Rotor& rotor) {
  return {{"position_m", internal::vector_to_json(rotor.position, "position")},
          {"spin", spin_word(rotor.spin)},
          {"thrust_a2_N_s2", rotor.thrust_a2},
          {"thrust_a1_N_s", rotor.thrust_a1},
          {"torque_d2_Nm_s2", rotor.torque_d2},
          {"torque_d1_Nm_s", rotor.torque_d1},
          {"inertia_kg_m2", rotor.inertia},
          {"lag_s", rotor.lag},
          {"radius_m", known(rotor.radius)},
          {"chord_m", known(rotor.chord)},
          {"Ct", known(rotor.Ct)},
          {"Cq", known(rotor.Cq)},
          {"blades", rotor.blades}};
}

/// Hover speed [rad/s] of the first rotor, or NaN where the vehicle cannot hover.
double hover_speed(const TrimResult& hover) {
  return hover.solved() ? hover.u(0) : std::numeric_limits<double>::quiet_NaN();
}

Json vehicle_json(const Vehicle& vehicle) {
  Json json;
  json["name"] = vehicle.name;
  json["description"] = vehicle.description;
  json["source"] = vehicle.source;
  json["mass_kg"] = vehicle.mass;
  json["inertia_kg_m2"] = internal::matrix_to_json(vehicle.inertia, "inertia");
  json["gravity_m_s2"] = vehicle.gravity;
  json["air_density_kg_m3"] = vehicle.air_density;
  json["drag"] = {{"cda_m2", internal::vector_to_json(vehicle.drag.cda, "cda")},
                  {"linear_N_s_m", internal::vector_to_json(vehicle.drag.linear, "linear")}};
  json["motor"] = {{"law", vehicle.motor.law == CommandLaw::speed ? "speed" : "speed-squared"},
                   {"gain", vehicle.motor.gain},
                   {"unit", vehicle.motor.unit},
                   {"min", vehicle.motor.min},
                   {"max", vehicle.motor.max},
                   {"direction", vehicle.motor.direction}};
  json["takeoff_gain"] = vehicle.takeoff_gain;
  json["altitude_thrust_fraction"] = vehicle.altitude_thrust_fraction;
  json["airframe_height_m"] = known(vehicle.airframe_height);
  json["airframe_diameter_m"] = known(vehicle.airframe_diameter);
  json["rotors"] = Json::array();
  for (const Rotor& rotor : vehicle.rotors) json["rotors"].push_back(rotor_json(rotor));
  const TrimResult hover = trim(vehicle, FlightCondition{});
  json["derived"] = {
      {"hover_speed_rad_s", known(hover_speed(hover))},
      {"thrust_to_weight", greatest_thrust(vehicle) / (vehicle.mass * vehicle.gravity)},
      {"can_hover", hover.solved()}};
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
                        spin_word(rotor.spin),
                        fmt::format("{:.4g} w2 {:+.4g} w", rotor.thrust_a2, rotor.thrust_a1),
                        fmt::format("{:.4g} w2 {:+.4g} w", rotor.torque_d2, rotor.torque_d1));
  }
  return text;
}

std::string vehicle_text(const Vehicle& vehicle) {
  const TrimResult hover = trim(vehicle, FlightCondition{});
  const double ratio = greatest_thrust(vehicle) / (vehicle.mass * vehicle.gravity);
  std::string text = section("vehicle", vehicle.name + ": " + vehicle.description);
  text += section("source", vehicle.source);
  text += section("mass", number(vehicle.mass) + " kg");
  text += section("inertia", plain(vehicle.inertia) + " kg m2");
  text += section("rotors", rotor_table(vehicle));
  text += section("motors", fmt::format("{} = {} x command, command {} ... {} {}",
                                        vehicle.motor.law == CommandLaw::speed ? "w" : "w2",
                                        number(vehicle.motor.gain), number(vehicle.motor.min),
                                        number(vehicle.motor.max), vehicle.motor.unit));
  text += section("hover", hover.solved()
                               ? fmt::format("{} rad/s ({:.6g} {}), thrust-to-weight {:.3f}",
                                             number(hover_speed(hover)),
                                             command_of_speed(vehicle.motor, hover_speed(hover)),
                                             vehicle.motor.unit, ratio)
                               : "impossible: " + hover.culprit);
  return text;
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
  if (!hover.solved()) throw NoSolution(name + ": cannot hover: " + hover.culprit, name);
  require_authority(vehicle, hover, name);
  if (context.json)
    context.out << internal::readable(vehicle_json(vehicle)) << "\n";
  else
    context.out << fmt::format("{}: {} is complete and can hover at {} rad/s\n", name, vehicle.name,
                               number(hover_speed(hover)));
}

}  // namespace

Verb vehicle_verb() {
  struct Options {
    std::string action, vehicle;
  };
  return {"vehicle", "list | show V | check FILE", "list, show or check vehicles",
          "quadtune vehicle show mambo", [](CLI::App& app) -> Action {
            auto options = std::make_shared<Options>();
            app.add_option("ACTION", options->action, "list, show or check");
            app.add_option("V", options->vehicle, "a built-in vehicle's name or a vehicle file");
            return [options](Context& context) {
              const std::string& action = options->action;
              if (action != "list" && action != "show" && action != "check")
                throw UsageError(
                    fmt::format("quadtune vehicle: '{}', expected list, show V or check FILE{}",
                                action, internal::did_you_mean(action, {"list", "show", "check"})),
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
