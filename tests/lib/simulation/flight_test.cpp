// SPDX-License-Identifier: Apache-2.0
#include "quadtune/simulation/flight.hpp"

#include <gmock/gmock.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <span>

#include "matrix_near.hpp"
#include "plants/designed_mambo.hpp"
#include "quadtune/control/cascade_law.hpp"
#include "quadtune/errors.hpp"
#include "quadtune/model/atmosphere.hpp"
#include "quadtune/model/mixer.hpp"
#include "same_bits.hpp"
#include "same_flight.hpp"

namespace quadtune {
namespace {

using ::testing::ElementsAre;
using testing::first_difference;
using ::testing::HasSubstr;
using testing::MatrixNear;
using testing::same_bits;
using ::testing::StrEq;
using ::testing::ThrowsMessage;

CascadeController published() { return {load_vehicle("mambo").published_cascade->gains}; }

// The published cascade without its integrals is a state feedback to the wrench.
StateFeedbackController feedback() {
  CascadeGains gains = load_vehicle("mambo").published_cascade->gains;
  for (PidLoop& loop : gains.loops) loop.Ki = 0;
  StateFeedbackController controller;
  controller.dt = gains.dt;
  Gains& g = controller.gains;
  g.convention = "ned";
  g.input_kind = InputKind::wrench;
  g.states = ned_convention().states;
  g.inputs = ned_convention().wrench;
  g.K = -cascade_law(gains, PidMethod::forward_euler).D.rightCols(12);
  g.K_int = Eigen::MatrixXd::Zero(4, 1);
  g.K_int(0, 0) = -0.1;
  g.integrals = {{"pz", "m s"}};
  g.x0 = Eigen::VectorXd::Zero(12);
  g.u0 = Eigen::Vector4d(0.063 * 9.81, 0, 0, 0);
  g.dt = gains.dt;
  return controller;
}

FlightSetup hover(double duration) {
  FlightSetup setup;
  setup.vehicle = load_vehicle("mambo");
  setup.mission = load_mission("hover");
  setup.controller = published();
  setup.duration = duration;
  return setup;
}

/// A camera over known marks: 5 images a second, each read in 0.2 s.
SensorFaults images() {
  SensorFaults faults;
  faults.rate = 5;
  faults.delay = 0.2;
  faults.noise.setConstant(0.03);
  return faults;
}

FlightSetup ideal_hover(double duration) {
  FlightSetup setup = hover(duration);
  setup.estimator = EstimatorKind::truth;
  setup.real_sensors = false;
  return setup;
}

// Up, a short stay and down: vehicles that differ touch the ground at different times.
Mission up_and_down() {
  return parse_mission(R"(
name = "up-and-down"
duration_s = 9
[start]
at = "ground"
start_up_s = 0.5
take_off_s = 1
[hover]
height_m = 0.6
[landing]
at_s = 4
rate_m_per_s = 0.3
[settling]
window_s = 1
)",
                       "m.toml");
}

std::vector<std::string> names(const FlightResult& result) {
  std::vector<std::string> all;
  all.reserve(result.events.size());
  for (const LogEvent& event : result.events) all.push_back(event.name);
  return all;
}

TEST(Fly, HoversWhereItIsAsked) {
  for (const Controller& controller : {Controller(published()), Controller(feedback())}) {
    FlightSetup setup = ideal_hover(60);
    setup.controller = controller;
    const FlightResult result = fly(setup);
    EXPECT_EQ(result.end, FlightEnd::completed);
    EXPECT_EQ(result.culprit, "");
    EXPECT_DOUBLE_EQ(result.end_time, 60);
    EXPECT_EQ(result.steps, 12000u);
    EXPECT_THAT(names(result), ElementsAre("start_up", "take_off", "flying"));
    EXPECT_DOUBLE_EQ(result.events[1].time, 0.5);
    EXPECT_NEAR(result.events[2].time, end_of_take_off(setup.mission), 0.005);
    StateVector<double> there = StateVector<double>::Zero();
    there(2) = -1.1;
    EXPECT_THAT(result.final_state, MatrixNear(there, 1e-3)) << setup.controller.index();
    EXPECT_THAT(result.final_estimate, MatrixNear(result.final_state, 0));
  }
}

// Thrust that carries the weight needs this power at the shafts: Σ Q w.
TEST(Fly, NeedsThePowerOfHover) {
  FlightSetup setup = ideal_hover(20);
  setup.mission.start.in_air = true;
  setup.mission.start.position = {0, 0, -1.1};
  const FlightResult result = fly(setup);
  const Rotor& rotor = setup.vehicle.rotors[0];
  const double w = rotor_speed_for_thrust(rotor, 0.063 * 9.81 / 4);
  EXPECT_EQ(result.metrics[Metric::duration], 20);
  // Each sample counts for the period that it begins, the last one too.
  EXPECT_NEAR(result.metrics[Metric::energy] / 20.005, 4 * rotor_torque(rotor, w) * w, 1e-9);
  EXPECT_NEAR(result.metrics[Metric::tracking_max], 0, 1e-12);
  EXPECT_EQ(result.metrics[Metric::saturation_time], 0);
}

TEST(Fly, LandsAndStaysOnTheGround) {
  FlightSetup setup = ideal_hover(0);
  setup.mission = up_and_down();
  const FlightResult result = fly(setup);
  EXPECT_THAT(names(result),
              ElementsAre("start_up", "take_off", "flying", "landing", "motors_off"));
  EXPECT_NEAR(result.final_state(2), 9.81 / 3600, 1e-6);
  EXPECT_LT(result.final_state.tail<6>().norm(), 1e-6);
  EXPECT_LT(result.metrics[Metric::touchdown_speed], 1.2);  // it falls the last 5 cm
}

// Where the vehicle stands it stands: at its depth in the ground, whatever the motors' ramp does.
TEST(Fly, StandsStillUntilItTakesOff) {
  for (const char* name : {"mambo", "uquad", "crazyflie"}) {
    FlightSetup setup = ideal_hover(0.5);
    setup.vehicle = load_vehicle(name);
    if (setup.vehicle.published_cascade)
      setup.controller = CascadeController{setup.vehicle.published_cascade->gains};
    setup.mission.start.start_up = 0.5;
    setup.log = true;
    const FlightResult result = fly(setup);
    for (const char* column : {"x.u", "x.v", "x.p", "x.q", "x.r"})
      for (const double value : result.log.find(column)->values)
        ASSERT_NEAR(value, 0, 0.02) << name;
  }
}

TEST(Fly, TwiceGivesTheSameBytes) {
  FlightSetup setup = hover(8);
  setup.environment.wind.turbulence = 5;
  setup.log = true;
  EXPECT_STREQ(first_difference(fly(setup), fly(setup)), "");
  FlightSetup other = setup;
  other.seed = 2;
  EXPECT_STRNE(first_difference(fly(setup), fly(other)), "");
  other = setup;
  other.flight = 1;
  EXPECT_STRNE(first_difference(fly(setup), fly(other)), "");
}

// Eleven flights that differ in numbers: vehicles, sensors, wind.
std::vector<FlightSetup> campaign(const FlightSetup& common) {
  std::vector<FlightSetup> all;
  for (std::uint32_t i = 0; i < 11; ++i) {
    FlightSetup setup = common;
    setup.flight = i;
    Vehicle flown = setup.vehicle;
    const double share = 1 + 0.02 * (static_cast<double>(i) - 5);
    flown.mass *= share;
    flown.inertia *= share;
    if (i % 3 == 1) flown.inertia(0, 1) = flown.inertia(1, 0) = 1e-6;
    if (i % 4 == 2) flown.drag.linear.setConstant(0.01);
    flown.rotors[1].thrust_a2 *= 1 - 0.002 * i;
    if (flown.sensors.sonar) flown.sensors.sonar->faults.dropout = 0.05 * (i % 3);
    if (flown.sensors.flow) flown.sensors.flow->faults.noise.setConstant(0.02 * (i % 2));
    if (i % 5 == 4) flown.motor.quantum = 1;
    setup.flown = flown;
    setup.environment.wind.mean = {0.2 * (i % 3), 0, 0};
    setup.environment.wind.turbulence = i % 2 ? 1.0 : 0;
    if (i == 7) setup.environment.wind.gust = {{0.5, 0.5, 0}, 2, 1};
    all.push_back(setup);
  }
  return all;
}

void expect_same_as_alone(const std::vector<FlightSetup>& setups, const std::string& what) {
  std::vector<FlightResult> alone(setups.size());
  for (std::size_t i = 0; i < setups.size(); ++i) alone[i] = fly(setups[i]);
  for (std::size_t count = 1; count <= setups.size(); count += count < 9 ? 1 : 2) {
    const std::vector<FlightResult> together = fly_all(std::span(setups).first(count), 1);
    ASSERT_EQ(together.size(), count);
    for (std::size_t i = 0; i < count; ++i)
      EXPECT_STREQ(first_difference(together[i], alone[i]), "")
          << what << ", flight " << i << " of " << count;
  }
}

TEST(FlyAll, IsEachFlightAlone) {
  for (const Controller& controller : {Controller(published()), Controller(feedback())})
    for (const EstimatorKind estimator : {EstimatorKind::truth, EstimatorKind::mambo,
                                          EstimatorKind::uquad, EstimatorKind::general}) {
      FlightSetup common = hover(3);
      common.vehicle.sensors.magnetometer = typical_sensors().magnetometer;
      common.vehicle.sensors.gps = typical_sensors().gps;
      common.vehicle.sensors.vision = images();
      common.controller = controller;
      common.estimator = estimator;
      common.environment.magnetic_field = {20, 2, 43};
      common.log = true;
      expect_same_as_alone(campaign(common),
                           to_string(estimator) + " " + std::to_string(controller.index()));
    }
}

// Flights that are over at different times: each by its own belief.
TEST(FlyAll, IsEachFlightAloneWhenTheyLand) {
  for (const EstimatorKind estimator :
       {EstimatorKind::truth, EstimatorKind::mambo, EstimatorKind::uquad, EstimatorKind::general}) {
    FlightSetup common = hover(0);
    common.mission = up_and_down();
    common.vehicle.sensors = typical_sensors();
    common.estimator = estimator;
    common.log = true;
    expect_same_as_alone(campaign(common), to_string(estimator));
  }
  FlightSetup common = hover(0);
  common.mission = up_and_down();
  common.estimator = EstimatorKind::truth;  // with which all of them come down
  std::vector<double> times;
  for (const FlightResult& result : fly_all(campaign(common)))
    for (const LogEvent& event : result.events)
      if (event.name == "motors_off") times.push_back(event.time);
  ASSERT_GT(times.size(), 2u);
  EXPECT_GT(*std::max_element(times.begin(), times.end()),
            *std::min_element(times.begin(), times.end()));  // and they did
}

TEST(FlyAll, IsEachFlightAloneWithLagAndAnyNumberOfRotors) {
  FlightSetup common = ideal_hover(3);
  for (Rotor& rotor : common.vehicle.rotors) rotor.lag = 0.02;
  expect_same_as_alone(campaign(common), "lag");
  for (const double lag : {0.0, 0.02}) {
    FlightSetup six = ideal_hover(3);
    std::vector<Rotor>& rotors = six.vehicle.rotors;
    const Rotor model = rotors[0];
    rotors.clear();
    for (int i = 0; i < 6; ++i) {
      Rotor rotor = model;
      const double angle = i * std::numbers::pi / 3 + 0.3;
      rotor.position = {0.06 * std::cos(angle), 0.06 * std::sin(angle), 0};
      rotor.spin = i % 2 ? Spin::clockwise : Spin::counter_clockwise;
      rotor.lag = lag;
      rotors.push_back(rotor);
    }
    six.vehicle.motor.direction.clear();
    expect_same_as_alone(campaign(six), "six rotors");
  }
}

TEST(FlyAll, IsEachFlightAloneWithLeadsOfTheRate) {
  std::vector<FlightSetup> setups = campaign(ideal_hover(3));
  for (std::size_t i = 0; i < setups.size(); ++i)
    for (PidLoop& loop : std::get<CascadeController>(setups[i].controller).gains.loops) {
      if (loop.name != "roll" && loop.name != "pitch") continue;
      loop.rate_lead = 0.004 * static_cast<double>(i % 4);
      loop.rate_filter = i % 3 == 0 ? 0.02 : 0.004;
    }
  expect_same_as_alone(setups, "leads");
  // They change the flight.
  EXPECT_STRNE(first_difference(fly(setups[1]), fly(campaign(ideal_hover(3))[1])), "");
}

TEST(FlyAll, IsEachFlightAloneInChangingAir) {
  FlightSetup common = hover(3);
  common.environment.dynamic = true;
  std::vector<FlightSetup> setups = campaign(common);
  for (std::size_t i = 0; i < setups.size(); ++i)
    setups[i].environment.ground_height = 300.0 * static_cast<double>(i);
  expect_same_as_alone(setups, "changing air");
}

// What a pack would take from its first flight keeps others out of it.
TEST(FlyAll, KeepsApartWhatIsNotAlike) {
  FlightSetup common = hover(2);
  common.vehicle.sensors = typical_sensors();
  common.estimator = EstimatorKind::uquad;
  std::vector<FlightSetup> setups(8, common);
  setups[1].vehicle.sensors.barometer->fall = -12;
  setups[2].vehicle.sensors.barometer->ground_pressure = 99000;
  setups[3].vehicle.inertia *= 1.5;
  setups[4].vehicle.drag.linear.setConstant(0.1);
  setups[5].mission.start.yaw = 1;  // in memory: the file's text is the same
  std::get<Hover>(setups[6].mission.kind).position.z() = -0.5;
  setups[7].vehicle.rotors[2].inertia *= 2;
  expect_same_as_alone(setups, "not alike");
}

TEST(FlyAll, DoesNotDependOnTheThreads) {
  const std::vector<FlightSetup> setups = campaign(hover(2));
  const std::vector<FlightResult> one = fly_all(setups, 1), three = fly_all(setups, 3);
  for (std::size_t i = 0; i < setups.size(); ++i)
    EXPECT_STREQ(first_difference(one[i], three[i]), "");
}

TEST(Fly, StopsWhenAsked) {
  EXPECT_THROW((void)fly(hover(5), [] { return true; }), Interrupted);
}

TEST(FlyAll, StopsWhenAsked) {
  const std::vector<FlightSetup> setups(2, hover(5));
  EXPECT_THROW((void)fly_all(setups, 1, [] { return true; }), Interrupted);
}

TEST(FlyAll, SaysWhichFlightCannotBeFlown) {
  std::vector<FlightSetup> setups(3, hover(1));
  setups[2].step = 0;
  EXPECT_THAT([&] { (void)fly_all(setups, 1); },
              ThrowsMessage<InvalidInput>(HasSubstr("flight 2: flight: the step is 0 s")));
}

// Rotors that follow within a fifth of a millisecond are too fast for Euler's step of 5 ms.
TEST(Fly, SaysWhatDivergedAndWhen) {
  std::vector<FlightSetup> setups(3, ideal_hover(5));
  for (FlightSetup& setup : setups) {
    setup.integrator = Integrator::euler;
    setup.safety.tilt = 3.15;
    setup.safety.collision = 1e9;
    setup.log = true;
    for (Rotor& rotor : setup.vehicle.rotors) rotor.lag = 0.02;
  }
  setups[1].flown = setups[1].vehicle;
  for (Rotor& rotor : setups[1].flown->rotors) rotor.lag = 2e-4;
  const std::vector<FlightResult> results = fly_all(setups, 1);
  const FlightResult& bad = results[1];
  EXPECT_EQ(bad.end, FlightEnd::diverged);
  EXPECT_NE(bad.culprit, "");
  EXPECT_EQ(bad.events.back().name, "diverged");
  EXPECT_EQ(bad.events.back().detail, "state " + bad.culprit);
  EXPECT_EQ(bad.events.back().time, bad.end_time);
  EXPECT_LT(bad.end_time, 3);
  EXPECT_LT(bad.log.rows(), 600u);
  EXPECT_STREQ(first_difference(bad, fly(setups[1])), "");
  EXPECT_EQ(results[0].end, FlightEnd::completed);  // its neighbours do not notice
  EXPECT_STREQ(first_difference(results[0], fly(setups[0])), "");
  EXPECT_STREQ(first_difference(results[2], fly(setups[2])), "");
}

struct Exit {
  const char* name;
  const char* event;
  const char* detail;
  void (*spoil)(FlightSetup&);
};

class SafetyExits : public ::testing::TestWithParam<Exit> {};

TEST_P(SafetyExits, EndTheFlight) {
  FlightSetup setup = hover(20);
  setup.vehicle.sensors = ideal(setup.vehicle.sensors);
  EXPECT_EQ(fly(setup).end, FlightEnd::completed);
  GetParam().spoil(setup);
  const FlightResult result = fly(setup);
  EXPECT_EQ(result.end, FlightEnd::safety_exit) << to_string(result.end) << result.culprit;
  ASSERT_FALSE(result.events.empty());
  EXPECT_EQ(result.events.back().name, GetParam().event);
  EXPECT_EQ(result.events.back().detail, GetParam().detail);
  EXPECT_EQ(result.events.back().time, result.end_time);
  EXPECT_LT(result.end_time, 20);
  EXPECT_EQ(result.culprit, "");
}

INSTANTIATE_TEST_SUITE_P(
    Each, SafetyExits,
    ::testing::Values(
        Exit{"Tilt", "tilt", "the estimated attitude is tilted by more than 0.5 rad",
             [](FlightSetup& s) {
               s.safety.tilt = 0.5;
               s.mission = load_mission("step-east");
               for (PidLoop& loop : std::get<CascadeController>(s.controller).gains.loops)
                 if (loop.name == "roll") loop.Kp = -loop.Kp;
             }},
        Exit{"Collision", "collision", "the accelerometer read more than 12.5 m/s²",
             [](FlightSetup& s) { s.safety.collision = 12.5; }},  // take-off is at 14.2
        Exit{"Battery", "battery", "the voltage fell below its cut-off",
             [](FlightSetup& s) {
               Battery battery;
               battery.capacity = 10;
               battery.full_voltage = battery.rated_voltage = 4.2;
               battery.empty_voltage = 3;
               battery.cutoff_voltage = 3.4;
               battery.resistance = 0.05;
               s.vehicle.battery = battery;
             }},
        Exit{"Charge", "battery", "its charge is spent",
             [](FlightSetup& s) {
               Battery battery;
               battery.capacity = 5;
               battery.full_voltage = battery.rated_voltage = 4.2;
               battery.empty_voltage = 4;
               s.vehicle.battery = battery;
             }},
        Exit{"FlowLost", "flow-lost", "no optical flow arrived",
             [](FlightSetup& s) { s.vehicle.sensors.flow->faults.dropout = 1; }},
        Exit{"Disagreement", "disagreement", "optical flow and estimated velocity differ",
             [](FlightSetup& s) {
               s.mambo_estimator.velocity_R = 1e9;  // it does not believe what it sees
               s.vehicle.sensors.flow->faults.bias.setConstant(3);
             }},
        Exit{"Abort", "abort", "",
             [](FlightSetup& s) {
               s.mission = parse_mission(
                   "name = 'a'\nduration_s = 20\n[start]\nat = 'ground'\n"
                   "[keys]\nheight_m = 1\n"
                   "press = [{ at_s = 3, key = 'e' }]\n",
                   "m.toml");
             }}),
    [](const auto& test) { return std::string(test.param.name); });

// An arm carries the vehicle along a lemniscate of 60 cm. What optical flow alone makes of the way
// is off by less than a millimetre, as Oliveira 2020 reports of the same experiment (0.7 mm); the
// filter lags behind.
TEST(Fly, KnowsWhereItIsCarried) {
  FlightSetup setup = hover(0);
  setup.mission = load_mission("lemniscate-carried");
  setup.real_sensors = false;
  setup.flow_rate = 200;
  setup.mambo_estimator.flow_scale = 1;
  setup.mambo_estimator.position = MamboPosition::flow_velocity;
  const FlightResult raw = fly(setup);
  EXPECT_EQ(raw.end, FlightEnd::completed);
  EXPECT_EQ(raw.steps, 0u);
  EXPECT_EQ(raw.metrics[Metric::energy], 0);
  EXPECT_LT(raw.metrics[Metric::estimate_rms], 0.0007);
  setup.mambo_estimator.position = MamboPosition::filtered_velocity;
  EXPECT_LT(fly(setup).metrics[Metric::estimate_rms], 0.005);
  setup.mambo_estimator.position = MamboPosition::flow_velocity;
  setup.flow = FlowModel::simplified;  // and the simplified sensor loses it
  EXPECT_GT(fly(setup).metrics[Metric::estimate_rms], 0.05);
}

// Ten minutes of integrated optical flow drift; images of known marks hold the vehicle in its
// place, and are logged as they come.
TEST(Fly, HoldsItsPlaceByImages) {
  FlightSetup setup = hover(600);
  setup.controller = testing::designed_mambo_cascade();
  setup.seed = 3;
  calibrate_flow(setup);
  EXPECT_GT(fly(setup).metrics[Metric::estimate_rms], 0.1);
  setup.vehicle.sensors.vision = images();
  setup.log = true;
  const FlightResult result = fly(setup);
  EXPECT_EQ(result.end, FlightEnd::completed);
  EXPECT_LT(result.metrics[Metric::estimate_rms], 0.025);
  const auto column = [&](const std::string& name) {
    const auto found = std::find_if(result.log.columns.begin(), result.log.columns.end(),
                                    [&](const LogColumn& c) { return c.name == name; });
    if (found == result.log.columns.end()) throw std::runtime_error("no column " + name);
    return found->values;
  };
  const std::vector<double> seen = column("vision.px"), truth = column("x.px");
  int come = 0;
  for (std::size_t k = 0; k < seen.size(); ++k) {
    if (std::isnan(seen[k])) continue;
    EXPECT_NEAR(seen[k], truth[k - 40], 0.03 * 5) << k;  // of 0.2 s before
    ++come;
  }
  EXPECT_EQ(come, 3000);  // five a second from 0 on, all but the last that are on their way
}

// A battery's log is that of its equations: the voltage sags with the current and the charge.
TEST(Fly, DrawsFromItsBattery) {
  FlightSetup setup = ideal_hover(20);
  Battery battery;
  battery.capacity = 0.55 * 3600;
  battery.full_voltage = battery.rated_voltage = 4.2;
  battery.empty_voltage = 3.3;
  battery.resistance = 0.08;
  battery.idle_power = 1;
  setup.vehicle.battery = battery;
  setup.log = true;
  const FlightResult result = fly(setup);
  EXPECT_EQ(result.end, FlightEnd::completed);
  const std::vector<double>& voltage = result.log.find("battery.voltage")->values;
  const std::vector<double>& current = result.log.find("battery.current")->values;
  const std::vector<double>& charge = result.log.find("battery.charge")->values;
  double sum = 0, energy = 0;
  for (std::size_t i = 0; i < voltage.size(); ++i) {
    const double before = sum;
    sum += current[i] * 0.005;
    energy += voltage[i] * current[i] * 0.005;
    ASSERT_NEAR(charge[i], sum, 1e-9);
    ASSERT_NEAR(voltage[i], 4.2 - 0.9 * before / 1980 - 0.08 * current[i], 1e-9);
  }
  EXPECT_NEAR(energy, result.metrics[Metric::energy] / 0.7 + 1 * 20.005, 1e-6);
}

// At 3000 m the air is thinner, and the same law has to turn the rotors faster for the same weight.
TEST(Fly, FeelsThinnerAir) {
  FlightSetup setup = ideal_hover(60);
  setup.mission.start.in_air = true;
  setup.mission.start.position = {0, 0, -1.1};
  setup.log = true;
  const auto last_speed = [&] { return fly(setup).log.find("x.w1")->values.back(); };
  setup.environment.dynamic = true;
  const double low = last_speed();
  setup.environment.ground_height = 3000;
  const double high = last_speed();
  const double gravity = std::pow((kEarthRadius + 1.1) / (kEarthRadius + 3001.1), 2);
  const double density = standard_atmosphere(3001.1).density / standard_atmosphere(1.1).density;
  EXPECT_NEAR(high / low, std::sqrt(gravity / density), 1e-4);
}

TEST(Fly, RefusesWhatCannotBeFlown) {
  const auto refusal = [](void (*spoil)(FlightSetup&), const std::string& message) {
    FlightSetup setup = hover(1);
    spoil(setup);
    EXPECT_THAT([&] { validate(setup); }, ThrowsMessage<InvalidInput>(HasSubstr(message)));
    EXPECT_THROW((void)fly(setup), InvalidInput);
  };
  refusal([](FlightSetup& s) { std::get<CascadeController>(s.controller).gains.dt = 0; },
          "flight: dt is 0 s, expected a control period of 0.0001 to 1 s");
  refusal([](FlightSetup& s) { s.step = -1; }, "flight: the step is -1 s, expected more than 0");
  refusal([](FlightSetup& s) { s.step = 1e-12; }, "flight: the step is 1e-12 s, expected");
  refusal([](FlightSetup& s) { s.step = std::nan(""); }, "flight: the step is nan s");
  refusal([](FlightSetup& s) { s.duration = 1e9; }, "flight: the duration is 1000000000 s");
  refusal([](FlightSetup& s) { s.flow_rate = -60; },
          "flight: the flow rate is -60 Hz, expected 0 to 10000 Hz");
  refusal(
      [](FlightSetup& s) {
        s.flown = s.vehicle;
        s.flown->rotors.pop_back();
      },
      "flight: the true vehicle has 3 rotors and the vehicle model 4, expected equal numbers");
  refusal([](FlightSetup& s) { s.environment.wind.turbulence = -1; }, "wind: turbulence is -1 m/s");
  refusal([](FlightSetup& s) { s.vehicle.mass = 0; }, "vehicle 'mambo': mass is 0 kg");
  refusal(
      [](FlightSetup& s) {
        s.flown = s.vehicle;
        s.flown->inertia(2, 2) = -1;
      },
      "vehicle 'mambo': inertia is not symmetric and positive definite");
  refusal(
      [](FlightSetup& s) {
        std::get<CascadeController>(s.controller).gains.loops[0].Kp = std::nan("");
      },
      "loop x: Kp is nan, expected a finite number");
  refusal(
      [](FlightSetup& s) {
        StateFeedbackController controller = feedback();
        controller.dt = 0.01;
        s.controller = controller;
      },
      "gains: the sample period is 0.005 s, expected 0.01 s");
  refusal([](FlightSetup& s) { s.mission.start.start_up = -1; }, "mission 'hover': ");
  refusal(
      [](FlightSetup& s) {
        s.mission = load_mission("motor-test");
        s.vehicle.rotors.resize(3);
      },
      "flight: ");
}

TEST(Fly, NamesItsChoices) {
  for (const EstimatorKind kind :
       {EstimatorKind::mambo, EstimatorKind::uquad, EstimatorKind::general, EstimatorKind::truth})
    EXPECT_EQ(estimator_kind(to_string(kind), "x"), kind);
  for (const FlowModel model : {FlowModel::full, FlowModel::simplified, FlowModel::off})
    EXPECT_EQ(flow_model(to_string(model), "x"), model);
  EXPECT_EQ(to_string(FlightEnd::safety_exit), "safety exit");
  EXPECT_THAT(
      [] { (void)estimator_kind("mamba", "--estimator"); },
      ThrowsMessage<InvalidInput>(StrEq("--estimator: no estimator 'mamba', expected mambo, "
                                        "uquad, general, truth; did you mean 'mambo'?")));
  EXPECT_THAT([] { (void)flow_model("simplifed", "--flow"); },
              ThrowsMessage<InvalidInput>(StrEq(
                  "--flow: no flow model 'simplifed', expected full, simplified, off; did you "
                  "mean 'simplified'?")));
}

}  // namespace
}  // namespace quadtune
