// SPDX-License-Identifier: Apache-2.0
#include "model/sensor_file.hpp"

#include <fmt/format.h>

#include <numbers>

#include "quadtune/errors.hpp"
#include "quadtune/internal/counted.hpp"

namespace quadtune::internal {
namespace {

constexpr Range kShare = {0, Range::Bound::closed, 1, Range::Bound::closed};
constexpr Range kRate = {0, Range::Bound::open, 10000, Range::Bound::closed};
constexpr Range kDelay = {0, Range::Bound::closed, 10, Range::Bound::closed};
constexpr Range kHalfField = {0, Range::Bound::open, 1.5, Range::Bound::closed};
constexpr Range kTilt = {0, Range::Bound::open, 1.5, Range::Bound::closed};
/// Maximum number of samples that may be in transit at once.
constexpr double kMaxWaiting = 10000;

std::vector<TomlKey> fault_keys(const std::string& unit) {
  return {{"rate", "Hz"},
          {"delay", "s"},
          {"scale"},
          {"bias", unit},
          {"noise", unit},
          {"natural_frequency", "rad_per_s"},
          {"damping"},
          {"limit", unit},
          {"quantum", unit},
          {"dropout"},
          {"bias_turn_on", unit},
          {"bias_walk", unit + "_per_sqrt_s"},
          {"correlated_noise", unit},
          {"correlation", "s"}};
}

void allow(const TomlTable& table, const std::string& unit, std::vector<TomlKey> more = {}) {
  std::vector<TomlKey> keys = fault_keys(unit);
  keys.insert(keys.end(), more.begin(), more.end());
  table.allow(keys);
}

/// One number per axis, or one number for all axes.
Eigen::Vector3d axes(const TomlTable& table, const std::string& key,
                     const Eigen::Vector3d& fallback, int count, const Range& range) {
  if (!table.has(key)) return fallback;
  if (!table.is_list(key)) return Eigen::Vector3d::Constant(table.number(key, range));
  const Eigen::VectorXd values = table.vector(key, range);
  if (values.size() != count)
    throw InvalidInput(table.where(key),
                       fmt::format("{} in {} has {}, expected {} or one number", key, table.title(),
                                   internal::counted(values.size(), "entry", "entries"), count));
  Eigen::Vector3d result = fallback;
  for (int i = 0; i < count; ++i) result(i) = values(i);
  return result;
}

SensorFaults read_faults(const TomlTable& table, const std::string& unit, int count) {
  SensorFaults faults;
  faults.rate = table.number("rate_Hz", kRate);
  faults.delay = table.number_or("delay_s", 0, kDelay);
  if (faults.delay * faults.rate > kMaxWaiting)
    throw InvalidInput(table.where("delay_s"),
                       fmt::format("delay_s in {} spans {:.0f} samples, expected at most {:.0f}",
                                   table.title(), faults.delay * faults.rate, kMaxWaiting));
  faults.scale = axes(table, "scale", faults.scale, count, Range::positive());
  faults.bias = axes(table, "bias_" + unit, faults.bias, count, Range::any());
  faults.noise = axes(table, "noise_" + unit, faults.noise, count, Range::not_negative());
  faults.natural_frequency =
      table.number_or("natural_frequency_rad_per_s", 0, Range::not_negative());
  faults.damping = table.number_or("damping", faults.damping, Range::positive());
  faults.limit = table.number_or("limit_" + unit, faults.limit, Range::positive());
  faults.quantum = table.number_or("quantum_" + unit, 0, Range::not_negative());
  faults.dropout = table.number_or("dropout", 0, kShare);
  const auto deviations = [&](const std::string& key) {
    return axes(table, key, Eigen::Vector3d::Zero(), count, Range::not_negative());
  };
  faults.turn_on_bias = deviations("bias_turn_on_" + unit);
  faults.bias_walk = deviations("bias_walk_" + unit + "_per_sqrt_s");
  faults.correlated_noise = deviations("correlated_noise_" + unit);
  faults.correlation = table.number_or("correlation_s", 0, Range::positive());
  const bool correlated = table.has("correlated_noise_" + unit);
  if (correlated != table.has("correlation_s"))
    throw InvalidInput(
        table.where(correlated ? "correlated_noise_" + unit : "correlation_s"),
        fmt::format("{} has {} but no {}, expected both: the standard deviation of the error and "
                    "its correlation time",
                    table.title(), correlated ? "correlated_noise_" + unit : "correlation_s",
                    correlated ? "correlation_s" : "correlated_noise_" + unit));
  return faults;
}

SonarSensor read_sonar(const TomlTable& table) {
  allow(table, "m", {{"least_range", "m"}, {"greatest_range", "m"}, {"greatest_tilt", "rad"}});
  SonarSensor sonar;
  sonar.faults = read_faults(table, "m", 1);
  sonar.min_range = table.number_or("least_range_m", 0, Range::not_negative());
  sonar.max_range = table.number_or("greatest_range_m", sonar.max_range, Range::positive());
  if (!(sonar.max_range > sonar.min_range))
    throw InvalidInput(
        table.where("greatest_range_m"),
        fmt::format("greatest_range_m in {} is {}, expected more than least_range_m, "
                    "{}",
                    table.title(), sonar.max_range, sonar.min_range));
  sonar.max_tilt = table.number_or("greatest_tilt_rad", sonar.max_tilt, kTilt);
  return sonar;
}

FlowSensor read_flow(const TomlTable& table) {
  allow(table, "rad_per_s",
        {{"half_field_x", "rad"},
         {"half_field_y", "rad"},
         {"least_height", "m"},
         {"greatest_height", "m"},
         {"noise_per_height", "rad_per_s_per_m"},
         {"simplified_rate_gain"}});
  FlowSensor flow;
  flow.faults = read_faults(table, "rad_per_s", 2);
  flow.half_field_x = table.number_or("half_field_x_rad", flow.half_field_x, kHalfField);
  flow.half_field_y = table.number_or("half_field_y_rad", flow.half_field_y, kHalfField);
  flow.min_height = table.number_or("least_height_m", flow.min_height, Range::positive());
  flow.max_height = table.number_or("greatest_height_m", flow.max_height, Range::positive());
  if (!(flow.max_height > flow.min_height))
    throw InvalidInput(table.where("greatest_height_m"),
                       fmt::format("greatest_height_m in {} is {}, expected more than "
                                   "least_height_m, {}",
                                   table.title(), flow.max_height, flow.min_height));
  flow.noise_per_height =
      table.number_or("noise_per_height_rad_per_s_per_m", 0, Range::not_negative());
  flow.simplified_rate_gain = table.number_or("simplified_rate_gain", flow.simplified_rate_gain);
  return flow;
}

BarometerSensor read_barometer(const TomlTable& table) {
  allow(table, "Pa", {{"ground_pressure", "Pa"}, {"fall", "Pa_per_m"}});
  BarometerSensor barometer;
  barometer.faults = read_faults(table, "Pa", 1);
  barometer.ground_pressure =
      table.number_or("ground_pressure_Pa", barometer.ground_pressure, Range::positive());
  // The pressure decreases with height; the general filter divides by this slope.
  barometer.fall = table.number_or("fall_Pa_per_m", barometer.fall,
                                   {0, Range::Bound::none, 0, Range::Bound::open});
  return barometer;
}

GpsSensor read_gps(const TomlTable& table) {
  allow(table, "m", {{"velocity_noise", "m_per_s"}});
  GpsSensor gps;
  gps.position = read_faults(table, "m", 3);
  gps.velocity_noise =
      axes(table, "velocity_noise_m_per_s", gps.velocity_noise, 3, Range::not_negative());
  return gps;
}

SensorFaults read_three_axes(const TomlTable& table, const std::string& unit) {
  allow(table, unit);
  return read_faults(table, unit, 3);
}

/// An accelerometer or a gyroscope, which is subject to vibrations of the rotors.
SensorFaults read_inertial(const TomlTable& table, const std::string& unit,
                           std::vector<TomlKey> more = {}) {
  const std::string vibration = unit + "_per_rad2_s2";
  more.push_back({"vibration", vibration});
  allow(table, unit, more);
  SensorFaults faults = read_faults(table, unit, 3);
  faults.vibration =
      axes(table, "vibration_" + vibration, faults.vibration, 3, Range::not_negative());
  return faults;
}

}  // namespace

Sensors read_sensors(const TomlTable& table) {
  table.allow({{"accelerometer"},
               {"gyroscope"},
               {"magnetometer"},
               {"barometer"},
               {"sonar"},
               {"flow"},
               {"gps"},
               {"vision"}});
  Sensors sensors;
  if (const auto of = table.maybe_table("accelerometer"))
    sensors.accelerometer = read_inertial(*of, "m_per_s2");
  if (const auto of = table.maybe_table("gyroscope")) {
    sensors.gyroscope =
        read_inertial(*of, "rad_per_s", {{"g_sensitivity", "rad_per_s_per_m_per_s2"}});
    sensors.g_sensitivity =
        axes(*of, "g_sensitivity_rad_per_s_per_m_per_s2", sensors.g_sensitivity, 3, Range::any());
  }
  if (const auto of = table.maybe_table("magnetometer"))
    sensors.magnetometer = read_three_axes(*of, "uT");
  if (const auto of = table.maybe_table("barometer")) sensors.barometer = read_barometer(*of);
  if (const auto of = table.maybe_table("sonar")) sensors.sonar = read_sonar(*of);
  if (const auto of = table.maybe_table("flow")) sensors.flow = read_flow(*of);
  if (const auto of = table.maybe_table("gps")) sensors.gps = read_gps(*of);
  if (const auto of = table.maybe_table("vision")) sensors.vision = read_three_axes(*of, "m");
  return sensors;
}

Battery read_battery(const TomlTable& table) {
  table.allow({{"capacity", "A_h"},
               {"full_voltage", "V"},
               {"empty_voltage", "V"},
               {"cutoff_voltage", "V"},
               {"rated_voltage", "V"},
               {"resistance", "ohm"},
               {"efficiency"},
               {"idle_power", "W"},
               {"regulated"}});
  Battery battery;
  battery.capacity = table.number("capacity_A_h", Range::positive()) * 3600;
  battery.empty_voltage = table.number("empty_voltage_V", Range::positive());
  battery.full_voltage = table.number("full_voltage_V", Range::positive());
  if (!(battery.full_voltage > battery.empty_voltage))
    throw InvalidInput(table.where("full_voltage_V"),
                       fmt::format("full_voltage_V in [battery] is {}, expected more than "
                                   "empty_voltage_V, {}",
                                   battery.full_voltage, battery.empty_voltage));
  battery.cutoff_voltage = table.number_or("cutoff_voltage_V", 0, Range::not_negative());
  if (!(battery.cutoff_voltage < battery.full_voltage))
    throw InvalidInput(table.where("cutoff_voltage_V"),
                       fmt::format("cutoff_voltage_V in [battery] is {}, expected less than "
                                   "full_voltage_V, {}",
                                   battery.cutoff_voltage, battery.full_voltage));
  battery.rated_voltage =
      table.number_or("rated_voltage_V", battery.full_voltage, Range::positive());
  battery.resistance = table.number_or("resistance_ohm", 0, Range::not_negative());
  battery.efficiency = table.number_or("efficiency", battery.efficiency,
                                       {0, Range::Bound::open, 1, Range::Bound::closed});
  battery.idle_power = table.number_or("idle_power_W", 0, Range::not_negative());
  if (table.has("regulated")) battery.regulated = table.truth("regulated");
  return battery;
}

}  // namespace quadtune::internal
