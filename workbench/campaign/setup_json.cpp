// SPDX-License-Identifier: Apache-2.0
#include "campaign/setup_json.hpp"

#include <fmt/format.h>

#include <cmath>
#include <limits>
#include <type_traits>

#include "quadtune/errors.hpp"
#include "quadtune/internal/json.hpp"

namespace quadtune::internal {
namespace {

/// JSON has no representation of numbers that are not finite; infinity means "no limit" in
/// settings.
Json number_json(double value) {
  if (std::isfinite(value)) return value;
  return std::isnan(value) ? "nan" : value > 0 ? "inf" : "-inf";
}
double number_of(const Json& json) {
  constexpr double kInfinity = std::numeric_limits<double>::infinity();
  if (!json.is_string()) return json.get<double>();
  const auto word = json.get<std::string>();
  if (word == "inf") return kInfinity;
  if (word == "-inf") return -kInfinity;
  if (word == "nan") return std::numeric_limits<double>::quiet_NaN();
  throw JsonError("no number");
}

std::string name_of(MamboPosition position) {
  return position == MamboPosition::filtered_velocity ? "filtered velocity" : "flow velocity";
}
MamboPosition mambo_position(const std::string& name, const std::string& where) {
  for (const MamboPosition position :
       {MamboPosition::filtered_velocity, MamboPosition::flow_velocity})
    if (name_of(position) == name) return position;
  throw InvalidInput(where, fmt::format("position is '{}', expected filtered velocity or flow "
                                        "velocity",
                                        name));
}

/// Archive that writes the fields passed to it.
struct Writing {
  Json& json;

  template <class Field>
  void operator()(const char* key, const Field& field) {
    if constexpr (std::is_same_v<Field, double>)
      json[key] = number_json(field);
    else if constexpr (std::is_same_v<Field, MamboPosition>)
      json[key] = name_of(field);
    else if constexpr (requires { field.size(); })
      for (Eigen::Index i = 0; i < field.size(); ++i) json[key].push_back(number_json(field(i)));
    else
      json[key] = field;
  }
};

/// Archive that reads the same fields.
struct Reading {
  const Json& json;
  const std::string& where;

