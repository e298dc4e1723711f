// SPDX-License-Identifier: Apache-2.0
#include "quadtune/estimation/general_filter.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "estimation/checks.hpp"

namespace quadtune {
namespace {

/// A second-order response delays signals that are slower than it by 2 ζ/ω.
double lag_of_response(const SensorFaults& faults) {
  return faults.natural_frequency > 0 ? 2 * faults.damping / faults.natural_frequency : 0;
}

double square(double x) { return x * x; }

/// Mean variance of a sample over `axes` axes after division by its scale factor.
double variance_of(const SensorFaults& faults, int axes, double floor) {
  double sum = 0;
  for (int i = 0; i < axes; ++i)
    sum += (square(std::max(faults.noise(i), floor)) + square(faults.quantum) / 12) /
           square(faults.scale(i));
  return sum / axes;
}

InertialAid inertial(const SensorFaults& faults, double floor, double omitted, double walk,
                     double dt) {
  InertialAid aid;
  // Mean time for which a reading is repeated
  const double held = std::max(0.0, 0.5 * (1 / faults.rate - dt));
  aid.lag = faults.delay + lag_of_response(faults) + held;
  aid.scale = faults.scale;
  for (int i = 0; i < 3; ++i) {
    aid.variance(i) = (square(std::max(faults.noise(i), floor)) + square(faults.quantum) / 12) /
                      square(faults.scale(i));
    // At most one reading per control period is used.
    aid.density(i) = std::sqrt(aid.variance(i) * std::max(1 / faults.rate, dt) + square(omitted));
  }
  aid.walk = walk;
  return aid;
}

Aid aid_of(const SensorFaults& faults, int axes, double floor) {
  return {lag_of_response(faults), variance_of(faults, axes, floor),
          faults.scale.head(axes).mean()};
}

void require_aid(const Aid& aid, const std::string& name, const char* unit, double dt,
                 const std::string& where) {
  require_positive(aid.variance, (name + ".variance").c_str(), unit, where);
  require_positive(aid.scale, (name + ".scale").c_str(), "", where);
  if (!(aid.lag >= 0 && aid.lag <= kMaxHistoryPeriods * dt * (1 + 1e-9)))
    throw InvalidInput(
        where, fmt::format("{}.lag is {:.6g} s, expected 0 to {} control periods of {} s", name,
                           aid.lag, kMaxHistoryPeriods, dt));
}

void require_inertial(const InertialAid& aid, const std::string& name, double dt,
                      const std::string& where) {
  if (!(aid.lag >= 0 && aid.lag <= kMaxHorizonPeriods * dt * (1 + 1e-9)))
    throw InvalidInput(
        where, fmt::format("{}.lag is {:.6g} s, expected 0 to {} control periods of {} s", name,
                           aid.lag, kMaxHorizonPeriods, dt));
  for (int i = 0; i < 3; ++i) require_positive(aid.scale(i), (name + ".scale").c_str(), "", where);
  for (int i = 0; i < 3; ++i) {
    require_variance(aid.density(i), (name + ".density").c_str(), "", where);
    require_positive(aid.variance(i), (name + ".variance").c_str(), "", where);
  }
  require_variance(aid.walk, (name + ".walk").c_str(), "", where);
}

}  // namespace

int horizon_periods(const GeneralFilterSettings& settings) {
  const double lag = std::max(settings.gyroscope.lag, settings.accelerometer.lag);
  return static_cast<int>(std::ceil(lag / settings.dt - 1e-9));
}

std::string general_filter_lacks(const Sensors& sensors) {
  if (!sensors.accelerometer) return "no accelerometer";
  if (!sensors.gyroscope) return "no gyroscope";
  if (sensors.gps || sensors.vision) return "";
  if (!sensors.flow)
    return "no optical flow, GPS or vision, without which the horizontal velocity is not observed";
  if (!sensors.sonar && !sensors.barometer)
    return "optical flow but neither a sonar nor a barometer, without which the height is not "
           "observed";
  return "";
}

GeneralFilterSettings general_filter_settings(const Sensors& sensors, double dt, double gravity,
                                              const Eigen::Vector3d& magnetic_field,
                                              const GeneralFilterNoise& noise) {
  if (!sensors.accelerometer || !sensors.gyroscope)
    throw InvalidInput(
        "general filter",
        fmt::format("there is no {}, which is required because the filter integrates its readings",
                    sensors.gyroscope ? "accelerometer" : "gyroscope"));
  GeneralFilterSettings settings;
  settings.dt = dt;
  settings.gravity = gravity;
  settings.gyroscope =
      inertial(*sensors.gyroscope, noise.gyroscope, noise.omitted_rate, noise.gyro_walk, dt);
  settings.accelerometer = inertial(*sensors.accelerometer, noise.accelerometer,
                                    noise.omitted_acceleration, noise.force_walk, dt);
  if (sensors.flow) {
    const FlowSensor& flow = *sensors.flow;
    FlowAid aid;
    aid.lag = lag_of_response(flow.faults);
    aid.variance = variance_of(flow.faults, 2, noise.flow);
    aid.scale = flow.faults.scale.head<2>();
    aid.mean_square = {square(std::tan(flow.half_field_x)) / 3,
                       square(std::tan(flow.half_field_y)) / 3};
    aid.min_height = std::max(flow.min_height, 0.05);
    settings.flow = aid;
  }
  if (sensors.sonar)
    settings.range =
        RangeAid{aid_of(sensors.sonar->faults, 1, noise.range), sensors.sonar->min_range,
                 sensors.sonar->max_range, std::max(std::cos(sensors.sonar->max_tilt), 0.1)};
  if (sensors.barometer) {
    const BarometerSensor& barometer = *sensors.barometer;
    PressureAid aid;
    aid.aid = aid_of(barometer.faults, 1, noise.pressure);
    aid.zero = barometer.ground_pressure;
    aid.fall = barometer.fall;
    aid.walk = noise.pressure_walk;
    aid.aid.variance /= square(aid.slope());
    settings.pressure = aid;
  }
  const double level = magnetic_field.head<2>().norm();
  if (sensors.magnetometer && level > 1e-3 * magnetic_field.norm()) {
    HeadingAid aid;
    aid.aid = aid_of(*sensors.magnetometer, 3, noise.field);
    aid.aid.variance /= square(level);
    aid.declination = std::atan2(magnetic_field.y(), magnetic_field.x());
    aid.dip = magnetic_field.z() / level;
    settings.heading = aid;
  }
  if (sensors.gps) {
    settings.gps_position = aid_of(sensors.gps->position, 3, noise.gps_position);
    SensorFaults velocity;
    velocity.noise = sensors.gps->velocity_noise;
    settings.gps_velocity = aid_of(velocity, 3, noise.gps_velocity);
  }
  if (sensors.vision) settings.vision = aid_of(*sensors.vision, 3, noise.vision);
  return settings;
}

void validate(const GeneralFilterSettings& settings, const std::string& where) {
  require_positive(settings.dt, "dt", " s", where);
  require_positive(settings.gravity, "gravity", " m/s2", where);
  require_inertial(settings.gyroscope, "gyroscope", settings.dt, where);
  require_inertial(settings.accelerometer, "accelerometer", settings.dt, where);
  if (settings.flow) {
    const FlowAid& flow = *settings.flow;
    require_aid({flow.lag, flow.variance, flow.scale.minCoeff()}, "flow", " rad2/s2", settings.dt,
                where);
    require_positive(flow.scale.maxCoeff(), "flow.scale", "", where);
    require_positive(flow.min_height, "flow.least_height", " m", where);
    for (int i = 0; i < 2; ++i)
      require_variance(flow.mean_square(i), "flow.mean_square", "", where);
  }
  if (settings.range) {
    const RangeAid& range = *settings.range;
    require_aid(range.aid, "range", " m2", settings.dt, where);
    if (!(range.min >= 0 && range.min < range.max))
      throw InvalidInput(where,
                         fmt::format("range.least is {} m and range.greatest is {} m, expected "
                                     "0 <= range.least < range.greatest",
                                     range.min, range.max));
    if (!(range.min_cosine > 0 && range.min_cosine <= 1))
      throw InvalidInput(where, fmt::format("range.least_cosine is {}, expected more than 0 and at "
                                            "most 1",
                                            range.min_cosine));
  }
  if (settings.pressure) {
    require_aid(settings.pressure->aid, "pressure", " m2", settings.dt, where);
    require_positive(settings.pressure->zero, "pressure.zero", " Pa", where);
    require_variance(settings.pressure->walk, "pressure.walk", " m/s^0.5", where);
    if (settings.pressure->fall >= 0 || std::isinf(settings.pressure->fall))
      throw InvalidInput(where, fmt::format("pressure.fall is {} Pa/m, expected a negative number "
                                            "because pressure falls with height",
                                            settings.pressure->fall));
  }
  if (settings.heading) {
    require_aid(settings.heading->aid, "heading", " rad2", settings.dt, where);
    if (!std::isfinite(settings.heading->declination))
      throw InvalidInput(where, fmt::format("heading.declination is {} rad, expected a finite "
                                            "number",
                                            settings.heading->declination));
  }
  if (settings.gps_position)
    require_aid(*settings.gps_position, "gps_position", " m2", settings.dt, where);
  if (settings.gps_velocity)
    require_aid(*settings.gps_velocity, "gps_velocity", " m2/s2", settings.dt, where);
  if (settings.vision) require_aid(*settings.vision, "vision", " m2", settings.dt, where);
  const StartDeviations& s = settings.start;
  for (const auto& [value, name, unit] : {std::tuple(s.position, "start.position", " m"),
                                          {s.velocity, "start.velocity", " m/s"},
                                          {s.tilt, "start.tilt", " rad"},
                                          {s.yaw, "start.yaw", " rad"},
                                          {s.gyro_bias, "start.gyro_bias", " rad/s"},
                                          {s.force_bias, "start.force_bias", " m/s2"},
                                          {s.pressure_height, "start.pressure_height", " m"}})
    if (!(value >= 0) || !std::isfinite(value))
      throw InvalidInput(
          where, fmt::format("{} is {}{}, expected 0 or more and finite", name, value, unit));
  require_positive(settings.gate, "gate", "", where);
  require_not_negative(settings.recovery_time, "recovery_time", " s", where);
  require_positive(settings.standing_velocity, "standing_velocity", " m/s", where);
  require_not_negative(settings.lift_off_velocity, "lift_off_velocity", " m/s", where);
  require_not_negative(settings.angular_acceleration, "angular_acceleration", " rad/s2", where);
  require_not_negative(settings.jerk, "jerk", " m/s3", where);
}

}  // namespace quadtune
