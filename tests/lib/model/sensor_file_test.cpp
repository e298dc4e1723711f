// SPDX-License-Identifier: Apache-2.0
#include <fmt/format.h>
#include <gmock/gmock.h>

#include <cmath>
#include <utility>
#include <vector>

#include "matrix_near.hpp"
#include "quadtune/errors.hpp"
#include "quadtune/model/vehicle.hpp"

namespace quadtune {
namespace {

using Eigen::Vector3d;
using ::testing::HasSubstr;
using testing::MatrixNear;
using ::testing::StrEq;
using ::testing::ThrowsMessage;

// 18 lines.
const std::string kHead = R"(name = 'plus'
[body]
mass_kg = 1
inertia_kg_m2 = [1e-2, 1e-2, 1.5e-2]
[rotor]
thrust_a2_N_s2_per_rad2 = 5e-5
torque_d2_N_m_s2_per_rad2 = 1e-6
[[rotors]]
position_m = [0.3, 0, 0]
spin = 'cw'
[[rotors]]
position_m = [-0.3, 0, 0]
spin = 'ccw'
[motor]
command = 'speed'
min_rad_s = 50
max_rad_s = 400
direction = [1, 1]
)";

Vehicle with_sensors(const std::string& rest) { return parse_vehicle(kHead + rest, "v.toml"); }

void expect_refusal(const std::string& rest, const std::string& message) {
  EXPECT_THAT([&] { (void)with_sensors(rest); }, ThrowsMessage<InvalidInput>(StrEq(message)))
      << rest;
}

TEST(SensorFile, ReadsEveryKey) {
  const Vehicle vehicle = with_sensors(R"(
[sensors.accelerometer]
rate_Hz = 250
delay_s = 0.004
scale = [1.01, 0.99, 1.02]
bias_m_per_s2 = [0.1, -0.2, 0.3]
noise_m_per_s2 = 0.2
natural_frequency_rad_per_s = 190
damping = 0.6
limit_m_per_s2 = 50
quantum_m_per_s2 = 0.01
dropout = 0.05
[sensors.gyroscope]
rate_Hz = 500
bias_rad_per_s = 0.01
[sensors.magnetometer]
rate_Hz = 80
noise_uT = [1, 2, 3]
[sensors.barometer]
rate_Hz = 50
noise_Pa = 2
ground_pressure_Pa = 100000
fall_Pa_per_m = -11
[sensors.sonar]
rate_Hz = 20
bias_m = [0.02]
least_range_m = 0.2
greatest_range_m = 4
greatest_tilt_rad = 0.4
[sensors.flow]
rate_Hz = 60
scale = [1.1, 0.9]
half_field_x_rad = 0.3
half_field_y_rad = 0.2
least_height_m = 0.5
simplified_rate_gain = 0.7
[sensors.gps]
rate_Hz = 5
delay_s = 0.2
noise_m = [1, 1, 2]
velocity_noise_m_per_s = 0.1
[sensors.vision]
rate_Hz = 5
delay_s = 0.1
noise_m = 0.03
)");
  EXPECT_TRUE(vehicle.sensors_known);
  const Sensors& s = vehicle.sensors;
  ASSERT_TRUE(s.accelerometer && s.gyroscope && s.magnetometer && s.barometer && s.sonar &&
              s.flow && s.gps && s.vision);
  EXPECT_EQ(s.accelerometer->rate, 250);
  EXPECT_EQ(s.accelerometer->delay, 0.004);
  EXPECT_THAT(s.accelerometer->scale, MatrixNear(Vector3d(1.01, 0.99, 1.02), 0));
  EXPECT_THAT(s.accelerometer->bias, MatrixNear(Vector3d(0.1, -0.2, 0.3), 0));
  EXPECT_THAT(s.accelerometer->noise, MatrixNear(Vector3d(0.2, 0.2, 0.2), 0));
  EXPECT_EQ(s.accelerometer->natural_frequency, 190);
  EXPECT_EQ(s.accelerometer->damping, 0.6);
  EXPECT_EQ(s.accelerometer->limit, 50);
  EXPECT_EQ(s.accelerometer->quantum, 0.01);
  EXPECT_EQ(s.accelerometer->dropout, 0.05);
  EXPECT_THAT(s.gyroscope->bias, MatrixNear(Vector3d(0.01, 0.01, 0.01), 0));
  EXPECT_EQ(s.gyroscope->delay, 0);
  EXPECT_EQ(s.gyroscope->limit, std::numeric_limits<double>::infinity());
  EXPECT_THAT(s.magnetometer->noise, MatrixNear(Vector3d(1, 2, 3), 0));
  EXPECT_EQ(s.barometer->ground_pressure, 100000);
  EXPECT_EQ(s.barometer->fall, -11);
  EXPECT_EQ(s.barometer->faults.noise(0), 2);
  EXPECT_EQ(s.sonar->faults.bias(0), 0.02);
  EXPECT_EQ(s.sonar->min_range, 0.2);
  EXPECT_EQ(s.sonar->max_range, 4);
  EXPECT_EQ(s.sonar->max_tilt, 0.4);
  EXPECT_EQ(s.flow->faults.scale(1), 0.9);
  EXPECT_EQ(s.flow->half_field_x, 0.3);
  EXPECT_EQ(s.flow->half_field_y, 0.2);
  EXPECT_EQ(s.flow->min_height, 0.5);
  EXPECT_EQ(s.flow->simplified_rate_gain, 0.7);
  EXPECT_EQ(s.gps->position.rate, 5);
  EXPECT_THAT(s.gps->position.noise, MatrixNear(Vector3d(1, 1, 2), 0));
  EXPECT_THAT(s.gps->velocity_noise, MatrixNear(Vector3d(0.1, 0.1, 0.1), 0));
  EXPECT_EQ(s.vision->delay, 0.1);
  EXPECT_THAT(s.vision->noise, MatrixNear(Vector3d(0.03, 0.03, 0.03), 0));
  EXPECT_TRUE(ideal(s).vision->noise.isZero(0));
}

TEST(SensorFile, HasTheSensorsThatItNamesAndNoOthers) {
  const Vehicle none = with_sensors("[sensors]\n");
  EXPECT_TRUE(none.sensors_known);
  EXPECT_FALSE(none.sensors.accelerometer || none.sensors.gyroscope || none.sensors.magnetometer ||
               none.sensors.barometer || none.sensors.sonar || none.sensors.flow ||
               none.sensors.gps || none.sensors.vision);
  const Vehicle unsaid = with_sensors("");
  EXPECT_FALSE(unsaid.sensors_known);
  EXPECT_EQ(unsaid.sensors.accelerometer->rate, typical_sensors().accelerometer->rate);
  EXPECT_TRUE(
      std::isnan(with_sensors("[sensors.barometer]\nrate_Hz = 1\n").sensors.barometer->fall));
}

// A sensor without noise would make a filter that trusts nothing else.
TEST(SensorFile, TypicalSensorsHaveNoiseAndTheirRates) {
  const Sensors typical = typical_sensors();
  const std::vector<std::pair<SensorFaults, double>> faults_and_rates = {
      {typical.accelerometer.value(), 200}, {typical.gyroscope.value(), 200},
      {typical.magnetometer.value(), 100},  {typical.barometer.value().faults, 50},
      {typical.sonar.value().faults, 20},   {typical.flow.value().faults, 60},
      {typical.gps.value().position, 1}};
  for (const auto& [faults, rate] : faults_and_rates) {
    EXPECT_EQ(faults.rate, rate);
    EXPECT_GT(faults.noise.minCoeff(), 0) << rate;
  }
  EXPECT_GT(typical.gps->velocity_noise.minCoeff(), 0);
}

TEST(SensorFile, IdealSensorsKeepTheirRatesAlone) {
  const Sensors before = load_vehicle("mambo").sensors;
  const Sensors after = ideal(before);
  EXPECT_EQ(after.accelerometer->rate, 200);
  EXPECT_EQ(after.accelerometer->delay, 0);
  EXPECT_TRUE(after.accelerometer->noise.isZero(0));
  EXPECT_TRUE(after.accelerometer->bias.isZero(0));
  EXPECT_TRUE(after.accelerometer->scale.isOnes(0));
  EXPECT_EQ(after.accelerometer->natural_frequency, 0);
  EXPECT_EQ(after.accelerometer->limit, std::numeric_limits<double>::infinity());
  EXPECT_EQ(after.barometer->fall, before.barometer->fall);
  EXPECT_EQ(after.flow->min_height, before.flow->min_height);
  EXPECT_FALSE(after.gps);
}

// Each number of a table in each way that a number can be wrong.
struct Key {
  const char* table;
  const char* key;
  const char* bad;       // out of range, or ""
  const char* expected;  // what the message then says
  int axes = 0;          // > 0: a list may stand there
};

constexpr const char* kPositive = "more than 0";
constexpr const char* kNotNegative = "0 or more";

std::vector<Key> keys() {
  std::vector<Key> all = {
      {"sensors.barometer", "ground_pressure_Pa", "0", kPositive},
      {"sensors.barometer", "fall_Pa_per_m", "12", "less than 0"},
      {"sensors.sonar", "least_range_m", "-1", kNotNegative},
      {"sensors.sonar", "greatest_range_m", "0", kPositive},
      {"sensors.sonar", "greatest_tilt_rad", "1.6", "more than 0 and 1.5 or less"},
      {"sensors.flow", "half_field_x_rad", "0", "more than 0 and 1.5 or less"},
      {"sensors.flow", "half_field_y_rad", "2", "more than 0 and 1.5 or less"},
      {"sensors.flow", "least_height_m", "0", kPositive},
      {"sensors.flow", "simplified_rate_gain", "", ""},
      {"sensors.gps", "velocity_noise_m_per_s", "-1", kNotNegative, 3},
  };
  struct Table {
    const char* name;
    const char* unit;
    int axes;
  };
  static std::vector<std::string> names;  // that the keys point into
  names.reserve(100);
  for (const Table& table :
       {Table{"sensors.accelerometer", "m_per_s2", 3}, Table{"sensors.gyroscope", "rad_per_s", 3},
        Table{"sensors.magnetometer", "uT", 3}, Table{"sensors.barometer", "Pa", 1},
        Table{"sensors.sonar", "m", 1}, Table{"sensors.flow", "rad_per_s", 2},
        Table{"sensors.gps", "m", 3}, Table{"sensors.vision", "m", 3}}) {
    const auto unit = [&](const std::string& stem) {
      names.push_back(stem + "_" + table.unit);
      return names.back().c_str();
    };
    all.push_back({table.name, "rate_Hz", "0", "more than 0 and 10000 or less"});
    all.push_back({table.name, "rate_Hz", "10001", "more than 0 and 10000 or less"});
    all.push_back({table.name, "delay_s", "-0.1", "0 or more and 10 or less"});
    all.push_back({table.name, "delay_s", "11", "0 or more and 10 or less"});
    all.push_back({table.name, "scale", "0", kPositive, table.axes});
    all.push_back({table.name, unit("bias"), "", "", table.axes});
    all.push_back({table.name, unit("noise"), "-1", kNotNegative, table.axes});
    all.push_back({table.name, "natural_frequency_rad_per_s", "-1", kNotNegative});
    all.push_back({table.name, "damping", "0", kPositive});
    all.push_back({table.name, unit("limit"), "0", kPositive});
    all.push_back({table.name, unit("quantum"), "-1", kNotNegative});
    all.push_back({table.name, "dropout", "1.1", "0 or more and 1 or less"});
    all.push_back({table.name, "dropout", "-0.1", "0 or more and 1 or less"});
  }
  return all;
}

TEST(SensorFile, RefusesNumbersThatAreNone) {
  for (const Key& k : keys()) {
    const bool rate = std::string(k.key) == "rate_Hz";
    const auto text = [&](const std::string& value) {
      return fmt::format("[{}]\n{}{} = {}\n", k.table, rate ? "" : "rate_Hz = 100\n", k.key, value);
    };
    const int line = rate ? 20 : 21;
    const auto message = [&](const std::string& is, const std::string& expected) {
      return fmt::format("v.toml:{}: {} in [{}] is {}, expected {}", line, k.key, k.table, is,
                         expected);
    };
    if (*k.bad != '\0') expect_refusal(text(k.bad), message(k.bad, k.expected));
    expect_refusal(text("nan"), message("nan", "a finite number"));
    expect_refusal(text("inf"), message("inf", "a finite number"));
    expect_refusal(text("true"), message("true", "a number"));
    expect_refusal(text("'5'"), message("the string '5'", "a number"));
    if (k.axes == 0) {
      expect_refusal(text("[1, 2]"), message("a list of 2", "a number"));
      continue;
    }
    expect_refusal(text("[1, 2, 3, 4]"),
                   fmt::format("v.toml:21: {} in [{}] has 4 entries, expected {} or one number",
                               k.key, k.table, k.axes));
    if (*k.bad != '\0')
      expect_refusal(text(fmt::format("[{}]", k.bad)),
                     fmt::format("v.toml:21: entry 1 of {} in [{}] is {}, expected {}", k.key,
                                 k.table, k.bad, k.expected));
    expect_refusal(text("['x']"),
                   fmt::format("v.toml:21: entry 1 of {} in [{}] is the string 'x', expected a "
                               "number",
                               k.key, k.table));
  }
}

TEST(SensorFile, RefusesKeysItDoesNotKnow) {
  for (const char* sensor : {"accelerometer", "gyroscope", "magnetometer", "barometer", "sonar",
                             "flow", "gps", "vision"}) {
    const std::string table = fmt::format("[sensors.{}]\n", sensor);
    expect_refusal(
        table + "scale = 1\n",
        fmt::format("v.toml:19: [sensors.{}] has no key 'rate_Hz', which is required", sensor));
    expect_refusal(table + "rate_Hz = 9\ndelay_ms = 1\n",
                   fmt::format("v.toml:21: key 'delay_ms' in [sensors.{}] is not known, expected "
                               "'delay_s' (the unit is part of the key)",
                               sensor));
    EXPECT_THAT([&] { (void)with_sensors(table + "rate_Hz = 9\ncolour = 1\n"); },
                ThrowsMessage<InvalidInput>(HasSubstr(fmt::format(
                    "v.toml:21: key 'colour' in [sensors.{}] is not known, expected one of rate_Hz",
                    sensor))));
  }
  EXPECT_THAT([] { (void)with_sensors("[sensors.lidar]\nrate_Hz = 9\n"); },
              ThrowsMessage<InvalidInput>(
                  HasSubstr("v.toml:19: key 'lidar' in [sensors] is not known, expected one of "
                            "accelerometer, gyroscope")));
  expect_refusal("[sensors]\ngps = 5\n",
                 "v.toml:20: gps in [sensors] is 5, expected one table, [sensors.gps]");
}

TEST(SensorFile, RefusesSensorsThatContradictThemselves) {
  expect_refusal("[sensors.sonar]\nrate_Hz = 9\nleast_range_m = 3\ngreatest_range_m = 3\n",
                 "v.toml:22: greatest_range_m in [sensors.sonar] is 3, expected more than "
                 "least_range_m, 3");
  expect_refusal("[sensors.gps]\nrate_Hz = 9000\ndelay_s = 9\n",
                 "v.toml:21: delay_s in [sensors.gps] spans 81000 samples, expected at most 10000");
}

TEST(SensorFile, TheMambosAreThoseOfItsModel) {
  const Sensors s = load_vehicle("mambo").sensors;
  EXPECT_EQ(s.accelerometer->rate, 200);
  EXPECT_EQ(s.accelerometer->natural_frequency, 190);
  EXPECT_EQ(s.flow->faults.rate, 60);
  EXPECT_FALSE(s.gps || s.magnetometer || s.vision);
}

const std::string kBattery = R"([battery]
capacity_A_h = 1.5
full_voltage_V = 12.6
empty_voltage_V = 9.6
)";