  template <class Field>
  void operator()(const char* key, Field& field) {
    const Json& value = member(json, key, where);
    if constexpr (std::is_same_v<Field, double>) {
      field = number_of(value);
    } else if constexpr (std::is_same_v<Field, MamboPosition>) {
      field = mambo_position(value.get<std::string>(), where);
    } else if constexpr (requires { field.size(); }) {
      if (!value.is_array() || static_cast<Eigen::Index>(value.size()) != field.size())
        throw InvalidInput(where, fmt::format("{} is not a list of {} numbers", key, field.size()));
      for (Eigen::Index i = 0; i < field.size(); ++i)
        field(i) = number_of(value[static_cast<std::size_t>(i)]);
    } else {
      field = value.get<Field>();
    }
  }
};

template <class Settings>
Json fields_json(const Settings& settings) {
  Json json = Json::object();
  Settings::each_field(Writing{json}, settings);
  return json;
}
template <class Settings>
void read_fields(const Json& json, const char* key, const std::string& where, Settings& settings) {
  const Json& fields = member(json, key, where);
  Settings::each_field(Reading{fields, where}, settings);
}

/// Passes the plain fields of those parts of a setup that have no visitor of their own.
template <class Archive, class Part>
void each_field_of_safety(Archive&& archive, Part& safety) {
  archive("tilt", safety.tilt);
  archive("collision", safety.collision);
  archive("flow_lost_time", safety.flow_lost_time);
  archive("disagreement_time", safety.disagreement_time);
}
template <class Archive, class Part>
void each_field_of_environment(Archive&& archive, Part& environment) {
  archive("dynamic", environment.dynamic);
  archive("ground_height", environment.ground_height);
  archive("magnetic_field", environment.magnetic_field);
  archive("wind_mean", environment.wind.mean);
  archive("gust_velocity", environment.wind.gust.velocity);
  archive("gust_start", environment.wind.gust.start);
  archive("gust_length", environment.wind.gust.length);
  archive("turbulence", environment.wind.turbulence);
  archive("turbulence_height", environment.wind.turbulence_height);
}
template <class Archive, class Part>
void each_field_of_settling(Archive&& archive, Part& settling) {
  archive("band", settling.band);
  archive("yaw_band", settling.yaw_band);
  archive("window", settling.window);
  archive("settled_band", settling.settled_band);
  archive("settled_yaw_band", settling.settled_yaw_band);
}
template <class Archive, class Setup>
void each_plain_field(Archive&& archive, Setup& setup) {
  archive("real_sensors", setup.real_sensors);
  archive("flow_rate", setup.flow_rate);
  archive("step", setup.step);
  archive("duration", setup.duration);
  archive("take_off_time", setup.mission.start.take_off);
}

}  // namespace

Json setup_to_json(const FlightSetup& setup) {
  Json json = {
      {"estimator", to_string(setup.estimator)},
      {"flow", to_string(setup.flow)},
      {"allocation", to_string(setup.allocation)},
      {"integrator", to_string(setup.integrator)},
      {"take_off", setup.mission.start.take_off_by == TakeOff::climb ? "climb" : "thrust"}};
  each_plain_field(Writing{json}, setup);
  Json safety = Json::object(), environment = Json::object(), limits = Json::object();
  Json settling = Json::object();
  each_field_of_settling(Writing{settling}, setup.mission.settling);
  each_field_of_safety(Writing{safety}, setup.safety);
  each_field_of_environment(Writing{environment}, setup.environment);
  for (const Limit& limit : setup.mission.limits)
    limits[quadtune::name_of(limit.metric)] = number_json(limit.max);
  json["safety"] = safety;
  json["environment"] = environment;
  json["limits"] = limits;
  json["settling"] = settling;
  json["mambo_estimator"] = fields_json(setup.mambo_estimator);
  json["uquad_filter"] = fields_json(setup.uquad_filter);
  json["general_noise"] = fields_json(setup.general_noise);
  return json;
}

void setup_from_json(const Json& json, const std::string& where, FlightSetup& setup) {
  const auto word = [&](const char* key) { return member(json, key, where).get<std::string>(); };
  setup.estimator = estimator_kind(word("estimator"), where);
  setup.flow = flow_model(word("flow"), where);
  setup.allocation = allocation_rule(word("allocation"), where);
  setup.integrator = integrator(word("integrator"), where);
  const std::string take_off = word("take_off");
  if (take_off != "climb" && take_off != "thrust")
    throw InvalidInput(where, fmt::format("take_off is '{}', expected climb or thrust", take_off));
  setup.mission.start.take_off_by = take_off == "climb" ? TakeOff::climb : TakeOff::thrust;
  each_plain_field(Reading{json, where}, setup);
  each_field_of_safety(Reading{member(json, "safety", where), where}, setup.safety);
  each_field_of_environment(Reading{member(json, "environment", where), where}, setup.environment);
  const Json& limits = member(json, "limits", where);
  setup.mission.limits.clear();
  for (const std::string& key : limits.keys()) {
    const std::optional<Metric> metric = metric_of(key);
    if (!metric) throw InvalidInput(where, fmt::format("limits has no metric '{}'", key));
    setup.mission.limits.push_back({*metric, number_of(limits[key])});
  }
  each_field_of_settling(Reading{member(json, "settling", where), where}, setup.mission.settling);
  read_fields(json, "mambo_estimator", where, setup.mambo_estimator);
  read_fields(json, "uquad_filter", where, setup.uquad_filter);
  read_fields(json, "general_noise", where, setup.general_noise);
}

}  // namespace quadtune::internal
