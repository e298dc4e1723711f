// SPDX-License-Identifier: Apache-2.0
// The flying loops of autopilots, compared with their parameters by hand and with the margins of
// the same loops in continuous time.
#include "quadtune/workbench/firmware/firmware_law.hpp"

#include <gmock/gmock.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <memory>
#include <numbers>

#include "plants/firmware_vehicles.hpp"
#include "quadtune/errors.hpp"
#include "quadtune/exports/firmware.hpp"
#include "quadtune/workbench/design/vehicle_cascade.hpp"
#include "quadtune/workbench/firmware/firmware_import.hpp"
#include "quadtune/workbench/flight/fly.hpp"
#include "source_folder.hpp"

namespace quadtune {
namespace {

using ::testing::HasSubstr;

constexpr std::array<CascadeAxis, 3> kTurningAxes = {CascadeAxis::roll, CascadeAxis::pitch,
                                                     CascadeAxis::yaw};
constexpr std::array<FirmwareKind, 4> kFirmwares = {
    FirmwareKind::px4, FirmwareKind::ardupilot, FirmwareKind::betaflight, FirmwareKind::crazyflie};

Vehicle vehicle_of_file(const std::string& name) {
  return load_vehicle(testing::source_folder() + "/vehicles/" + name + ".toml");
}

StoredParameters defaults_of(FirmwareKind kind) { return {firmware(kind, {}, "test"), {}}; }

/// Loops of a pilot, for the tests that do not fly them.
CascadeGains some_pilot() {
  CascadeGains pilot;
  for (const CascadeAxis axis : kAllCascadeAxes) {
    PidLoop loop = cascade_loop(axis);
    loop.Kp = cascade_sign(axis) * 0.2;
    loop.Kd = -cascade_sign(axis) * 0.2;
    pilot.loops.push_back(loop);
  }
  return pilot;
}

std::unique_ptr<FlightLaw> law_of(const Vehicle& vehicle, const StoredParameters& parameters,
                                  const CascadeGains& pilot = {}) {
  return firmware_controller(vehicle, parameters, pilot).make(vehicle);
}

Estimate<double> at(const StateVector<double>& x) {
  Estimate<double> estimate;
  estimate.x = x;
  return estimate;
}

Reference<double> level() {
  Reference<double> reference;
  reference.track_position = false;
  return reference;
}

/// Whether a rotation about one axis decays under the firmware's law. The axis is integrated
/// separately: the torque is held over a sample and follows with the motor lag.
/// @param gain  factor of the vehicle's response to the torque
bool dies_out(const Vehicle& vehicle, const StoredParameters& parameters, int axis,
              const FirmwareTurn& turn, double gain) {
  const OwnController controller = firmware_controller(vehicle, parameters, {});
  const std::unique_ptr<FlightLaw> law = controller.make(vehicle);
  constexpr int kParts = 4;
  constexpr double kTime = 20;
  const double h = controller.dt / kParts;
  double angle = 1e-5, rate = 1e-4, torque = 0, early = 0, late = 0;
  for (int k = 0; k * controller.dt < kTime; ++k) {
    const double t = k * controller.dt;
    StateVector<double> x = StateVector<double>::Zero();
    x(3 + axis) = angle;
    x(9 + axis) = rate;
    const double asked = law->command(at(x), level())(1 + axis);
    for (int i = 0; i < kParts; ++i) {
      const double before = torque;
      torque = asked + (torque - asked) * std::exp(-h / turn.lag);
      const double acceleration =
          (0.5 * (before + torque) * gain - turn.damping * rate) / turn.inertia;
      angle += h * (rate + 0.5 * h * acceleration);
      rate += h * acceleration;
    }
    double& max = t > 0.5 * kTime ? late : early;
    if (t > 0.9 * kTime || (t > 0.1 * kTime && t < 0.2 * kTime))
      max = std::max(max, std::abs(rate));
  }
  return late < 0.7 * early;  // a growing one ends at its limits
}

// The gain margin of the loop in continuous time is the factor by which the vehicle may respond
// more strongly before the sampled law with its filters oscillates.
TEST(FirmwareLaw, ShakesWhereTheGainMarginEnds) {
  int compared = 0;
  for (const std::string name : {"quad-450", "crazyflie"}) {
    Vehicle vehicle = vehicle_of_file(name);
    vehicle.motor.delay = 0;
    if (vehicle.sensors.gyroscope) vehicle.sensors.gyroscope->delay = 0;
    for (Rotor& rotor : vehicle.rotors) rotor.inertia = 0;  // which acts in yaw before the lag
    for (const FirmwareKind kind : kFirmwares) {
      const StoredParameters parameters = defaults_of(kind);
      for (const FirmwareTurn& turn : firmware_turns(parameters.firmware, vehicle, {})) {
        const auto axis =
            static_cast<int>(std::find(kTurningAxes.begin(), kTurningAxes.end(), turn.gains.axis) -
                             kTurningAxes.begin());
        if (!turn.whole.stable || !std::isfinite(turn.whole.gain_margin)) continue;
        ++compared;
        const auto holds = [&](double factor) {
          return dies_out(vehicle, parameters, axis, turn, factor);
        };
        // The differencing of D and the sampling of the filters reduce it: by 4 % at 400 and 800
        // Hz, by 19 % for the Crazyflie, whose D has a period of 2 ms and no filter.
        const double min = kind == FirmwareKind::crazyflie ? 0.78 : 0.93;
        EXPECT_TRUE(holds(min * turn.whole.gain_margin))
            << name << " " << to_string(kind) << " " << to_string(turn.gains.axis);
        EXPECT_FALSE(holds(1.05 * turn.whole.gain_margin))
            << name << " " << to_string(kind) << " " << to_string(turn.gains.axis);
      }
    }
  }
  EXPECT_GE(compared, 14);
}

// At rest the filters have the values of their inputs and the integrals are 0: P A e plus FF.
TEST(FirmwareLaw, FirstTorqueIsThatOfTheGains) {
  const Vehicle vehicle = testing::crazyflie_vehicle();
  for (const FirmwareKind kind : kFirmwares) {
    const StoredParameters parameters = defaults_of(kind);
    for (const FirmwareLoop& loop : firmware_loops(parameters.firmware, vehicle, {})) {
      if (loop.axis == CascadeAxis::x || loop.axis == CascadeAxis::y ||
          loop.axis == CascadeAxis::altitude)
        continue;
      const int axis = loop.axis == CascadeAxis::roll ? 0 : loop.axis == CascadeAxis::pitch ? 1 : 2;
      const std::unique_ptr<FlightLaw> law = law_of(vehicle, parameters);
      StateVector<double> x = StateVector<double>::Zero();
      x(3 + axis) = -0.01;
      x(9 + axis) = 0.02;
      const Eigen::VectorXd wrench = law->command(at(x), level());
      const double asked = loop.outer * 0.01;
      EXPECT_NEAR(wrench(1 + axis), loop.scale * (loop.P * (asked - 0.02) + loop.forward * asked),
                  1e-12 * loop.scale * loop.P)
          << to_string(kind) << " " << to_string(loop.axis);
    }
  }
}

// A torque acts one sample after its measurement, as assumed in the margins.
TEST(FirmwareLaw, TorqueComesOneSampleLate) {
  const Vehicle vehicle = testing::crazyflie_vehicle();
  const std::unique_ptr<FlightLaw> law = law_of(vehicle, defaults_of(FirmwareKind::crazyflie));
  const StateVector<double> rest = StateVector<double>::Zero();
  StateVector<double> tilted = rest;
  tilted(3) = 0.01;
  (void)law->command(at(rest), level());
  EXPECT_EQ(law->command(at(tilted), level())(1), 0);
  EXPECT_LT(law->command(at(tilted), level())(1), 0);
}

// Signs: below its set point the vehicle climbs, south of it it pitches nose down, which is
// negative, west of it it rolls to the right, and it turns to its heading the short way.
TEST(FirmwareLaw, PushesTowardsItsPlace) {
  const Vehicle vehicle = vehicle_of_file("quad-450");
  for (const FirmwareKind kind : kFirmwares) {
    const StoredParameters parameters = defaults_of(kind);
    const CascadeGains pilot = some_pilot();
    const auto wrench_at = [&](int state, double value, double yaw_reference = 0) {
      const std::unique_ptr<FlightLaw> law = law_of(vehicle, parameters, pilot);
      StateVector<double> x = StateVector<double>::Zero();
      x(state) = value;
      Reference<double> reference;
      reference.yaw = yaw_reference;
      return Eigen::VectorXd(law->command(at(x), reference));
    };
    const double rest = wrench_at(0, 0)(0);
    EXPECT_GT(wrench_at(2, 0.5)(0), rest) << to_string(kind);
    EXPECT_LT(wrench_at(2, -0.5)(0), rest) << to_string(kind);
    EXPECT_LT(wrench_at(0, -0.5)(2), 0) << to_string(kind);
    EXPECT_GT(wrench_at(1, -0.5)(1), 0) << to_string(kind);
    EXPECT_GT(wrench_at(5, -0.2)(3), 0) << to_string(kind);
    EXPECT_LT(wrench_at(5, -3, 3)(3), 0) << to_string(kind) << ": -3 to 3 is 0.28 to the left";
    // Along the heading: for a vehicle that faces east, a position in the east is ahead.
    const std::unique_ptr<FlightLaw> law = law_of(vehicle, parameters, pilot);
    StateVector<double> x = StateVector<double>::Zero();
    x(5) = std::numbers::pi / 2;
    Reference<double> east;
    east.position = {0, 0.5, 0};
    east.yaw = x(5);
    const Eigen::VectorXd wrench = law->command(at(x), east);
    EXPECT_LT(wrench(2), 0) << to_string(kind);
    EXPECT_NEAR(wrench(1), 0, 1e-12) << to_string(kind);
  }
}

// A persistent rate error fills the integral: I e t, up to the firmware's limit.
TEST(FirmwareLaw, IntegralGrowsToItsLimit) {
  const Vehicle vehicle = testing::sih_vehicle();
  const StoredParameters parameters = {
      firmware(FirmwareKind::px4, {"1.15", ""}, "test"),
      {{"MC_ROLL_P", 0}, {"MC_ROLLRATE_P", 0}, {"MC_ROLLRATE_D", 0}, {"MC_ROLLRATE_I", 0.5}}};
  const double scale = std::sqrt(8.0);  // N m per unit: 2 √2 · 0.2 m · 5 N
  const auto torque_after = [&](int samples, double excess) {
    const std::unique_ptr<FlightLaw> law = law_of(vehicle, parameters);
    StateVector<double> x = StateVector<double>::Zero();
    x(9) = -0.1;
    double torque = 0;
    for (int i = 0; i < samples; ++i) {
      const Eigen::VectorXd asked = law->command(at(x), level());
      torque = asked(1);
      Eigen::VectorXd made = asked;
      made(1) -= excess;
      law->on_realized(asked, made);
    }
    return torque;
  };
  // 802 samples of 1/800 s; the last two have no effect yet.
  EXPECT_NEAR(torque_after(802, 0), scale * 0.5 * 0.1 * 1.0, 1e-9);
  EXPECT_NEAR(torque_after(80000, 0), scale * 0.3, 1e-9);
  // If the motors saturate, the integral stops in this direction only.
  EXPECT_NEAR(torque_after(802, 0.01), scale * 0.5 * 0.1 / 800, 1e-9);
  EXPECT_NEAR(torque_after(802, -0.01), scale * 0.5 * 0.1, 1e-9);
}

/// Tilt set point of the law, from the torques of P only: [ahead, right] [rad].
Eigen::Vector2d tilt_asked(FlightLaw& law, const StateVector<double>& x,
                           const Reference<double>& reference, const Vehicle& vehicle,
                           const StoredParameters& parameters) {
  const std::vector<FirmwareLoop> loops =
      firmware_loops(parameters.firmware, vehicle, parameters.values);
  const Eigen::VectorXd wrench = law.command(at(x), reference);
  const auto angle = [&](CascadeAxis axis, int entry) {
    const FirmwareLoop& loop = loops[index_of(axis)];
    return wrench(entry) / (loop.scale * loop.P * loop.outer);
  };
  return {-angle(CascadeAxis::pitch, 2), angle(CascadeAxis::roll, 1)};
}

// The first tilt for a position error of 0.3 m: scale P A e, without an integral, in each axis.
TEST(FirmwareLaw, FirstTiltIsThatOfTheGains) {
  const Vehicle vehicle = vehicle_of_file("quad-450");
  for (const FirmwareKind kind : {FirmwareKind::px4, FirmwareKind::crazyflie}) {
    const StoredParameters parameters = defaults_of(kind);
    const FirmwareLoop loop =
        firmware_loops(parameters.firmware, vehicle, {})[index_of(CascadeAxis::x)];
    const double expected = loop.scale * loop.P * loop.outer * 0.3;
    Reference<double> reference;
    reference.position = {0.3, -0.3, 0};
    const std::unique_ptr<FlightLaw> law = law_of(vehicle, parameters);
    const Eigen::Vector2d tilt =
        tilt_asked(*law, StateVector<double>::Zero(), reference, vehicle, parameters);
    EXPECT_NEAR(tilt(0), expected, 1e-9) << to_string(kind);
    EXPECT_NEAR(tilt(1), -expected, 1e-9) << to_string(kind);
  }
}

// Far away to the north-east: PX4 and ArduPilot limit the tilt as a vector, a Crazyflie each
// component. The limit of the file applies.
TEST(FirmwareLaw, TiltIsLimitedAsTheFirmwareDoes) {
  const Vehicle vehicle = vehicle_of_file("quad-450");
  Reference<double> far;
  far.position = {80, 60, 0};
  const double degree = std::numbers::pi / 180;
  const auto tilt = [&](FirmwareKind kind, const std::vector<Parameter>& values) {
    StoredParameters parameters = defaults_of(kind);
    parameters.values = values;
    const std::unique_ptr<FlightLaw> law = law_of(vehicle, parameters);
    return tilt_asked(*law, StateVector<double>::Zero(), far, vehicle, parameters);
  };
  // The limits of the rates are disabled, so that the torque reveals the tilt.
  const std::vector<Parameter> px4 = {
      {"MC_ROLLRATE_MAX", 1800}, {"MC_PITCHRATE_MAX", 1800}, {"MPC_TILTMAX_AIR", 25}};
  EXPECT_NEAR(tilt(FirmwareKind::px4, px4).norm(), 25 * degree, 1e-9);
  EXPECT_NEAR(tilt(FirmwareKind::px4, px4)(0), 20 * degree, 1e-9);  // 4 : 3, like the position
  EXPECT_NEAR(tilt(FirmwareKind::crazyflie, {{"posCtlPid.xVelMax", 50}, {"posCtlPid.yVelMax", 50}})
                  .cwiseAbs()
                  .minCoeff(),
              20 * degree, 1e-9);
}

// A wind to the north fills the integral of PX4, which keeps its direction when the vehicle turns;
// that of a Crazyflie turns with it.
TEST(FirmwareLaw, IntegralsOfVelocityAreInTheFirmwaresAxes) {
  const Vehicle vehicle = vehicle_of_file("quad-450");
  for (const FirmwareKind kind : {FirmwareKind::px4, FirmwareKind::crazyflie}) {
    StoredParameters parameters = defaults_of(kind);
    // Only the integral of the velocity acts; the gains of angle and rate make it visible.
    if (kind == FirmwareKind::px4)
      parameters.values = {{"MC_ROLLRATE_I", 0}, {"MC_PITCHRATE_I", 0}, {"MPC_XY_VEL_D_ACC", 0}};
    else
      parameters.values = {{"pid_attitude.roll_ki", 0},
                           {"pid_attitude.pitch_ki", 0},
                           {"pid_rate.roll_ki", 0},
                           {"pid_rate.pitch_ki", 0}};
    const std::unique_ptr<FlightLaw> law = law_of(vehicle, parameters);
    StateVector<double> blown = StateVector<double>::Zero();
    blown(6) = 0.2;  // to the north, for 1 s
    for (int i = 0; i < 1000; ++i) (void)law->command(at(blown), Reference<double>());
    StateVector<double> turned = StateVector<double>::Zero();
    turned(5) = std::numbers::pi / 2;
    Reference<double> there;
    there.yaw = turned(5);
    Eigen::Vector2d tilt;
    for (int i = 0; i < 1000; ++i) tilt = tilt_asked(*law, turned, there, vehicle, parameters);
    // Against a push to the north: to the south, which is to the right of a vehicle facing east.
    if (kind == FirmwareKind::px4) {
      EXPECT_NEAR(tilt(0), 0, 1e-6);
      EXPECT_GT(tilt(1), 0.002);
    } else {
      EXPECT_LT(tilt(0), -0.002);
      EXPECT_NEAR(tilt(1), 0, 1e-6);
    }
  }
}

// A climb that the motors cannot achieve: the integral stops, and is unchanged afterwards.
TEST(FirmwareLaw, ThrustAtItsLimitFillsNoIntegral) {
  const Vehicle vehicle = vehicle_of_file("quad-450");
  for (const FirmwareKind kind :
       {FirmwareKind::px4, FirmwareKind::ardupilot, FirmwareKind::betaflight}) {
    StoredParameters parameters = defaults_of(kind);
    if (kind == FirmwareKind::ardupilot) parameters.values = {{"PSC_VELZ_I", 1}};
    CascadeGains pilot = some_pilot();
    for (PidLoop& loop : pilot.loops)
      if (loop.name == "altitude") loop = {loop.name, loop.output, loop.unit, 20, 5, -10};
    const auto thrust_after = [&](double seconds) {
      const OwnController controller = firmware_controller(vehicle, parameters, pilot);
      const std::unique_ptr<FlightLaw> law = controller.make(vehicle);
      Reference<double> high;
      high.position = {0, 0, -50};
      const StateVector<double> rest = StateVector<double>::Zero();
      for (int k = 0; k * controller.dt < seconds; ++k) {
        const Eigen::VectorXd asked = law->command(at(rest), high);
        law->on_realized(asked, asked);
      }
      double thrust = 0;  // of a hover right after, its filters settled
      for (int k = 0; k * controller.dt < 0.3; ++k) {
        const Eigen::VectorXd asked = law->command(at(rest), Reference<double>());
        law->on_realized(asked, asked);
        thrust = asked(0);
      }
      return thrust;
    };
    // Only what the integrals gained before the thrust saturated remains.
    const double weight = vehicle.mass * vehicle.gravity;
    EXPECT_NEAR(thrust_after(1), thrust_after(5), 1e-9 * weight) << to_string(kind);
    EXPECT_NEAR(thrust_after(5), weight, 0.1 * weight) << to_string(kind);
  }
}

// The response to ArduPilot's acceleration error is a share of the request: 0.1 ACCZ_P thrust/mass.
TEST(FirmwareLaw, ArduPilotsAccelerationLoopIsPartOfTheHeight) {
  const Vehicle vehicle = vehicle_of_file("quad-450");
  const Firmware ardupilot = firmware(FirmwareKind::ardupilot, {"4.6", ""}, "test");
  const auto lift = [&](double P) {
    const StoredParameters parameters = {
        ardupilot,
        {{"PSC_ACCZ_P", P}, {"PSC_ACCZ_I", 0}, {"PSC_VELZ_FLTE", 0}, {"PSC_ACCZ_FLTE", 0}}};
    const std::unique_ptr<FlightLaw> law = law_of(vehicle, parameters);
    Reference<double> above;
    above.position = {0, 0, -0.01};
    return law->command(at(StateVector<double>::Zero()), above)(0) - vehicle.mass * vehicle.gravity;
  };
  const FirmwareScale scale = firmware_scale(ardupilot, vehicle, {});
  // 1 m/s per m, then 5 m/s^2 per m/s: a request of 0.05 m/s^2.
  EXPECT_NEAR(lift(0.5), 0.1 * 0.5 * scale.thrust * 0.05, 1e-9);
  EXPECT_NEAR(lift(0), 0, 1e-9);
}

// Complete flights: laws with margins pass with five seeds, unstable ones do not.
TEST(FirmwareLaw, FliesWhereItsMarginsAre) {
  const struct {
    FirmwareKind kind;
    const char* vehicle;
    bool flies;
  } cases[] = {
      {FirmwareKind::px4, "quad-450", true},         {FirmwareKind::px4, "racer-250", false},
      {FirmwareKind::ardupilot, "quad-450", true},   {FirmwareKind::ardupilot, "racer-250", false},
      {FirmwareKind::betaflight, "racer-250", true}, {FirmwareKind::crazyflie, "crazyflie", true},
      {FirmwareKind::crazyflie, "mambo", false}};
  for (const auto& one : cases) {
    const Vehicle vehicle = vehicle_of_file(one.vehicle);
    const StoredParameters parameters = defaults_of(one.kind);
    // For the loops that only Betaflight leaves to its pilot.
    const CascadeGains pilot =
        one.kind == FirmwareKind::betaflight
            ? vehicle_cascade(vehicle, {}, vehicle.name).content.cascade->gains
            : CascadeGains();
    ChosenLaw law{firmware_controller(vehicle, parameters, pilot), "test"};
    law.on_board = true;
    const PlannedFlight plan = plan_flight({}, vehicle, load_mission("step-north"), law);
    const FlownFlight worst = worst_of(fly_seeds(plan, 3));
    int passed = 0;
    for (const SeedVerdict& seed : worst.seeds) passed += seed.passed ? 1 : 0;
    EXPECT_EQ(passed, one.flies ? 3 : 0) << to_string(one.kind) << " on " << one.vehicle;
  }
}

// The filter that runs at 200 Hz on means of the board's samples is as accurate as one that runs in
// every period of a law of 5 ms: the samples have the noise density of the file.
TEST(FirmwareLaw, BoardsFilterKnowsAsMuch) {
  const Vehicle vehicle = vehicle_of_file("quad-450");
  const auto error_of = [&](const ChosenLaw& law) {
    FlightOptions options;
    options.duration = 40;
    double sum = 0;
    const std::vector<FlownFlight> flights =
        fly_seeds(plan_flight(options, vehicle, load_mission("hover"), law), 4);
    for (const FlownFlight& flight : flights)
      sum += std::pow(flight.result.metrics[Metric::estimate_rms], 2);
    return std::sqrt(sum / 4);
  };
  const StoredParameters parameters = defaults_of(FirmwareKind::px4);
  ChosenLaw board{firmware_controller(vehicle, parameters, {}), "test"};
  board.on_board = true;
  const double usual = error_of(choose_law({}, vehicle, "test"));
  EXPECT_GT(usual, 0.01);
  EXPECT_NEAR(error_of(board) / usual, 1, 0.1);
}

TEST(FirmwareLaw, OtherEstimatorsAreRefused) {
  const Vehicle vehicle = vehicle_of_file("mambo");
  ChosenLaw law{firmware_controller(vehicle, defaults_of(FirmwareKind::px4), {}), "test"};
  law.on_board = true;
  FlightOptions options;
  options.estimator = "mambo";
  try {
    (void)plan_flight(options, vehicle, load_mission("hover"), law);
    FAIL() << "the estimator mambo was accepted";
  } catch (const OptionError& error) {
    EXPECT_THAT(error.what(), HasSubstr("expected general or truth"));
  }
  options.estimator = "truth";
  EXPECT_EQ(plan_flight(options, vehicle, load_mission("hover"), law).setup.estimator,
            EstimatorKind::truth);
}

TEST(FirmwareLaw, NeedsParameters) {
  FlightOptions options;
  options.controller = "firmware";
  EXPECT_THROW((void)choose_law(options, vehicle_of_file("quad-450"), "test"), OptionError);
}

}  // namespace
}  // namespace quadtune
