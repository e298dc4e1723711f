// SPDX-License-Identifier: Apache-2.0
// Sensors and battery with the keys of a vehicle file.
#include <cmath>

#include "json/to_json.hpp"
#include "quadtune/internal/json.hpp"

namespace quadtune::exports {
namespace {

// Omits keys whose value is the reader's default.
class Table {
 public:
  explicit Table(std::string name) : name_(std::move(name)) {}

  void add(const std::string& key, double value) {
    json_[key] = internal::number_to_json(value, name_ + "." + key);
  }
  void add_unless(double if_absent, const std::string& key, double value) {
    if (value != if_absent && std::isfinite(value)) add(key, value);
  }
  void add_unless(double if_absent, const std::string& key, const Eigen::Vector3d& value,
                  int axes) {
    if (!(value.head(axes).array() == if_absent).all()) add_always(key, value, axes);
  }
  void add_always(const std::string& key, const Eigen::Vector3d& value, int axes) {
    if (axes == 1)
      add(key, value(0));
    else
      json_[key] = internal::vector_to_json(value.head(axes), name_ + "." + key);
  }
  void add_faults(const SensorFaults& faults, const std::string& unit, int axes) {
    const SensorFaults none;
    add("rate_Hz", faults.rate);
    add_unless(0, "delay_s", faults.delay);
    add_unless(1, "scale", faults.scale, axes);
    add_unless(0, "bias_" + unit, faults.bias, axes);
    add_unless(0, "noise_" + unit, faults.noise, axes);
    if (faults.natural_frequency > 0) {
      add("natural_frequency_rad_per_s", faults.natural_frequency);
      add("damping", faults.damping);
    }
    add_unless(none.limit, "limit_" + unit, faults.limit);
    add_unless(0, "quantum_" + unit, faults.quantum);
    add_unless(0, "dropout", faults.dropout);
    add_unless(0, "bias_turn_on_" + unit, faults.turn_on_bias, axes);
    add_unless(0, "bias_walk_" + unit + "_per_sqrt_s", faults.bias_walk, axes);
    if (faults.correlation > 0) {
      add_always("correlated_noise_" + unit, faults.correlated_noise, axes);
      add("correlation_s", faults.correlation);
    }
    add_unless(0, "vibration_" + unit + "_per_rad2_s2", faults.vibration, axes);
  }

  Json json() { return std::move(json_); }

 private:
  std::string name_;
  Json json_ = Json::object();
};

Json gyroscope_to_json(const Sensors& sensors) {
  Table table("gyroscope");
  table.add_faults(*sensors.gyroscope, "rad_per_s", 3);
  table.add_unless(0, "g_sensitivity_rad_per_s_per_m_per_s2", sensors.g_sensitivity, 3);
  return table.json();
}

Json faults_to_json(const std::string& name, const SensorFaults& faults, const std::string& unit) {
  Table table(name);
  table.add_faults(faults, unit, 3);
  return table.json();
}

Json to_json(const BarometerSensor& barometer) {
  Table table("barometer");
  table.add_faults(barometer.faults, "Pa", 1);
  table.add("ground_pressure_Pa", barometer.ground_pressure);
  if (!std::isnan(barometer.fall)) table.add("fall_Pa_per_m", barometer.fall);
  return table.json();
}

Json to_json(const SonarSensor& sonar) {
  Table table("sonar");
  table.add_faults(sonar.faults, "m", 1);
  table.add("least_range_m", sonar.min_range);
  if (std::isfinite(sonar.max_range)) table.add("greatest_range_m", sonar.max_range);
  table.add("greatest_tilt_rad", sonar.max_tilt);
  return table.json();
}

Json to_json(const FlowSensor& flow) {
  Table table("flow");
  table.add_faults(flow.faults, "rad_per_s", 2);
  table.add("half_field_x_rad", flow.half_field_x);
  table.add("half_field_y_rad", flow.half_field_y);
  table.add("least_height_m", flow.min_height);
  if (std::isfinite(flow.max_height)) table.add("greatest_height_m", flow.max_height);
  table.add_unless(0, "noise_per_height_rad_per_s_per_m", flow.noise_per_height);
  table.add("simplified_rate_gain", flow.simplified_rate_gain);
  return table.json();
}

Json to_json(const GpsSensor& gps) {
  Table table("gps");
  table.add_faults(gps.position, "m", 3);
  table.add_unless(0, "velocity_noise_m_per_s", gps.velocity_noise, 3);
  return table.json();
}

}  // namespace

Json sensors_to_json(const Sensors& sensors) {
  Json json = Json::object();
  if (sensors.accelerometer)
    json["accelerometer"] = faults_to_json("accelerometer", *sensors.accelerometer, "m_per_s2");
  if (sensors.gyroscope) json["gyroscope"] = gyroscope_to_json(sensors);
  if (sensors.magnetometer)
    json["magnetometer"] = faults_to_json("magnetometer", *sensors.magnetometer, "uT");
  if (sensors.barometer) json["barometer"] = to_json(*sensors.barometer);
  if (sensors.sonar) json["sonar"] = to_json(*sensors.sonar);
  if (sensors.flow) json["flow"] = to_json(*sensors.flow);
  if (sensors.gps) json["gps"] = to_json(*sensors.gps);
  if (sensors.vision) json["vision"] = faults_to_json("vision", *sensors.vision, "m");
  return json;
}

Json battery_to_json(const Battery& battery) {
  Table table("battery");
  table.add("capacity_A_h", battery.capacity / 3600);
  table.add("full_voltage_V", battery.full_voltage);
  table.add("empty_voltage_V", battery.empty_voltage);
  table.add_unless(0, "cutoff_voltage_V", battery.cutoff_voltage);
  table.add("rated_voltage_V", battery.rated_voltage);
  table.add_unless(0, "resistance_ohm", battery.resistance);
  table.add("efficiency", battery.efficiency);
  table.add_unless(0, "idle_power_W", battery.idle_power);
  Json json = table.json();
  json["regulated"] = battery.regulated;
  return json;
}

}  // namespace quadtune::exports
