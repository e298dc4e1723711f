// SPDX-License-Identifier: Apache-2.0
// The general filter's numbers as JSON, with units in the keys.
#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>

#include "json/to_json.hpp"
#include "quadtune/errors.hpp"
#include "quadtune/internal/joined.hpp"
#include "quadtune/internal/json.hpp"
#include "quadtune/internal/suggest.hpp"

namespace quadtune::exports {
namespace {

constexpr std::array<const char*, 3> kNames = {"general", "mambo", "uquad"};

/// Archive that writes the fields passed to it.
class Writing {
 public:
  Writing(Json& json, std::string where) : json_(json), where_(std::move(where)) {}

  void number(const char* key, double value) {
    json_[key] = internal::number_to_json(value, where_ + "." + key);
  }
  /// Omits a value that is not finite; the reader assumes this value if the key is missing.
  void number_unless(double /*if_absent*/, const char* key, double value) {
    if (std::isfinite(value)) number(key, value);
  }
  template <int n>
  void vector(const char* key, const Eigen::Matrix<double, n, 1>& value) {
    json_[key] = internal::vector_to_json(value, where_ + "." + key);
  }
  template <class Part, class Fields>
  void part(const char* key, const Part& value, const Fields& fields) {
    Json json = Json::object();
    Writing inner(json, where_ + "." + key);
    fields(inner, value);
    json_[key] = std::move(json);
  }
  template <class Part, class Fields>
  void part(const char* key, const std::optional<Part>& value, const Fields& fields) {
    if (value) part(key, *value, fields);
  }

 private:
  Json& json_;
  std::string where_;
};

/// Archive that reads the same fields.
class Reading {
 public:
  Reading(const Json& json, std::string where) : json_(json), where_(std::move(where)) {}

  void number(const char* key, double& value) {
    value = internal::number_from_json(internal::member(json_, key, where_), where_ + "." + key);
  }
  void number_unless(double if_absent, const char* key, double& value) {
    value = if_absent;
    if (json_.contains(key)) number(key, value);
  }
  template <int n>
  void vector(const char* key, Eigen::Matrix<double, n, 1>& value) {
    const std::string here = where_ + "." + key;
    const Eigen::VectorXd read =
        internal::vector_from_json(internal::member(json_, key, where_), here);
    if (read.size() != n)
      throw InvalidInput(here, fmt::format("has {} numbers, expected {}", read.size(), n));
    value = read;
  }
  template <class Part, class Fields>
  void part(const char* key, Part& value, const Fields& fields) {
    Reading inner(internal::member(json_, key, where_), where_ + "." + key);
    fields(inner, value);
  }
  template <class Part, class Fields>
  void part(const char* key, std::optional<Part>& value, const Fields& fields) {
    if (json_.contains(key)) part(key, value.emplace(), fields);
  }