TEST(BatteryFile, ReadsEveryKey) {
  const Battery b = with_sensors(kBattery + R"(cutoff_voltage_V = 9
rated_voltage_V = 12
resistance_ohm = 0.05
efficiency = 0.6
idle_power_W = 3
regulated = false
)")
                        .battery.value();
  EXPECT_EQ(b.capacity, 5400);
  EXPECT_EQ(b.full_voltage, 12.6);
  EXPECT_EQ(b.empty_voltage, 9.6);
  EXPECT_EQ(b.cutoff_voltage, 9);
  EXPECT_EQ(b.rated_voltage, 12);
  EXPECT_EQ(b.resistance, 0.05);
  EXPECT_EQ(b.efficiency, 0.6);
  EXPECT_EQ(b.idle_power, 3);
  EXPECT_FALSE(b.regulated);
  const Battery plain = with_sensors(kBattery).battery.value();
  EXPECT_EQ(plain.rated_voltage, 12.6);  // the full one
  EXPECT_EQ(plain.resistance, 0);
  EXPECT_EQ(plain.cutoff_voltage, 0);
  EXPECT_TRUE(plain.regulated);
  EXPECT_FALSE(with_sensors("").battery.has_value());
}

TEST(BatteryFile, RefusesWhatIsNoBattery) {
  struct Bad {
    const char* key;
    const char* bad;
    const char* expected;
  };
  for (const Bad& k :
       {Bad{"cutoff_voltage_V", "-1", kNotNegative}, Bad{"rated_voltage_V", "0", kPositive},
        Bad{"resistance_ohm", "-1", kNotNegative},
        Bad{"efficiency", "0", "more than 0 and 1 or less"},
        Bad{"efficiency", "1.1", "more than 0 and 1 or less"},
        Bad{"idle_power_W", "-1", kNotNegative}}) {
    const auto refusal = [&](const std::string& value, const std::string& is,
                             const std::string& expected) {
      expect_refusal(
          fmt::format("{}{} = {}\n", kBattery, k.key, value),
          fmt::format("v.toml:23: {} in [battery] is {}, expected {}", k.key, is, expected));
    };
    refusal(k.bad, k.bad, k.expected);
    refusal("nan", "nan", "a finite number");
    refusal("'full'", "the string 'full'", "a number");
  }
  for (const char* key : {"capacity_A_h", "full_voltage_V", "empty_voltage_V"}) {
    std::string text = kBattery;
    const std::size_t at = text.find(key);
    const std::size_t end = text.find('\n', at);
    const auto line = 19 + std::count(text.begin(), text.begin() + static_cast<long>(at), '\n');
    expect_refusal(text.substr(0, at) + key + " = 0" + text.substr(end),
                   fmt::format("v.toml:{}: {} in [battery] is 0, expected more than 0", line, key));
    expect_refusal(text.substr(0, at) + text.substr(end + 1),
                   fmt::format("v.toml:19: [battery] has no key '{}', which is required", key));
  }
  expect_refusal(kBattery + "regulated = 1\n",
                 "v.toml:23: regulated in [battery] is 1, expected true or false");
  expect_refusal("[battery]\ncapacity_A_h = 1\nfull_voltage_V = 9\nempty_voltage_V = 9\n",
                 "v.toml:21: full_voltage_V in [battery] is 9, expected more than empty_voltage_V, "
                 "9");
  expect_refusal("[battery]\ncapacity_mA_h = 1\n",
                 "v.toml:20: key 'capacity_mA_h' in [battery] is not known, expected "
                 "'capacity_A_h' (the unit is part of the key)");
  expect_refusal("battery = 3\n",
                 "v.toml:19: key 'battery' in [motor] is not known, expected one "
                 "of command, min_rad_s, max_rad_s, quantum_rad_s, direction, command_delay_s, "
                 "command_jitter_s");
}

TEST(MotorFile, ReadsTheQuantum) {
  EXPECT_EQ(with_sensors("").motor.quantum, 0);
  EXPECT_EQ(with_sensors("quantum_rad_s = 0.5\n").motor.quantum, 0.5);
  expect_refusal("quantum_rad_s = -1\n",
                 "v.toml:19: quantum_rad_s in [motor] is -1, expected 0 or more");
  expect_refusal("quantum_rad_s = nan\n",
                 "v.toml:19: quantum_rad_s in [motor] is nan, expected a finite number");
  expect_refusal("quantum_count = 1\n",
                 "v.toml:19: key 'quantum_count' in [motor] is not known, expected 'quantum_rad_s' "
                 "(the unit is part of the key)");
}

}  // namespace
}  // namespace quadtune
