// SPDX-License-Identifier: Apache-2.0
// Reads vehicle files, whose format is documented in docs/formats.md.
#include <fmt/format.h>

#include <cmath>
#include <numbers>

#include "control/cascade_reader.hpp"
#include "model/sensor_file.hpp"
#include "model/spread_reader.hpp"
#include "quadtune/errors.hpp"
#include "quadtune/internal/built_in.hpp"
#include "quadtune/internal/counted.hpp"
#include "quadtune/internal/joined.hpp"
#include "quadtune/internal/suggest.hpp"
#include "quadtune/internal/text_file.hpp"
#include "quadtune/internal/toml_reader.hpp"
#include "quadtune/model/inertia.hpp"
#include "quadtune/model/vehicle.hpp"

namespace quadtune {
namespace {

using internal::Range;
using internal::TomlKey;
using internal::TomlTable;

constexpr double kNaN = std::numeric_limits<double>::quiet_NaN();
constexpr char kThrustA2[] = "thrust_a2_N_s2_per_rad2";
constexpr char kThrustA1[] = "thrust_a1_N_s_per_rad";
constexpr char kTorqueD2[] = "torque_d2_N_m_s2_per_rad2";
constexpr char kTorqueD1[] = "torque_d1_N_m_s_per_rad";

// The keys of [rotor], which each table of [[rotors]] may override.
std::vector<TomlKey> rotor_keys() {
  return {{"thrust_a2", "N_s2_per_rad2"},
          {"thrust_a1", "N_s_per_rad"},
          {"torque_d2", "N_m_s2_per_rad2"},
          {"torque_d1", "N_m_s_per_rad"},
          {"Ct"},
          {"Cq"},
          {"radius", "m"},
          {"chord", "m"},
          {"blades"},
          {"inertia", "kg_m2"},
          {"lag", "s"},
          {"lag_up", "s"},
          {"lag_down", "s"},
          {"drag", "N_s2_per_rad_m"},
          {"inflow", "N_s2_per_rad_m"},
          {"flapping", "N_s2_per_rad"},
          {"ground_effect"}};
}

// Rejects tables that contain both of two alternative keys.
void require_one_of(const TomlTable& table, const std::string& a, const std::string& b) {
  if (table.has(a) && table.has(b))
    throw InvalidInput(table.where(b), fmt::format("{} has both '{}' and '{}', expected one of "
                                                   "them because each defines the whole curve",
                                                   table.title(), a, b));
}

constexpr Range kLag = {0, Range::Bound::closed, kMaxLag, Range::Bound::closed};

// lag_s sets both lag_up_s and lag_down_s.
void read_lag(const TomlTable& table, Rotor& rotor) {
  for (const char* one : {"lag_up_s", "lag_down_s"})
    if (table.has("lag_s") && table.has(one))
      throw InvalidInput(table.where(one),
                         fmt::format("{} has both 'lag_s' and '{}', expected lag_s for both "
                                     "directions or lag_up_s and lag_down_s",
                                     table.title(), one));
  if (table.has("lag_s")) {
    rotor.lag = table.number("lag_s", kLag);
    rotor.lag_down = kNaN;
  }
  if (!table.has("lag_up_s") && !table.has("lag_down_s")) return;
  const double down = lag_down(rotor);
  rotor.lag = table.number_or("lag_up_s", rotor.lag, kLag);
  rotor.lag_down = table.number_or("lag_down_s", down, kLag);
}

// Aerodynamic coefficients of a moving rotor.
void read_airflow(const TomlTable& table, Rotor& rotor) {
  rotor.drag = table.number_or("drag_N_s2_per_rad_m", rotor.drag, Range::not_negative());
  rotor.inflow = table.number_or("inflow_N_s2_per_rad_m", rotor.inflow, Range::not_negative());
  rotor.flapping = table.number_or("flapping_N_s2_per_rad", rotor.flapping, Range::not_negative());
  if (table.has("ground_effect")) rotor.ground_effect = table.truth("ground_effect");
}

// Overrides the values of a rotor with those in `table`.
void read_rotor(const TomlTable& table, Rotor& rotor) {
  for (const char* curve : {kThrustA2, kThrustA1}) require_one_of(table, "Ct", curve);
  for (const char* curve : {kTorqueD2, kTorqueD1}) require_one_of(table, "Cq", curve);
  if (table.has("Ct")) rotor.Ct = table.number("Ct", Range::positive());
  if (table.has("Cq")) rotor.Cq = table.number("Cq", Range::not_negative());
  if (table.has(kThrustA2) || table.has(kThrustA1)) {
    rotor.Ct = kNaN;
    rotor.thrust_a2 = table.number(kThrustA2, Range::positive());
    rotor.thrust_a1 = table.number_or(kThrustA1, 0);
  }
  if (table.has(kTorqueD2) || table.has(kTorqueD1)) {
    rotor.Cq = kNaN;
    rotor.torque_d2 = table.number(kTorqueD2, Range::not_negative());
    rotor.torque_d1 = table.number_or(kTorqueD1, 0);
  }
  rotor.radius = table.number_or("radius_m", rotor.radius, Range::positive());
  rotor.chord = table.number_or("chord_m", rotor.chord, Range::positive());
  if (table.has("blades")) rotor.blades = table.integer("blades", 1, 100);
  rotor.inertia = table.number_or("inertia_kg_m2", rotor.inertia, Range::not_negative());
  read_lag(table, rotor);
  read_airflow(table, rotor);
}

// T = Ct ρ π r⁴ w² and Q = Cq ρ π r⁵ w² if coefficients are given.
void complete_curves(Rotor& rotor, double air_density, const TomlTable& table) {
  const bool coefficients = !std::isnan(rotor.Ct) || !std::isnan(rotor.Cq);
  if (coefficients && std::isnan(rotor.radius))
    throw InvalidInput(table.where(), table.title() +
                                          " has Ct or Cq but no radius_m, expected "
                                          "the radius, which converts them to a curve");
  const double disc = air_density * std::numbers::pi * rotor.radius * rotor.radius;  // ρ π r²
  if (!std::isnan(rotor.Ct)) {
    rotor.thrust_a2 = rotor.Ct * disc * rotor.radius * rotor.radius;
    rotor.thrust_a1 = 0;
  }
  if (!std::isnan(rotor.Cq)) {
    rotor.torque_d2 = rotor.Cq * disc * rotor.radius * rotor.radius * rotor.radius;
    rotor.torque_d1 = 0;
  }
  const auto require = [&](double coefficient, const char* curve, const char* key,
                           const char* other) {
    if (!std::isnan(coefficient)) return;
    throw InvalidInput(table.where(),
                       fmt::format("{} has no {} curve, expected {} or {} with radius_m, here or "
                                   "in [rotor]",
                                   table.title(), curve, key, other));
  };
  require(rotor.thrust_a2, "thrust", kThrustA2, "Ct");
  require(rotor.torque_d2, "torque", kTorqueD2, "Cq");
}

Spin read_spin(const TomlTable& table) {
  const std::string word = table.text("spin");
  if (word == "cw") return Spin::clockwise;
  if (word == "ccw") return Spin::counter_clockwise;
  throw InvalidInput(table.where("spin"),
                     fmt::format("spin in {} is '{}', expected 'cw' (clockwise seen from above) or "
                                 "'ccw'",
                                 table.title(), internal::printable(word)));
}

std::vector<Rotor> read_rotors(const TomlTable& file, double air_density) {
  Rotor shared;
  shared.thrust_a2 = kNaN;  // until a curve or a coefficient is read
  shared.torque_d2 = kNaN;
  if (const auto table = file.maybe_table("rotor")) {
    table->allow(rotor_keys());
    read_rotor(*table, shared);
  }
  std::vector<Rotor> rotors;
  for (const TomlTable& table : file.tables("rotors")) {
    std::vector<TomlKey> keys = rotor_keys();
    keys.insert(keys.begin(), {{"position", "m"}, {"spin"}});
    table.allow(keys);
    Rotor rotor = shared;
    rotor.position = table.vector3("position_m");
    rotor.spin = read_spin(table);
    read_rotor(table, rotor);
    complete_curves(rotor, air_density, table);
    if (rotor.ground_effect && std::isnan(rotor.radius))
      throw InvalidInput(table.where(), table.title() +
                                            " has ground_effect but no radius_m, expected the "
                                            "radius, with which the effect scales");
    rotors.push_back(rotor);
  }
  if (rotors.empty())
    throw InvalidInput(file.where("rotors"),
                       "the file has no [[rotors]], expected one for each rotor, at least one");
  return rotors;
}

// [[body.geometry.spheres]] and [[body.geometry.points]].
std::vector<Sphere> read_parts(const TomlTable& geometry) {
  geometry.allow({{"spheres"}, {"points"}});
  std::vector<Sphere> parts;
  for (const TomlTable& table : geometry.tables("spheres")) {
    table.allow({{"mass", "kg"}, {"radius", "m"}, {"position", "m"}});
    Sphere part{table.number("mass_kg", Range::positive()),
                table.number("radius_m", Range::positive())};
    if (table.has("position_m")) part.position = table.vector3("position_m");
    parts.push_back(part);
  }
  for (const TomlTable& table : geometry.tables("points")) {
    table.allow({{"mass", "kg"}, {"position", "m"}});
    parts.push_back({table.number("mass_kg", Range::positive()), 0, table.vector3("position_m")});
  }
  if (parts.empty())
    throw InvalidInput(geometry.where(), geometry.title() +
                                             " has no parts, expected spheres or points that form "
                                             "the body");
  return parts;
}

void read_geometry(const TomlTable& geometry, const TomlTable& body, Vehicle& vehicle) {
  for (const char* key : {"inertia_kg_m2", "inertia_tolerance"})
    if (body.has(key))
      throw InvalidInput(body.where(key), fmt::format("[body] has both {} and a geometry, expected "
                                                      "one of them",
                                                      key));
  const MassProperties whole = mass_properties(read_parts(geometry));
  vehicle.mass = body.number_or("mass_kg", whole.mass, Range::positive());
  if (std::abs(vehicle.mass - whole.mass) > 1e-6 * whole.mass)
    throw InvalidInput(
        body.where("mass_kg"),
        fmt::format("mass_kg in [body] is {} but the total mass of the parts of {} is {} kg, "
                    "expected the same or no mass_kg",
                    vehicle.mass, geometry.title(), whole.mass));
  const Eigen::Vector3d& centre = whole.centre_of_mass;
  if (centre.norm() > 1e-6)
    throw InvalidInput(geometry.where(),
                       fmt::format("the parts of {} have their centre of mass at [{:.6g}, {:.6g}, "
                                   "{:.6g}] m, expected [0, 0, 0], the origin of the body "
                                   "axes",
                                   geometry.title(), centre.x(), centre.y(), centre.z()));
  vehicle.inertia = whole.inertia;
}

Eigen::Matrix3d read_inertia(const TomlTable& body) {
  if (!body.is_list_of_lists("inertia_kg_m2")) return body.vector3("inertia_kg_m2").asDiagonal();
  const Eigen::MatrixXd J = body.matrix("inertia_kg_m2");
  if (J.rows() != 3 || J.cols() != 3)
    throw InvalidInput(body.where("inertia_kg_m2"),
                       fmt::format("inertia_kg_m2 in [body] is {}x{}, expected 3x3 or 3 numbers "
                                   "(Ixx, Iyy, Izz)",
                                   J.rows(), J.cols()));
  return J;
}

void read_body(const TomlTable& body, Vehicle& vehicle) {
  body.allow({{"mass", "kg"},
              {"inertia", "kg_m2"},
              {"inertia_tolerance"},
              {"geometry"},
              {"height", "m"},
              {"diameter", "m"},
              {"drag_area", "m2"},
              {"drag_linear", "N_s_per_m"}});
  if (const auto geometry = body.maybe_table("geometry")) {
    read_geometry(*geometry, body, vehicle);
    require_inertia(vehicle.inertia, body.where("geometry"));
  } else {
    vehicle.mass = body.number("mass_kg", Range::positive());
    vehicle.inertia = read_inertia(body);
    vehicle.inertia_tolerance = body.number_or(
        "inertia_tolerance", 0, {0, Range::Bound::closed, 0.05, Range::Bound::closed});
    require_inertia(vehicle.inertia, body.where("inertia_kg_m2"), vehicle.inertia_tolerance);
  }
  vehicle.airframe_height = body.number_or("height_m", kNaN);
  vehicle.airframe_diameter = body.number_or("diameter_m", kNaN, Range::positive());
  if (body.has("drag_area_m2"))
    vehicle.drag.cda = body.vector3("drag_area_m2", Range::not_negative());
  if (body.has("drag_linear_N_s_per_m"))
    vehicle.drag.linear = body.vector3("drag_linear_N_s_per_m", Range::not_negative());
}

std::vector<int> read_directions(const TomlTable& table, std::size_t rotors) {
  std::vector<int> directions;
  const Eigen::VectorXd values = table.vector("direction");
  for (const double value : values) {
    if (std::abs(value) != 1)
      throw InvalidInput(table.where("direction"),
                         fmt::format("direction in [motor] has {}, expected 1 or -1", value));
    directions.push_back(value > 0 ? 1 : -1);
  }
  if (directions.size() != rotors)
    throw InvalidInput(
        table.where("direction"),
        fmt::format("direction in [motor] has {}, expected {}, one per rotor",
                    internal::counted(directions.size(), "entry", "entries"), rotors));
  return directions;
}

// command = "speed" has limits in rad/s; command = "speed-squared" has limits and gain in counts.
MotorCommand read_motor(const TomlTable& table, std::size_t rotors) {
  MotorCommand motor;
  const std::string law = table.text("command");
  const bool squared = law == to_string(CommandLaw::speed_squared);
  if (!squared && law != to_string(CommandLaw::speed))
    throw InvalidInput(
        table.where("command"),
        fmt::format("command in [motor] is '{}', expected 'speed' or 'speed-squared'{}",
                    internal::printable(law), internal::did_you_mean(law, {"speed-squared"})));
  const std::string unit = squared ? "count" : "rad_s";
  std::vector<TomlKey> keys = {
      {"command"},   {"min", unit},          {"max", unit},          {"quantum", unit},
      {"direction"}, {"command_delay", "s"}, {"command_jitter", "s"}};
  if (squared) keys.push_back({"gain", "rad2_per_s2_per_count"});
  table.allow(keys);
  motor.law = squared ? CommandLaw::speed_squared : CommandLaw::speed;
  motor.unit = squared ? "count" : "rad/s";
  if (squared) motor.gain = table.number("gain_rad2_per_s2_per_count", Range::positive());
  motor.min = table.number("min_" + unit, Range::not_negative());
  motor.max = table.number("max_" + unit, Range::positive());
  if (motor.min >= motor.max)
    throw InvalidInput(table.where("max_" + unit),
                       fmt::format("max_{0} in [motor] is {1}, expected more than min_{0}, {2}",
                                   unit, motor.max, motor.min));
  motor.quantum = table.number_or("quantum_" + unit, 0, Range::not_negative());
  constexpr Range kDelay = {0, Range::Bound::closed, kMaxCommandDelay, Range::Bound::closed};
  motor.delay = table.number_or("command_delay_s", 0, kDelay);
  motor.delay_jitter = table.number_or("command_jitter_s", 0, kDelay);
  motor.direction =
      table.has("direction") ? read_directions(table, rotors) : std::vector<int>(rotors, 1);
  return motor;
}

}  // namespace

Vehicle parse_vehicle(const std::string& text, const std::string& origin) {
  const TomlTable file = TomlTable::parse(text, origin);
  file.allow({{"name"},
              {"description"},
              {"source"},
              {"environment"},
              {"body"},
              {"rotor"},
              {"rotors"},
              {"motor"},
              {"flight"},
              {"sensors"},
              {"battery"},
              {"spread"},
              {"published_cascade"}});
  Vehicle vehicle;
  vehicle.text = text;
  vehicle.name = file.word("name");
  vehicle.description = file.text_or("description", "");
  vehicle.source = file.text_or("source", "");
  if (const auto table = file.maybe_table("environment")) {
    table->allow({{"gravity", "m_per_s2"}, {"air_density", "kg_per_m3"}});
    vehicle.gravity = table->number_or("gravity_m_per_s2", vehicle.gravity, Range::positive());
    vehicle.air_density =
        table->number_or("air_density_kg_per_m3", vehicle.air_density, Range::positive());
  }
  read_body(file.table("body"), vehicle);
  vehicle.rotors = read_rotors(file, vehicle.air_density);
  vehicle.motor = read_motor(file.table("motor"), vehicle.rotors.size());
  if (const auto table = file.maybe_table("flight")) {
    table->allow({{"takeoff_gain"}, {"altitude_thrust_fraction"}});
    vehicle.takeoff_gain = table->number_or("takeoff_gain", 0, Range::not_negative());
    vehicle.altitude_thrust_fraction = table->number_or(
        "altitude_thrust_fraction", 1, {0, Range::Bound::open, 1, Range::Bound::closed});
  }
  if (const auto table = file.maybe_table("sensors")) {
    vehicle.sensors = internal::read_sensors(*table);
    vehicle.sensors_known = true;
  }
  if (const auto table = file.maybe_table("battery"))
    vehicle.battery = internal::read_battery(*table);
  if (const auto table = file.maybe_table("spread")) (void)internal::read_spread(*table);
  if (const auto table = file.maybe_table("published_cascade")) {
    std::vector<TomlKey> keys = internal::cascade_gain_keys();
    keys.push_back({"source"});
    table->allow(keys);
    vehicle.published_cascade = {table->text("source"), internal::read_cascade_gains(*table)};
  }
  validate(vehicle, file.where("rotors"));  // the remaining checks concern the rotors
  return vehicle;
}

std::vector<std::string> built_in_vehicles() {
  std::vector<std::string> names;
  for (const internal::BuiltInFile& file : internal::built_in_vehicle_files())
    names.push_back(file.name);
  return names;
}

Vehicle load_vehicle(const std::string& name_or_path) {
  for (const internal::BuiltInFile& file : internal::built_in_vehicle_files())
    if (file.name == name_or_path) return parse_vehicle(file.text, file.path);
  if (!internal::looks_like_path(name_or_path)) {
    const std::vector<std::string> known = built_in_vehicles();
    throw InvalidInput("vehicle",
                       fmt::format("no vehicle '{}', expected {} or a vehicle file{}",
                                   internal::printable(name_or_path), internal::joined(known, ", "),
                                   internal::did_you_mean(name_or_path, known)));
  }
  Vehicle vehicle =
      parse_vehicle(internal::read_text_file(name_or_path, kVehicleFileLimit), name_or_path);
  vehicle.file = name_or_path;
  return vehicle;
}

}  // namespace quadtune
