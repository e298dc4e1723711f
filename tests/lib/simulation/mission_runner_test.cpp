// SPDX-License-Identifier: Apache-2.0
#include "quadtune/simulation/mission_runner.hpp"

#include <gmock/gmock.h>

#include <cmath>
#include <cstring>
#include <limits>
#include <random>
#include <vector>

#include "matrix_near.hpp"
#include "numbers.hpp"
#include "quadtune/errors.hpp"

namespace quadtune {
namespace {

using Eigen::Vector3d;
using ::testing::ElementsAre;
using testing::MatrixNear;

using testing::kNaN;
using testing::kPi;

// first, first + step, … before last.
std::vector<double> runner_times(double first, double last, double step) {
  std::vector<double> all;
  while (first + static_cast<double>(all.size()) * step < last)
    all.push_back(first + static_cast<double>(all.size()) * step);
  return all;
}

StateVector<double> at_place(const Vector3d& position) {
  StateVector<double> x = StateVector<double>::Zero();
  x.head<3>() = position;
  return x;
}

const StateVector<double> kAnywhere = at_place(Vector3d::Constant(kNaN));

Mission flown_mission(const MissionKind& kind, double duration = 60) {
  Mission mission;
  mission.name = "m";
  mission.duration = duration;
  mission.start.in_air = true;
  mission.start.position = {0, 0, -1};
  mission.kind = kind;
  return mission;
}

// --- the waypoint follower ---

Waypoints corner() {
  Waypoints way;
  way.points = {{0, 0, -1}, {4, 0, -1}, {4, 3, -1}};
  way.look_ahead = 0.5;
  way.transition_radius = 0.25;
  return way;
}

TEST(WaypointFollower, LeadsAheadOfTheProjection) {
  const Waypoints way = corner();
  WaypointProgress progress{1};
  EXPECT_THAT(follow_waypoints(way, {1, 0.7, -1.3}, progress),
              MatrixNear(Vector3d(1.5, 0, -1), 1e-15));
  EXPECT_THAT(follow_waypoints(way, {-3, 1, -1}, progress),  // behind the segment
              MatrixNear(Vector3d(0.5, 0, -1), 1e-15));
  EXPECT_THAT(follow_waypoints(way, {3.7, -0.5, -1}, progress),  // no further than w2
              MatrixNear(Vector3d(4, 0, -1), 0));
  EXPECT_EQ(progress.reached, 1u);
}

TEST(WaypointFollower, BeginsWithTheFirstWaypoint) {
  const Waypoints way = corner();
  WaypointProgress progress;
  EXPECT_EQ(follow_waypoints(way, {2, 0, -1}, progress), way.points[0]);  // on the segment, but …
  EXPECT_EQ(progress.reached, 0u);
  EXPECT_THAT(follow_waypoints(way, {0.25, 0, -1}, progress),
              MatrixNear(Vector3d(0.75, 0, -1), 1e-15));
  EXPECT_EQ(progress.reached, 1u);
}

TEST(WaypointFollower, TurnsWithinTheRadius) {
  const Waypoints way = corner();
  WaypointProgress progress{1};
  (void)follow_waypoints(way, {4 - 0.2501, 0, -1}, progress);
  EXPECT_EQ(progress.reached, 1u);
  EXPECT_THAT(follow_waypoints(way, {4 - 0.2499, 0, -1}, progress),
              MatrixNear(Vector3d(4, 0.5, -1), 1e-15));
  EXPECT_EQ(progress.reached, 2u);
}

// The bisecting plane of the corner at (4, 0) is x + y = 4. Beyond it the vehicle is nearer to the
// line of the next segment, though no nearer to the waypoint than the radius.
TEST(WaypointFollower, TurnsBeyondTheBisectingPlane) {
  const Waypoints way = corner();
  for (const Vector3d& short_of : {Vector3d(2.999, 1, -1), Vector3d(5.5, -1.501, -1)}) {
    WaypointProgress progress{1};
    (void)follow_waypoints(way, short_of, progress);
    EXPECT_EQ(progress.reached, 1u) << short_of.transpose();
  }
  for (const Vector3d& beyond : {Vector3d(3.001, 1, -1), Vector3d(5.5, -1.499, -1)}) {
    WaypointProgress progress{1};
    const Vector3d reference = follow_waypoints(way, beyond, progress);
    EXPECT_EQ(progress.reached, 2u) << beyond.transpose();
    EXPECT_THAT(reference, MatrixNear(Vector3d(4, std::max(beyond.y(), 0.0) + 0.5, -1), 1e-12));
  }
}

// Where the way turns straight back there is no bisector: the plane is square to the segment.
TEST(WaypointFollower, TurnsBackAtTheEndOfTheSegment) {
  Waypoints way = corner();
  way.points = {{0, 0, -1}, {4, 0, -1}, {1, 0, -1}};
  WaypointProgress progress{1};
  (void)follow_waypoints(way, {3.9, 1, -1}, progress);
  EXPECT_EQ(progress.reached, 1u);
  EXPECT_THAT(follow_waypoints(way, {4.1, 1, -1}, progress),
              MatrixNear(Vector3d(3.5, 0, -1), 1e-12));
  EXPECT_EQ(progress.reached, 2u);
}

TEST(WaypointFollower, StaysAtTheLast) {
  const Waypoints way = corner();
  WaypointProgress progress{2};
  // No plane ends the last segment: the vehicle is beyond, and still led back.
  EXPECT_EQ(follow_waypoints(way, {4, 5, -1}, progress), way.points[2]);
  EXPECT_EQ(progress.reached, 2u);
  EXPECT_EQ(follow_waypoints(way, {4, 3.2, -1}, progress), way.points[2]);
  EXPECT_EQ(progress.reached, 3u);
  EXPECT_EQ(follow_waypoints(way, {0, 0, -1}, progress), way.points[2]);
}

TEST(WaypointFollower, IsNotMovedByWhatIsNotFinite) {
  const Waypoints way = corner();
  for (std::size_t reached = 0; reached <= 3; ++reached) {
    WaypointProgress progress{reached};
    EXPECT_TRUE(follow_waypoints(way, Vector3d::Constant(kNaN), progress).allFinite());
    EXPECT_EQ(progress.reached, reached);
  }
}

// A vehicle that goes where it is led, at most 2 cm a period, comes by every waypoint, in order,
// one at a time, and ends at the last. Where the rule lets it cut a corner it is beyond the plane.
TEST(WaypointFollower, EndsAtTheLastWaypointWhateverTheWay) {
  std::mt19937_64 random(11);
  std::uniform_real_distribution<double> place(-5, 5), distance(0.1, 1);
  for (int trial = 0; trial < 200; ++trial) {
    Waypoints way;
    const std::size_t count = 2 + random() % 8;
    while (way.points.size() < count)
      way.points.push_back({place(random), place(random), place(random) - 6});
    way.look_ahead = distance(random);
    way.transition_radius = distance(random);
    Vector3d position(place(random), place(random), -1);
    WaypointProgress progress;
    int periods = 0;
    while (progress.reached < count && ++periods < 20000) {
      const std::size_t before = progress.reached;
      const Vector3d off = follow_waypoints(way, position, progress) - position;
      ASSERT_LE(progress.reached, before + 1);
      ASSERT_GE(progress.reached, before);
      position += off.norm() < 0.02 ? off : Vector3d(off.normalized() * 0.02);
    }
    ASSERT_EQ(progress.reached, count) << trial;
    for (int i = 0; i < 1000; ++i) {
      const Vector3d off = follow_waypoints(way, position, progress) - position;
      position += off.norm() < 0.02 ? off : Vector3d(off.normalized() * 0.02);
    }
    EXPECT_THAT(position, MatrixNear(way.points.back(), 1e-12));
  }
}

// --- the runner: phases and every kind ---

TEST(MissionRunner, TakesOffInPhases) {
  Mission mission = flown_mission(Hover{{1, 2, -1.1}, 0.4});
  mission.start = {};
  mission = with_thrust_take_off(mission);
  MissionRunner runner(mission);
  EXPECT_FALSE(runner.depends_on_estimate());
  const auto phase = [&](double t) { return runner.at(t, kAnywhere).phase; };
  EXPECT_EQ(phase(0), FlightPhase::start_up);
  EXPECT_EQ(runner.event(), MissionEvent::start_up);
  EXPECT_EQ(phase(0.495), FlightPhase::start_up);
  EXPECT_EQ(runner.event(), MissionEvent::none);
  EXPECT_EQ(phase(0.5), FlightPhase::take_off);
  EXPECT_EQ(runner.event(), MissionEvent::take_off);
  EXPECT_EQ(phase(1.495), FlightPhase::take_off);
  EXPECT_EQ(phase(1.5), FlightPhase::flying);
  EXPECT_EQ(runner.event(), MissionEvent::flying);
  const Reference<double> reference = runner.at(99, kAnywhere);
  EXPECT_EQ(reference.position, Vector3d(1, 2, -1.1));
  EXPECT_EQ(reference.velocity, Vector3d::Zero().eval());
  EXPECT_EQ(reference.yaw, 0.4);
  EXPECT_TRUE(reference.track_position);
  EXPECT_EQ(runner.event(), MissionEvent::none);
}

TEST(MissionRunner, FliesAtOnceInTheAir) {
  MissionRunner runner(flown_mission(Hover{{0, 0, -1}, 0}));
  EXPECT_EQ(runner.at(0, kAnywhere).phase, FlightPhase::flying);
  EXPECT_EQ(runner.event(), MissionEvent::flying);
}

TEST(MissionRunner, RefusesABadMission) {
  EXPECT_THROW(MissionRunner(flown_mission(Script{})), InvalidInput);
}

TEST(MissionRunner, RunsAScriptOfStepsAndRamps) {
  const Mission mission = flown_mission(Script{{{0, 0, {0, 0, -1}, 0},
                                                {2, 2, {1, 0, -1}, 0},
                                                {4, 6, {1, 3, -2}, 5},
                                                {6, 6, {1, 3, -1}, 5}}});
  const auto check = [&](MissionRunner& runner, double t, const Vector3d& position,
                         const Vector3d& velocity, double yaw) {
    const Reference<double> reference = runner.at(t, kAnywhere);
    EXPECT_THAT(reference.position, MatrixNear(position, 1e-14)) << t;
    EXPECT_THAT(reference.velocity, MatrixNear(velocity, 1e-14)) << t;
    EXPECT_NEAR(reference.yaw, yaw, 1e-14) << t;
  };
  const Vector3d still = Vector3d::Zero();
  MissionRunner runner(mission);
  check(runner, 0, {0, 0, -1}, still, 0);
  check(runner, 1.999, {0, 0, -1}, still, 0);
  check(runner, 2, {1, 0, -1}, still, 0);
  check(runner, 4, {1, 0, -1}, {0, 1.5, -0.5}, 0);
  check(runner, 5, {1, 1.5, -1.5}, {0, 1.5, -0.5}, 2.5);
  check(runner, 6, {1, 3, -1}, still, 5);
  check(runner, 1e6, {1, 3, -1}, still, 5);
  // Asked at random times a runner says the same: its cursor is a shortcut only.
  std::mt19937_64 random(2);
  for (int i = 0; i < 200; ++i) {
    const double t = 0.05 * static_cast<double>(random() % 160);
    MissionRunner fresh(mission);
    const Reference<double> want = fresh.at(t, kAnywhere);
    check(runner, t, want.position, want.velocity, want.yaw);
  }
}

TEST(MissionRunner, RampsFromTheFirstInstant) {
  MissionRunner runner(flown_mission(Script{{{0, 0, {0, 0, -1}, 0}, {0, 4, {4, 0, -1}, 0}}}));
  EXPECT_THAT(runner.at(0, kAnywhere).position, MatrixNear(Vector3d(0, 0, -1), 0));
  EXPECT_THAT(runner.at(0, kAnywhere).velocity, MatrixNear(Vector3d(1, 0, 0), 0));
  EXPECT_THAT(runner.at(3, kAnywhere).position, MatrixNear(Vector3d(3, 0, -1), 1e-15));
}

// Velocity is the derivative of position wherever there is no step.
TEST(MissionRunner, SuppliesTheVelocityOfSmoothReferences) {
  for (const char* name : {"line", "circle", "lemniscate", "lemniscate-carried"}) {
    const Mission mission = load_mission(name);
    MissionRunner runner(mission);
    constexpr double kStep = 1e-4;
    for (const double t : runner_times(kStep, mission.duration, 0.0317)) {
      const Vector3d before = runner.at(t - kStep, kAnywhere).position;
      const Vector3d velocity = runner.at(t, kAnywhere).velocity;
      const Vector3d after = runner.at(t + kStep, kAnywhere).position;
      EXPECT_THAT(velocity, MatrixNear((after - before) / (2 * kStep), 1e-7)) << name << t;
    }
  }
}

TEST(MissionRunner, WindsTheNoseFromTheStartsYaw) {
  CirclePath circle{{-1, 0, -1}, 1, 0, 0.5, 2, {1, 1, Nose::ahead, 0}};
  Mission mission = flown_mission(circle);
  mission.start.yaw = kPi / 2 + 6 * kPi + 0.1;
  MissionRunner runner(mission);
  EXPECT_NEAR(runner.at(0, kAnywhere).yaw, kPi / 2 + 6 * kPi, 1e-12);
  EXPECT_NEAR(runner.at(59, kAnywhere).yaw, kPi / 2 + 10 * kPi, 1e-12);
}

TEST(MissionRunner, FollowsWaypointsOnlyOnceItFlies) {
  Waypoints way = corner();
  way.nose = Nose::ahead;
  Mission mission = flown_mission(way);
  mission.start = {};
  mission = with_thrust_take_off(mission);
  mission.start.yaw = 3;
  MissionRunner runner(mission);
  EXPECT_TRUE(runner.depends_on_estimate());
  // Reached on the ground does not count.
  EXPECT_EQ(runner.at(1, at_place({0, 0, -1})).position, way.points[0]);
  EXPECT_EQ(runner.at(1.4, at_place({0, 0, -1})).position, way.points[0]);
  EXPECT_EQ(runner.event(), MissionEvent::none);
  EXPECT_EQ(runner.at(1.5, at_place({1, 0, -1})).position, way.points[0]);
  EXPECT_EQ(runner.at(1.5, at_place({1, 0, -1})).yaw, 3);
  const Reference<double> first = runner.at(1.6, at_place({0.1, 0, -1}));
  EXPECT_EQ(runner.event(), MissionEvent::waypoint);
  EXPECT_THAT(first.position, MatrixNear(Vector3d(0.6, 0, -1), 1e-15));
  EXPECT_EQ(first.yaw, 0);  // north, the nearest north to 3 rad
  EXPECT_EQ(first.velocity, Vector3d::Zero().eval());
  const Reference<double> second = runner.at(9, at_place({4, 0, -1}));
  EXPECT_NEAR(second.yaw, kPi / 2, 1e-15);
  const Reference<double> last = runner.at(20, at_place({4, 3, -1}));
  EXPECT_EQ(last.position, way.points[2]);
  EXPECT_NEAR(last.yaw, kPi / 2, 1e-15);
}

// A square flown twice to the left: the yaw goes on beyond -π, always the shorter way.
TEST(MissionRunner, UnwrapsTheNoseOfWaypoints) {
  Waypoints way;
  for (int i = 0; i < 9; ++i)
    way.points.push_back({i % 4 == 1 || i % 4 == 2 ? 1.0 : 0.0, i % 4 >= 2 ? -1.0 : 0.0, -1});
  way.look_ahead = way.transition_radius = 0.1;
  way.nose = Nose::ahead;
  MissionRunner runner(flown_mission(way));
  for (int i = 0; i < 8; ++i)
    EXPECT_NEAR(runner.at(i, at_place(way.points[static_cast<std::size_t>(i)])).yaw, -i * kPi / 2,
                1e-12);
}

TEST(MissionRunner, DoesWhatTheKeysSay) {
  Keys keys{{1, 2, -1}, 0.5, {}};
  const std::string pressed = "ikyhjldawse";
  for (std::size_t i = 0; i < pressed.size(); ++i)
    keys.presses.push_back({static_cast<double>(i + 1), pressed[i]});
  keys.presses.insert(keys.presses.end() - 1, {10.5, 'r'});
  MissionRunner runner(flown_mission(keys));
  EXPECT_FALSE(runner.depends_on_estimate());
  const auto height = [&](double t) { return -runner.at(t, kAnywhere).position.z(); };
  EXPECT_EQ(height(0.999), 1);
  EXPECT_NEAR(height(1), 1.2, 1e-15);
  EXPECT_NEAR(height(2), 1, 1e-15);
  EXPECT_NEAR(height(3), 1.6, 1e-15);
  EXPECT_NEAR(height(4), 1, 1e-15);
  EXPECT_NEAR(runner.at(5, kAnywhere).yaw, 0.7, 1e-15);
  EXPECT_NEAR(runner.at(6, kAnywhere).yaw, 0.5, 1e-15);
  EXPECT_TRUE(runner.at(6, kAnywhere).track_position);
  Reference<double> reference = runner.at(7, kAnywhere);
  EXPECT_FALSE(reference.track_position);
  EXPECT_EQ(reference.roll, 0.05);
  EXPECT_EQ(reference.pitch, 0);
  EXPECT_EQ(runner.at(8, kAnywhere).roll, 0);
  EXPECT_FALSE(runner.at(8, kAnywhere).track_position);
  EXPECT_EQ(runner.at(9, kAnywhere).pitch, 0.05);
  EXPECT_EQ(runner.at(10, kAnywhere).pitch, 0);
  reference = runner.at(10.5, kAnywhere);
  EXPECT_TRUE(reference.track_position);
  EXPECT_EQ(reference.position, Vector3d(0, 0, -1));
  EXPECT_EQ(reference.yaw, 0.5);
  EXPECT_EQ(reference.phase, FlightPhase::flying);
  EXPECT_EQ(runner.at(11, kAnywhere).phase, FlightPhase::off);
  EXPECT_EQ(runner.event(), MissionEvent::abort);
  EXPECT_EQ(runner.at(12, kAnywhere).phase, FlightPhase::off);
  EXPECT_EQ(runner.event(), MissionEvent::none);
}

TEST(MissionRunner, KeysDoNotGoBelowTheGround) {
  MissionRunner runner(flown_mission(Keys{{0, 0, -1}, 0, {{1, 'h'}, {2, 'h'}, {3, 'i'}}}));
  EXPECT_EQ(runner.at(2, kAnywhere).position.z(), 0);
  EXPECT_EQ(runner.at(3, kAnywhere).position.z(), -0.2);
}

TEST(MissionRunner, AbortsOnTheGroundToo) {
  Mission mission = flown_mission(Keys{{0, 0, -1}, 0, {{0.2, 'e'}}});
  mission.start = {};
  mission = with_thrust_take_off(mission);
  MissionRunner runner(mission);
  EXPECT_EQ(runner.at(0, kAnywhere).phase, FlightPhase::start_up);
  EXPECT_EQ(runner.at(0.3, kAnywhere).phase, FlightPhase::off);
  EXPECT_EQ(runner.event(), MissionEvent::abort);
  EXPECT_EQ(runner.at(5, kAnywhere).phase, FlightPhase::off);
}

TEST(MissionRunner, RunsMotorsByTheirNumbers) {
  MissionRunner runner(load_mission("motor-test"));
  EXPECT_FALSE(runner.depends_on_estimate());
  const auto motors = [&](double t) {
    const Reference<double> reference = runner.at(t, kAnywhere);
    EXPECT_EQ(reference.phase, FlightPhase::motors);
    return std::vector<double>(reference.motors.data(), reference.motors.data() + 5);
  };
  EXPECT_THAT(motors(0), ElementsAre(-1, -1, -1, -1, -1));
  EXPECT_THAT(motors(1), ElementsAre(0.1, -1, 0.1, -1, -1));
  EXPECT_THAT(motors(2.999), ElementsAre(0.1, -1, 0.1, -1, -1));
  EXPECT_THAT(motors(3), ElementsAre(-1, 0.1, -1, 0.1, -1));
  EXPECT_THAT(motors(5), ElementsAre(-1, -1, -1, -1, -1));
}

TEST(MissionRunner, SaysWhereACarriedVehicleIs) {
  MissionRunner runner(load_mission("lemniscate-carried"));
  EXPECT_FALSE(runner.depends_on_estimate());
  const Reference<double> reference = runner.at(5, kAnywhere);
  EXPECT_EQ(reference.phase, FlightPhase::off);
  EXPECT_EQ(reference.position.z(), -0.6);
  EXPECT_GT(reference.velocity.norm(), 0.01);
}

/// Believed at a height, sinking at a speed.
StateVector<double> coming_down(double height, double speed) {
  StateVector<double> x = at_place({1, 2, -height});
  x(kVelocity + 2) = speed;
  return x;
}

Mission landing_from_a_metre() {
  Mission mission = flown_mission(Hover{{1, 2, -1}, 0.3});
  mission.landing = Landing{10, 0.5, 0.05};
  return mission;
}

TEST(MissionRunner, LandsAndSwitchesTheMotorsOff) {
  MissionRunner runner(landing_from_a_metre());
  EXPECT_TRUE(runner.depends_on_estimate());
  EXPECT_EQ(runner.at(9.99, at_place({1, 2, 0})).phase, FlightPhase::flying);  // low, but not yet
  Reference<double> reference = runner.at(11, coming_down(0.6, 0.5));
  EXPECT_EQ(runner.event(), MissionEvent::landing);
  EXPECT_THAT(reference.position, MatrixNear(Vector3d(1, 2, -0.5), 1e-15));
  EXPECT_EQ(reference.velocity, Vector3d(0, 0, 0.5));
  EXPECT_EQ(reference.yaw, 0.3);
  EXPECT_EQ(reference.phase, FlightPhase::flying);
  // It is believed to be on the ground, but it sinks.
  reference = runner.at(20, coming_down(0.04, 0.5));
  EXPECT_EQ(reference.position.z(), 0.5);
  EXPECT_EQ(reference.velocity.z(), 0);
  EXPECT_EQ(reference.phase, FlightPhase::flying);
  EXPECT_EQ(runner.at(20.39, coming_down(0.04, 0.1)).phase, FlightPhase::flying);
  reference = runner.at(20.41, coming_down(0.04, 0.1));
  EXPECT_EQ(reference.phase, FlightPhase::off);
  EXPECT_EQ(runner.event(), MissionEvent::motors_off);
  EXPECT_EQ(reference.position, Vector3d(1, 2, 0));
  EXPECT_EQ(runner.at(22, at_place({1, 2, -5})).phase, FlightPhase::off);  // for good
  EXPECT_EQ(runner.event(), MissionEvent::none);
}

// The ground is where it no longer sinks, however high that is believed to be.
TEST(MissionRunner, LandsByContact) {
  const auto rests_at = [](double height, double until) {
    MissionRunner runner(landing_from_a_metre());
    for (int k = 0; k < 100; ++k) (void)runner.at(10 + 0.01 * k, coming_down(1.3, 0.5));
    FlightPhase phase = FlightPhase::flying;
    for (int k = 0; 11 + 0.01 * k < until; ++k)
      phase = runner.at(11 + 0.01 * k, coming_down(height, 0)).phase;
    return phase;
  };
  EXPECT_EQ(rests_at(0.4, 11.9), FlightPhase::flying);  // the reference is above the ground
  EXPECT_EQ(rests_at(0.4, 12.1), FlightPhase::off);
  EXPECT_EQ(rests_at(-0.3, 11.5), FlightPhase::off);
  EXPECT_EQ(rests_at(0.1, 12.05), FlightPhase::flying);  // near its reference
  EXPECT_EQ(rests_at(0.1, 12.2), FlightPhase::off);
}

TEST(MissionRunner, NeverLandsInTheAirAVehicleThatDoesNotSink) {
  MissionRunner runner(landing_from_a_metre());
  for (int k = 0; k < 2000; ++k)
    ASSERT_EQ(runner.at(10 + 0.01 * k, coming_down(1, 0.05)).phase, FlightPhase::flying) << k;
}

TEST(MissionRunner, NeverLandsOnAnEstimateThatIsNotFinite) {
  Mission mission = flown_mission(Hover{{1, 2, -1}, 0.3});
  mission.landing = Landing{10, 0.5, 0.05};
  MissionRunner runner(mission);
  EXPECT_EQ(runner.at(30, kAnywhere).phase, FlightPhase::flying);
}

// In flight by attitude the reference's place is stale: the way down is where the vehicle is.
TEST(MissionRunner, LandsWhereThePilotTookIt) {
  Mission mission = flown_mission(Keys{{0, 0, -1}, 0, {{1, 'd'}, {12, 'e'}}});
  mission.landing = Landing{10, 0.5, 0.05};
  MissionRunner runner(mission);
  const Reference<double> reference = runner.at(10, at_place({3, 4, -1.2}));
  EXPECT_EQ(reference.position, Vector3d(3, 4, -1));
  EXPECT_TRUE(reference.track_position);
  EXPECT_EQ(reference.roll, 0);
  EXPECT_EQ(runner.at(11, at_place({9, 9, -1})).position, Vector3d(3, 4, -0.5));
  EXPECT_EQ(runner.at(12, at_place({9, 9, -1})).phase, FlightPhase::off);  // abort still counts
  EXPECT_EQ(runner.event(), MissionEvent::abort);
  // The motors are off already, and where it lies is no landing.
  EXPECT_EQ(runner.at(13, at_place({9, 9, 0})).phase, FlightPhase::off);
  EXPECT_EQ(runner.event(), MissionEvent::none);
}

TEST(MissionRunner, LandsFromAPathWhereItIsThen) {
  Mission mission = load_mission("line");
  mission.landing = Landing{5, 0.5, 0.05};
  const Vector3d there = MissionRunner(load_mission("line")).at(5, kAnywhere).position;
  MissionRunner runner(mission);
  // However late the first call after the begin, the landing begins from there.
  EXPECT_THAT(runner.at(6, at_place({0, 0, -1})).position,
              MatrixNear(there + Vector3d(0, 0, 0.5), 1e-15));
}

// A copy goes on from where the original is, and both give the same bytes.
TEST(MissionRunner, CopiesGoOnAlike) {
  for (const std::string& name : built_in_missions()) {
    const Mission mission = load_mission(name);
    MissionRunner runner(mission), same(mission);
    StateVector<double> x = at_place(mission.start.position);
    for (const double t : runner_times(0, mission.duration, 0.05)) {
      if (t > mission.duration / 2) same = MissionRunner(runner);
      const Reference<double> a = runner.at(t, x);
      const Reference<double> b = same.at(t, x);
      ASSERT_EQ(a.position, b.position) << name << t;
      ASSERT_EQ(a.velocity, b.velocity);
      ASSERT_EQ(a.yaw, b.yaw);
      ASSERT_EQ(a.phase, b.phase);
      ASSERT_EQ(runner.event(), same.event());
      ASSERT_TRUE(a.position.allFinite() && a.velocity.allFinite() && std::isfinite(a.yaw));
      x.head<3>() += 0.2 * (a.position - x.head<3>());
      same = MissionRunner(runner);
    }
  }
}

// A vehicle that goes where it is asked flies every built-in mission to its end.
TEST(MissionRunner, BuiltInMissionsEndWhereTheyShould) {
  const auto fly = [](const char* name) {
    const Mission mission = load_mission(name);
    MissionRunner runner(mission);
    StateVector<double> x = at_place(mission.start.position);
    Reference<double> reference;
    for (const double t : runner_times(0, mission.duration, 0.005)) {
      reference = runner.at(t, x);
      const Vector3d off = reference.position - x.head<3>();
      if (reference.phase != FlightPhase::flying) continue;
      x.head<3>() += 0.01 * off;
      x(2) = std::min(x(2), 0.0);
    }
    return std::pair(x.head<3>().eval(), reference.phase);
  };
  EXPECT_THAT(fly("waypoints").first, MatrixNear(Vector3d(0, 0, -1.6), 1e-3));
  EXPECT_EQ(fly("take-off-and-land").second, FlightPhase::off);
  EXPECT_EQ(fly("hover").second, FlightPhase::flying);
  EXPECT_THAT(fly("keys").first, MatrixNear(Vector3d(0, 0, -1.1), 1e-3));
}

TEST(MissionRunner, ReadsBadTimesAsTheBeginning) {
  MissionRunner runner(load_mission("step-north"));
  MissionRunner from_ground(load_mission("hover"));
  for (const double t : {kNaN, -1.0, -std::numeric_limits<double>::infinity()}) {
    EXPECT_EQ(runner.at(t, kAnywhere).position, Vector3d(0, 0, -1.1));
    EXPECT_EQ(from_ground.at(t, kAnywhere).phase, FlightPhase::start_up);
  }
  EXPECT_EQ(runner.at(std::numeric_limits<double>::infinity(), kAnywhere).position,
            Vector3d(1, 0, -1.1));
}

TEST(MissionEvents, HaveNames) {
  EXPECT_EQ(to_string(MissionEvent::none), "");
  EXPECT_EQ(to_string(MissionEvent::motors_off), "motors_off");
  EXPECT_EQ(to_string(MissionEvent::abort), "abort");
}

}  // namespace
}  // namespace quadtune
