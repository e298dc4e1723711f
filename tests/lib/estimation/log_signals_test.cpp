// SPDX-License-Identifier: Apache-2.0
#include "quadtune/estimation/log_signals.hpp"

#include <gmock/gmock.h>

#include <cmath>
#include <stdexcept>

#include "quadtune/errors.hpp"
#include "quadtune/estimation/filter_file.hpp"
#include "temporary_directory.hpp"

namespace quadtune {
namespace {

using ::testing::ElementsAre;
using ::testing::HasSubstr;
using testing::TemporaryDirectory;
using ::testing::ThrowsMessage;

std::vector<Signal> all_signals(const FilterModel& model) {
  std::vector<Signal> signals = model.inputs;
  for (const FilterSensor& sensor : model.sensors)
    signals.insert(signals.end(), sensor.outputs.begin(), sensor.outputs.end());
  return signals;
}

class LogSignals : public ::testing::Test {
 protected:
  FedSignals read(const std::string& model, const std::string& log) {
    const FilterModel filter = load_filter_model(model);
    return read_signals_by_name(folder_.write("log.csv", log).string(), filter,
                                all_signals(filter));
  }
  TemporaryDirectory folder_;
};

TEST_F(LogSignals, AreThoseOfTheirNames) {
  const FedSignals fed = read("altitude", "t,az[m/s^2],height\n0,1,2\n0.1,2,3\n");
  ASSERT_EQ(fed.signals.size(), 2);
  EXPECT_EQ(fed.signals[0].use.signal, "az");
  EXPECT_EQ(fed.signals[0].from, "az");
  EXPECT_THAT(fed.signals[1].use.series.values, ElementsAre(2, 3));
  EXPECT_THAT([&] { (void)read("altitude", "t,az\n0,1\n0.1,2\n"); },
              ThrowsMessage<InvalidInput>(HasSubstr("has no channel 'height'")));
}

TEST_F(LogSignals, OfOneThatStandsForAnythingHaveToBeNamed) {
  EXPECT_EQ(read("local-level", "t,y\n0,1\n1,2\n").signals.size(), 1);
  for (const char* log : {"t,y[uT]\n0,1\n1,2\n", "t,x,y,z\n0,1,1,1\n1,2,2,2\n"})
    EXPECT_THAT([&] { (void)read("local-level", log); },
                ThrowsMessage<InvalidInput>(HasSubstr("can be any quantity, and the channel "
                                                      "'y' ")))
        << log;
}

/// A flight log's columns that identify it, and some of its sensors: tilted by half a right
/// angle about x, falling freely but for a force of 1 m/s² along body z.
constexpr const char* kFlight =
    "# quadtune-log,1\n"
    "t[s],x.qw[1],estimate.px[m],estimate.pz[m],estimate.roll[rad],estimate.pitch[rad],"
    "estimate.yaw[rad],estimate.u[m/s],estimate.v[m/s],estimate.w[m/s],"
    "reference.track_position[1],command.T[N],accelerometer.x[m/s^2],accelerometer.y[m/s^2],"
    "accelerometer.z[m/s^2],gyroscope.x[rad/s],gyroscope.y[rad/s],gyroscope.z[rad/s],sonar[m],"
    "gps.px[m],gps.py[m],gps.pz[m],gps.vx[m/s],gps.vy[m/s],gps.vz[m/s],flow.x[rad/s],"
    "flow.y[rad/s],magnetometer.y[uT]\n"
    "0,1,0,-2,0.7853981633974483,0,0,0,0,0,1,5,0,0,1,0.1,0.2,0.3,,1,2,-3,4,5,-6,,,7\n"
    "0.01,1,0,-2,0.7853981633974483,0,0,0,0,0,1,5,0,0,1,0.1,0.2,0.3,2.5,,,,,,,,,7\n"
    "0.02,1,0,-2,0,0,0,0,0,0,1,5,0,0,1,0.1,0.2,0.3,2.5,1,2,-3,4,5,-6,-0.7,-0.4,7\n"
    "0.03,1,0,-2,0,0,0,0,0,0,1,5,0,0,1,0.1,0.2,0.3,2.5,1,2,-3,4,5,-6,-0.7,-0.4,7\n";

const FedSignal& find(const FedSignals& fed, const std::string& name) {
  for (const FedSignal& signal : fed.signals)
    if (signal.use.signal == name) return signal;
  throw std::runtime_error("no signal " + name);
}

// Measurements are turned into a world with z up, truths are not: they would be wrong by half a
// turn.
TEST_F(LogSignals, RefuseATruthOfAnotherWorld) {
  const std::string log = folder_.write("flight.csv", kFlight).string();
  const std::vector<LogGroup> own = read_log_channels(log, {"gps.py"}).groups;
  const std::vector<LogGroup> other =
      read_log_channels(folder_.write("a.csv", "t,y\n0,1\n1,2\n").string(), {"y"}).groups;
  const FilterModel up = load_filter_model("inertial"), down = load_filter_model("inertial-ned");
  for (const char* state : {"y", "z", "vz", "qw", "yaw"}) {
    EXPECT_THAT([&] { require_same_world("a.csv", up, state, own); },
                ThrowsMessage<InvalidInput>(HasSubstr("such as inertial-ned")))
        << state;
    require_same_world("a.csv", down, state, own);
    require_same_world("a.csv", up, state, other);
  }
  require_same_world("a.csv", up, "x", own);
  require_same_world("a.csv", up, "bias_z", own);
}

TEST_F(LogSignals, OfAFlightLogAreItsSensors) {
  const FedSignals uquad = read("inertial", kFlight);
  EXPECT_EQ(find(uquad, "gyro_y").from, "gyroscope.y");
  EXPECT_THAT(find(uquad, "gyro_y").use.series.values, ElementsAre(0.2, 0.2, 0.2, 0.2));
  EXPECT_EQ(find(uquad, "x").from, "gps.px");
  // Its world has z up: the log's, turned about x.
  EXPECT_EQ(find(uquad, "y").from, "-gps.py");
  EXPECT_THAT(find(uquad, "y").use.series.values, ElementsAre(-2, -2, -2));
  EXPECT_THAT(find(uquad, "z").use.series.values, ElementsAre(3, 3, 3));
  EXPECT_THAT(find(uquad, "vz").use.series.values, ElementsAre(6, 6, 6));
  EXPECT_THAT(find(uquad, "z").use.series.time, ElementsAre(0, 0.02, 0.03));
  EXPECT_THAT(find(uquad, "height").use.series.values, ElementsAre(2.5, 2.5, 2.5));
}

TEST_F(LogSignals, OfAFlightLogAreWhatTheFlightProgramMakesOfThem) {
  const FedSignals altitude = read("altitude", kFlight);
  const LogSeries& az = find(altitude, "az").use.series;
  ASSERT_EQ(az.values.size(), 4);
  EXPECT_NEAR(az.values[0], 9.81 + std::sqrt(0.5), 1e-12);
  EXPECT_NEAR(az.values[3], 9.81 + 1, 1e-12);
  EXPECT_EQ(find(altitude, "height").from, "sonar");
  // Two metres over the ground, level: what the image moves less what the turning makes.
  const FedSignals velocity = read("velocity-xy", kFlight);
  EXPECT_NEAR(find(velocity, "flow_vx").use.series.values[0], -(-0.7 + 0.2) * 2, 1e-12);
  EXPECT_NEAR(find(velocity, "flow_vy").use.series.values[0], -(-0.4 - 0.1) * 2, 1e-12);
  EXPECT_NEAR(find(velocity, "ay").use.series.values[0], -std::sqrt(0.5), 1e-12);
}

TEST_F(LogSignals, OfAFlightLogAreNotGuessed) {
  EXPECT_THAT(
      [&] { (void)read("local-level", kFlight); },
      ThrowsMessage<InvalidInput>(HasSubstr("this flight log has no channel for y of the model "
                                            "'local-level', expected --map y=CHANNEL")));
  EXPECT_THAT([&] { (void)read("uquad", kFlight); },
              ThrowsMessage<InvalidInput>(HasSubstr("no channel for the input 'speed_1'")));
}

}  // namespace
}  // namespace quadtune