 private:
  const Json& json_;
  std::string where_;
};

/// Passes every number of the filter to `archive`, which writes or reads it. The control period and
/// the start belong to the flight.
template <class Archive, class Settings>
void each_field(Archive& archive, Settings& settings) {
  constexpr double kInfinity = std::numeric_limits<double>::infinity();
  constexpr double kUnknown = std::numeric_limits<double>::quiet_NaN();
  archive.number("gravity_m_per_s2", settings.gravity);
  archive.part("gyroscope", settings.gyroscope, [](auto& a, auto& aid) {
    a.number("lag_s", aid.lag);
    a.vector("scale", aid.scale);
    a.vector("density_rad_per_s_per_sqrt_Hz", aid.density);
    a.vector("variance_rad2_per_s2", aid.variance);
    a.number("bias_walk_rad_per_s_per_sqrt_s", aid.walk);
  });
  archive.part("accelerometer", settings.accelerometer, [](auto& a, auto& aid) {
    a.number("lag_s", aid.lag);
    a.vector("scale", aid.scale);
    a.vector("density_m_per_s2_per_sqrt_Hz", aid.density);
    a.vector("variance_m2_per_s4", aid.variance);
    a.number("bias_walk_m_per_s2_per_sqrt_s", aid.walk);
  });
  archive.part("flow", settings.flow, [](auto& a, auto& flow) {
    a.number("lag_s", flow.lag);
    a.number("variance_rad2_per_s2", flow.variance);
    a.vector("scale", flow.scale);
    a.vector("mean_square", flow.mean_square);
    a.number("least_height_m", flow.min_height);
  });
  const auto aid_in = [](const char* variance) {
    return [variance](auto& a, auto& aid) {
      a.number("lag_s", aid.lag);
      a.number(variance, aid.variance);
      a.number("scale", aid.scale);
    };
  };
  archive.part("range", settings.range, [&](auto& a, auto& range) {
    aid_in("variance_m2")(a, range.aid);
    a.number("least_m", range.min);
    a.number_unless(kInfinity, "greatest_m", range.max);
    a.number("least_cosine_of_tilt", range.min_cosine);
  });
  archive.part("pressure", settings.pressure, [&](auto& a, auto& pressure) {
    aid_in("variance_m2")(a, pressure.aid);
    a.number("zero_Pa", pressure.zero);
    a.number_unless(kUnknown, "fall_Pa_per_m", pressure.fall);
    a.number("walk_m_per_sqrt_s", pressure.walk);
  });
  archive.part("heading", settings.heading, [&](auto& a, auto& heading) {
    aid_in("variance_rad2")(a, heading.aid);
    a.number("declination_rad", heading.declination);
    a.number("dip", heading.dip);
  });
  archive.part("gps_position", settings.gps_position, aid_in("variance_m2"));
  archive.part("gps_velocity", settings.gps_velocity, aid_in("variance_m2_per_s2"));
  archive.part("vision", settings.vision, aid_in("variance_m2"));
  archive.part("start", settings.start, [](auto& a, auto& start) {
    a.number("position_m", start.position);
    a.number("velocity_m_per_s", start.velocity);
    a.number("tilt_rad", start.tilt);
    a.number("yaw_rad", start.yaw);
    a.number("gyro_bias_rad_per_s", start.gyro_bias);
    a.number("force_bias_m_per_s2", start.force_bias);
    a.number("pressure_height_m", start.pressure_height);
  });
  archive.number("gate", settings.gate);
  archive.number("recovery_time_s", settings.recovery_time);
  archive.number("standing_velocity_m_per_s", settings.standing_velocity);
  archive.number("lift_off_velocity_m_per_s", settings.lift_off_velocity);
  archive.number("angular_acceleration_rad_per_s2", settings.angular_acceleration);
  archive.number("jerk_m_per_s3", settings.jerk);
}

/// The uquad filter's numbers that can be estimated from logs.
template <class Archive, class Settings>
void each_covariance(Archive& archive, Settings& settings) {
  archive.number("dt_s", settings.dt);
  archive.vector("Q_per_period", settings.Q);
  archive.number("R_tilt_rad2", settings.R_tilt);
  archive.number("R_yaw_rad2", settings.R_yaw);
  archive.number("R_force_m2_per_s4", settings.R_force);
  archive.number("R_rates_rad2_per_s2", settings.R_rates);
  archive.number("R_height_m2", settings.R_height);
  archive.number("R_gps_position_m2", settings.R_gps_position);
  archive.number("R_gps_velocity_m2_per_s2", settings.R_gps_velocity);
  archive.number("R_vision_m2", settings.R_vision);
}

}  // namespace

Json estimator_to_json(const StoredEstimator& estimator) {
  Json json;
  json["name"] = estimator.name;
  Writing writing(json, "estimator");
  if (estimator.uquad) each_covariance(writing, *estimator.uquad);
  if (!estimator.general) return json;
  writing.number("dt_s", estimator.general->dt);
  each_field(writing, *estimator.general);
  return json;
}

StoredEstimator estimator_from_json(const Json& json, const std::string& where) {
  StoredEstimator estimator;
  const std::string named = where + ".name";
  estimator.name = internal::string_from_json(internal::member(json, "name", where), named);
  if (std::find(kNames.begin(), kNames.end(), estimator.name) == kNames.end())
    throw InvalidInput(
        named,
        fmt::format("is '{}', expected one of {}{}", estimator.name, internal::joined(kNames, ", "),
                    internal::did_you_mean(estimator.name, {kNames.begin(), kNames.end()})));
  Reading reading(json, where);
  // Either all of its covariances or none.
  if (estimator.name == "uquad" && json.size() > 1) {
    estimator.uquad = uquad_filter_in_si<double>();
    each_covariance(reading, *estimator.uquad);
    validate(*estimator.uquad, where);
  }
  if (estimator.name != "general") return estimator;
  GeneralFilterSettings& settings = estimator.general.emplace();
  reading.number("dt_s", settings.dt);
  each_field(reading, settings);
  validate(settings, where);
  return estimator;
}

}  // namespace quadtune::exports
