// SPDX-License-Identifier: Apache-2.0
#include "json/to_json.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <utility>

#include "quadtune/convention_file.hpp"
#include "quadtune/errors.hpp"
#include "quadtune/internal/json.hpp"

namespace quadtune::exports {

using internal::matrix_to_json;
using internal::number_to_json;
using internal::signals_to_json;
using internal::vector_to_json;

namespace {

// Omits an unknown number.
void add_known(Json& json, const std::string& key, double number) {
  if (!std::isnan(number)) json[key] = number_to_json(number, key);
}

// Omits a number that is the default of a missing key.
void add_unless(double if_absent, Json& json, const std::string& key, double number) {
  if (number != if_absent) json[key] = number_to_json(number, key);
}

Json rotor_to_json(const Rotor& rotor) {
  Json json;
  json["position_m"] = vector_to_json(rotor.position, "rotor.position");
  json["spin"] = to_string(rotor.spin);
  json["thrust_a2_N_s2_per_rad2"] = number_to_json(rotor.thrust_a2, "rotor.thrust_a2");
  add_unless(0, json, "thrust_a1_N_s_per_rad", rotor.thrust_a1);
  json["torque_d2_N_m_s2_per_rad2"] = number_to_json(rotor.torque_d2, "rotor.torque_d2");
  add_unless(0, json, "torque_d1_N_m_s_per_rad", rotor.torque_d1);
  add_known(json, "Ct", rotor.Ct);
  add_known(json, "Cq", rotor.Cq);
  add_known(json, "radius_m", rotor.radius);
  add_known(json, "chord_m", rotor.chord);
  if (rotor.blades > 0) json["blades"] = rotor.blades;
  add_unless(0, json, "inertia_kg_m2", rotor.inertia);
  if (lag_down(rotor) == rotor.lag) {
    add_unless(0, json, "lag_s", rotor.lag);
  } else {
    json["lag_up_s"] = number_to_json(rotor.lag, "rotor.lag_up");
    json["lag_down_s"] = number_to_json(rotor.lag_down, "rotor.lag_down");
  }
  add_unless(0, json, "drag_N_s2_per_rad_m", rotor.drag);
  add_unless(0, json, "inflow_N_s2_per_rad_m", rotor.inflow);
  add_unless(0, json, "flapping_N_s2_per_rad", rotor.flapping);
  if (rotor.ground_effect) json["ground_effect"] = true;
  return json;
}

Json motor_to_json(const MotorCommand& motor) {
  const bool squared = motor.law == CommandLaw::speed_squared;
  const std::string unit = squared ? "count" : "rad_s";
  Json json;
  json["command"] = to_string(motor.law);
  json["min_" + unit] = number_to_json(motor.min, "motor.min");
  json["max_" + unit] = number_to_json(motor.max, "motor.max");
  if (squared) json["gain_rad2_per_s2_per_count"] = number_to_json(motor.gain, "motor.gain");
  add_unless(0, json, "quantum_" + unit, motor.quantum);
  add_unless(0, json, "command_delay_s", motor.delay);
  add_unless(0, json, "command_jitter_s", motor.delay_jitter);
  const auto is_one = [](int sign) { return sign == 1; };
  if (!std::all_of(motor.direction.begin(), motor.direction.end(), is_one))
    json["direction"] = motor.direction;
  return json;
}

Json body_to_json(const Vehicle& vehicle) {
  Json json;
  json["mass_kg"] = number_to_json(vehicle.mass, "mass");
  json["inertia_kg_m2"] = matrix_to_json(vehicle.inertia, "inertia");
  add_unless(0, json, "inertia_tolerance", vehicle.inertia_tolerance);
  add_known(json, "height_m", vehicle.airframe_height);
  add_known(json, "diameter_m", vehicle.airframe_diameter);
  if (!vehicle.drag.cda.isZero(0))
    json["drag_area_m2"] = vector_to_json(vehicle.drag.cda, "drag_area");
  if (!vehicle.drag.linear.isZero(0))
    json["drag_linear_N_s_per_m"] = vector_to_json(vehicle.drag.linear, "drag_linear");
  return json;
}

std::string law_text(const Gains& gains) {
  const std::string text = gains.sign_law == SignLaw::set_point_minus_state
                               ? "u = u0 + K (x_sp - x) + K_int integral(x_sp - x)"
                               : "u = u0 + K (x - x_sp) + K_int integral(x - x_sp)";
  return gains.memory ? text + " - K_lag (m - u0) - K_past (u_past - u0)" : text;
}

/// @throws InvalidInput  if the value is not a boolean
bool truth_from_json(const Json& json, const std::string& where) {
  if (!json.is_boolean())
    throw InvalidInput(where, fmt::format("is {}, expected true or false", json.type_name()));
  return json.get<bool>();
}

/// Adds the parts of a law that version 1 of the file cannot represent.
void add_dynamic_parts(Json& json, const Gains& gains) {
  json["axes"] = to_string(gains.axes);
  Json limits = Json::object();
  limits["position_error_m"] = std::isfinite(gains.limits.position_error)
                                   ? Json(gains.limits.position_error)
                                   : Json(nullptr);
  limits["conditional_integration"] = gains.limits.conditional_integration;
  json["limits"] = limits;
  if (!gains.memory) {
    json["memory"] = nullptr;
    return;
  }
  Json& memory = json["memory"];
  memory["actuators"] = "m[k+1] = m[k] + (1 - exp(-dt/lag)) (u[k - past] - m[k])";
  memory["lag_s"] = vector_to_json(gains.memory->lag, "lag");
  memory["K_lag"] = matrix_to_json(gains.memory->K_lag, "K_lag");
  memory["past"] = gains.memory->past;
  memory["K_past"] = matrix_to_json(gains.memory->K_past, "K_past");
}

void read_dynamic_parts(const Json& json, const std::string& where, Gains& gains) {
  using internal::member;
  const std::string limits_at = where + ".limits", memory_at = where + ".memory";
  gains.axes = position_axes(
      internal::string_from_json(member(json, "axes", where), where + ".axes"), where + ".axes");
  const Json& limits = member(json, "limits", where);
  const Json& position_error = member(limits, "position_error_m", limits_at);
  if (!position_error.is_null())
    gains.limits.position_error =
        internal::number_from_json(position_error, limits_at + ".position_error_m");
  gains.limits.conditional_integration = truth_from_json(
      member(limits, "conditional_integration", limits_at), limits_at + ".conditional_integration");
  const Json& memory = member(json, "memory", where);
  if (memory.is_null()) return;
  const auto at = [&](const char* key) -> const Json& { return member(memory, key, memory_at); };
  CommandMemory read;
  read.lag = internal::vector_from_json(at("lag_s"), memory_at + ".lag_s");
  read.K_lag = internal::matrix_from_json(at("K_lag"), memory_at + ".K_lag");
  const double past = internal::number_from_json(at("past"), memory_at + ".past");
  if (past != std::floor(past) || past < 0 || past > kMaxPastCommands)
    throw InvalidInput(memory_at + ".past", fmt::format("is {}, expected a whole number from 0 to "
                                                        "{}",
                                                        past, kMaxPastCommands));
  read.past = static_cast<int>(past);
  read.K_past = internal::matrix_from_json(at("K_past"), memory_at + ".K_past");
  if (read.past == 0 && read.K_past.size() == 0) read.K_past.resize(gains.K.rows(), 0);
  gains.memory = std::move(read);
}

/// The name of the convention. If the JSON contains a definition, the convention is registered, so
/// that convention() finds it by this name.
std::string convention_from_json(const Json& json, const std::string& where) {
  const auto text = [&](const char* key) {
    return internal::string_from_json(internal::member(json, key, where), where + "." + key);
  };
  const std::string name = text("name"), definition_at = where + ".definition";
  if (!json.contains("definition")) return convention(name, where + ".name").name;
  const Convention defined = parse_convention(text("definition"), definition_at);
  if (defined.name != name)
    throw InvalidInput(definition_at,
                       fmt::format("defines '{}', expected '{}', the name", defined.name, name));
  return add_convention(defined, definition_at).name;
}

}  // namespace

Json gains_to_json(const Gains& gains, int version) {
  validate(gains, "json");
  const Convention& c = convention(gains.convention, "json");
  Json json;
  json["vehicle"] = gains.vehicle;
  json["convention"] = {{"name", c.name}, {"description", c.description}};
  if (!is_built_in(c)) json["convention"]["definition"] = convention_text(c);
  json["sign_law"] = to_string(gains.sign_law);
  json["law"] = law_text(gains);
  json["input_kind"] = to_string(gains.input_kind);
  json["dt_s"] = gains.dt;
  json["states"] = signals_to_json(gains.states);
  json["inputs"] = signals_to_json(gains.inputs);
  json["integrals"] = signals_to_json(gains.integrals);
  json["x0"] = vector_to_json(gains.x0, "x0");
  json["u0"] = vector_to_json(gains.u0, "u0");
  json["K"] = matrix_to_json(gains.K, "K");
  json["K_int"] = matrix_to_json(gains.K_int, "K_int");
  if (version >= 2) add_dynamic_parts(json, gains);
  return json;
}

bool has_dynamic_parts(const Gains& gains) {
  return gains.memory || gains.axes != PositionAxes::world || gains.limits != FeedbackLimits{};
}

Gains gains_from_json(const Json& json, const std::string& where, int version) {
  using internal::member;
  const auto path = [&](const char* key) { return where + "." + key; };
  const auto at = [&](const char* key) -> const Json& { return member(json, key, where); };
  const auto text = [&](const char* key) { return internal::string_from_json(at(key), path(key)); };
  Gains gains;
  gains.vehicle = text("vehicle");
  gains.convention = convention_from_json(at("convention"), path("convention"));
  gains.sign_law = sign_law(text("sign_law"), path("sign_law"));
  gains.input_kind = input_kind(text("input_kind"), path("input_kind"));
  gains.dt = internal::number_from_json(at("dt_s"), path("dt_s"));
  gains.states = internal::signals_from_json(at("states"), path("states"));
  gains.inputs = internal::signals_from_json(at("inputs"), path("inputs"));
  gains.integrals = internal::signals_from_json(at("integrals"), path("integrals"));
  gains.x0 = internal::vector_from_json(at("x0"), path("x0"));
  gains.u0 = internal::vector_from_json(at("u0"), path("u0"));
  gains.K = internal::matrix_from_json(at("K"), path("K"));
  gains.K_int = internal::matrix_from_json(at("K_int"), path("K_int"));
  if (gains.integrals.empty() && gains.K_int.size() == 0) gains.K_int.resize(gains.K.rows(), 0);
  if (version >= 2) {
    read_dynamic_parts(json, where, gains);
  } else {
    for (const char* key : {"axes", "limits", "memory"})
      if (json.contains(key))
        throw InvalidInput(path(key),
                           "requires version 2 of the file, because version 1 "
                           "cannot represent it");
  }
  // Derived from other members, for human readers: it must not contradict them.
  if (json.contains("law") && text("law") != law_text(gains))
    throw InvalidInput(path("law"),
                       fmt::format("is '{}', expected '{}' because sign_law is {}", text("law"),
                                   law_text(gains), to_string(gains.sign_law)));
  validate(gains, where);
  return gains;
}

void add_weights(Json& json, const Eigen::MatrixXd& Q, const Eigen::MatrixXd& R) {
  if (Q.size() > 0) json["weights"]["Q"] = matrix_to_json(Q, "Q");
  if (R.size() > 0) json["weights"]["R"] = matrix_to_json(R, "R");
}

std::pair<Eigen::MatrixXd, Eigen::MatrixXd> weights_from_json(const Json& json,
                                                              const std::string& origin) {
  std::pair<Eigen::MatrixXd, Eigen::MatrixXd> weights;
  if (!json.contains("weights")) return weights;
  const Json& table = json["weights"];
  const std::string where = origin + ": weights";
  if (!table.is_object()) throw InvalidInput(where, "is not an object; expected Q and R");
  if (table.contains("Q")) weights.first = internal::matrix_from_json(table["Q"], where + ".Q");
  if (table.contains("R")) weights.second = internal::matrix_from_json(table["R"], where + ".R");
  return weights;
}

Json vehicle_to_json(const Vehicle& vehicle) {
  Json json;
  json["name"] = vehicle.name;
  if (!vehicle.description.empty()) json["description"] = vehicle.description;
  if (!vehicle.source.empty()) json["source"] = vehicle.source;
  json["environment"]["gravity_m_per_s2"] = number_to_json(vehicle.gravity, "gravity");
  json["environment"]["air_density_kg_per_m3"] = number_to_json(vehicle.air_density, "air_density");
  json["body"] = body_to_json(vehicle);
  json["motor"] = motor_to_json(vehicle.motor);
  json["rotors"] = Json::array();
  for (const Rotor& rotor : vehicle.rotors) json["rotors"].push_back(rotor_to_json(rotor));
  Json flight = Json::object();
  add_unless(0, flight, "takeoff_gain", vehicle.takeoff_gain);
  add_unless(1, flight, "altitude_thrust_fraction", vehicle.altitude_thrust_fraction);
  if (!flight.empty()) json["flight"] = flight;
  if (vehicle.sensors_known) json["sensors"] = sensors_to_json(vehicle.sensors);
  if (vehicle.battery) json["battery"] = battery_to_json(*vehicle.battery);
  if (vehicle.published_cascade) {
    Json& published = json["published_cascade"];
    published["source"] = vehicle.published_cascade->source;
    published["dt_s"] = number_to_json(vehicle.published_cascade->gains.dt, "published_cascade.dt");
    for (const PidLoop& loop : vehicle.published_cascade->gains.loops) {
      Json& table = published[loop.name];
      table["Kp"] = number_to_json(loop.Kp, loop.name);
      add_unless(0, table, "Ki", loop.Ki);
      add_unless(0, table, "Kd", loop.Kd);
      add_unless(0, table, "rate_lead_s", loop.rate_lead);
      add_unless(0, table, "rate_filter_s", loop.rate_filter);
    }
  }
  return json;
}

Json cascade_to_json(const CascadeDesign& cascade) {
  Json json;
  json["dt_s"] = number_to_json(cascade.gains.dt, "cascade.dt");
  json["integrator"] = to_string(cascade.method);
  const auto number = [](const char* key, double value) {
    return number_to_json(value, std::string("cascade.") + key);
  };
  const auto limit = [&](const char* key, double value) {  // null: no limit
    json[key] = std::isinf(value) ? Json(nullptr) : number(key, value);
  };
  limit("attitude_limit_rad", cascade.attitude_limit);
  limit("integrator_limit", cascade.integrator_limit);
  json["back_calculation_per_s"] = number("back_calculation_per_s", cascade.back_calculation);
  json["takeoff_time_s"] = number("takeoff_time_s", cascade.takeoff_time);
  json["velocity_feed_forward"] = cascade.velocity_feed_forward;
  json["conditional_integration"] = cascade.conditional_integration;
  json["loops"] = Json::array();
  for (const PidLoop& loop : cascade.gains.loops) {
    const auto gain = [&](const char* key, double value) {
      return number_to_json(value, "cascade." + loop.name + "." + key);
    };
    json["loops"].push_back({{"name", loop.name},
                             {"output", loop.output},
                             {"unit", loop.unit},
                             {"Kp", gain("Kp", loop.Kp)},
                             {"Ki", gain("Ki", loop.Ki)},
                             {"Kd", gain("Kd", loop.Kd)}});
    if (loop.rate_lead == 0) continue;
    json["loops"].back()["rate_lead_s"] = gain("rate_lead_s", loop.rate_lead);
    json["loops"].back()["rate_filter_s"] = gain("rate_filter_s", loop.rate_filter);
  }
  return json;
}

CascadeDesign cascade_from_json(const Json& json, const std::string& where, int version) {
  using internal::member;
  CascadeDesign cascade;
  const auto absent = [&](const char* key) {
    if (version >= 2) (void)member(json, key, where);
    return !json.contains(key);
  };
  const auto number = [&](const char* key, double if_absent, bool zero) {
    const bool unlimited = std::isinf(if_absent);
    if (absent(key) || (unlimited && json[key].is_null())) return if_absent;
    const std::string here = where + "." + key;
    const double value = internal::number_from_json(json[key], here);
    if (value < 0 || (value == 0 && !zero))
      throw InvalidInput(
          here, fmt::format("is {}, expected {}", value, zero ? "0 or more" : "more than 0"));
    return value;
  };
  cascade.gains.dt = internal::number_from_json(member(json, "dt_s", where), where + ".dt_s");
  if (!(cascade.gains.dt > 0))
    throw InvalidInput(where + ".dt_s",
                       fmt::format("is {} s, expected more than 0", cascade.gains.dt));
  if (!absent("integrator"))
    cascade.method =
        pid_method(internal::string_from_json(json["integrator"], where + ".integrator"),
                   where + ".integrator");
  cascade.attitude_limit = number("attitude_limit_rad", cascade.attitude_limit, false);
  cascade.integrator_limit = number("integrator_limit", cascade.integrator_limit, false);
  cascade.back_calculation = number("back_calculation_per_s", 0, true);
  cascade.takeoff_time = number("takeoff_time_s", 0, true);
  const auto truth = [&](const char* key) {
    return !absent(key) && truth_from_json(json[key], where + "." + key);
  };
  cascade.velocity_feed_forward = truth("velocity_feed_forward");
  cascade.conditional_integration = truth("conditional_integration");
  const Json& loops = member(json, "loops", where);
  if (!loops.is_array())
    throw InvalidInput(where + ".loops", fmt::format("is {}, expected a list", loops.type_name()));
  std::array<bool, kCascadeAxes> came{};
  for (const CascadeAxis axis : kAllCascadeAxes) cascade.gains.loops.push_back(cascade_loop(axis));
  for (std::size_t i = 0; i < loops.size(); ++i) {
    const std::string here = fmt::format("{}.loops[{}]", where, i);
    const CascadeAxis axis = cascade_axis(
        internal::string_from_json(member(loops[i], "name", here), here + ".name"), here + ".name");
    if (std::exchange(came[index_of(axis)], true))
      throw InvalidInput(here + ".name", "repeats a loop; expected each loop once");
    PidLoop& loop = cascade.gains.loops[index_of(axis)];
    for (const auto& [key, gain] : {std::pair("Kp", &PidLoop::Kp), std::pair("Ki", &PidLoop::Ki),
                                    std::pair("Kd", &PidLoop::Kd)})
      loop.*gain = internal::number_from_json(member(loops[i], key, here), here + "." + key);
    for (const auto& [key, time] : {std::pair("rate_lead_s", &PidLoop::rate_lead),
                                    std::pair("rate_filter_s", &PidLoop::rate_filter)}) {
      if (!loops[i].contains(key)) continue;
      loop.*time = internal::number_from_json(loops[i][key], here + "." + key);
      if (loop.*time < 0)
        throw InvalidInput(here + "." + key,
                           fmt::format("is {} s, expected 0 or more", loop.*time));
    }
  }
  for (const CascadeAxis axis : kAllCascadeAxes)
    if (!came[index_of(axis)])
      throw InvalidInput(where + ".loops",
                         fmt::format("has no loop '{}', expected all six", to_string(axis)));
  return cascade;
}

namespace {

Json parsed(const std::string& text, const std::string& origin) {
  try {
    return Json::parse(text);
  } catch (const internal::JsonError& error) {
    if (error.out_of_range())  // 1e999
      throw InvalidInput(origin,
                         "has a number beyond the range of a double, expected at most "
                         "1.8e308");
    if (error.byte() == 0) throw InvalidInput(origin, error.what());
    // The library counts from 1, and one more at the end of the text.
    const std::size_t at = std::min(error.byte() - 1, text.size());
    const auto start = text.begin();
    const auto line = 1 + std::count(start, start + static_cast<std::ptrdiff_t>(at), '\n');
    if (at == text.size())
      throw InvalidInput(fmt::format("{}:{}", origin, line),
                         "ends within a JSON value, expected a complete JSON object; is the file "
                         "cut short?");
    const std::size_t before = at == 0 ? std::string::npos : text.rfind('\n', at - 1);
    const std::size_t column = before == std::string::npos ? at + 1 : at - before;
    const std::string rest = text.substr(at, std::min(text.find('\n', at) - at, std::size_t{20}));
    throw InvalidInput(fmt::format("{}:{}", origin, line),
                       fmt::format("is not JSON at column {}, before or at '{}'", column,
                                   internal::printable(rest)));
  }
}

std::string format_of(const Json& json, const std::string& origin) {
  return internal::string_from_json(internal::member(json, "format", origin), origin + ": format");
}

}  // namespace

std::string json_format(const std::string& text, const std::string& origin) {
  return format_of(parsed(text, origin), origin);
}

Json parse_json(const std::string& text, const std::string& origin, const std::string& format,
                int newest) {
  Json json = parsed(text, origin);
  const std::string came = format_of(json, origin);
  if (came != format)
    throw InvalidInput(origin, fmt::format("format is '{}', expected '{}'", came, format));
  const Json& version = internal::member(json, "format_version", origin);
  if (version != 1 && !(version == 2 && newest >= 2))
    throw InvalidInput(
        origin, fmt::format("format_version is {}, expected {}", internal::json_text(version),
                            newest >= 2 ? "1 or 2, which this version of quadtune knows"
                                        : "1, the only one that this version of quadtune knows"));
  return json;
}

int format_version(const Json& json) { return json["format_version"].get<int>(); }

}  // namespace quadtune::exports
