// SPDX-License-Identifier: Apache-2.0
/// quadtune vehicle: the built-in vehicles, one in full, or whether a file is right.
#include "quadtune/model/vehicle.hpp"

#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <Eigen/SVD>
#include <memory>
#include <ostream>

#include "print.hpp"
#include "program.hpp"
#include "quadtune/exports/export.hpp"
#include "quadtune/internal/json.hpp"
#include "quadtune/internal/suggest.hpp"
#include "quadtune/linearize/trim.hpp"
#include "quadtune/model/mixer.hpp"

namespace quadtune::cli {
namespace {

using internal::Json;

/// Hover speed [rad/s] of the first rotor, where the vehicle can hover.
double hover_speed(const TrimResult& hover) { return hover.u(0); }

/// The vehicle file's keys, and what follows from them.
Json vehicle_json(const Vehicle& vehicle) {
  Json json = Json::parse(vehicle_json_text(vehicle));
  const TrimResult hover = trim(vehicle, FlightCondition{});
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
