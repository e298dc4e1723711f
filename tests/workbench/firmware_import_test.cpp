// SPDX-License-Identifier: Apache-2.0
#include "quadtune/workbench/firmware/firmware_import.hpp"

#include <gmock/gmock.h>

#include <cmath>
#include <complex>
#include <functional>
#include <numbers>
#include <utility>

#include "plants/firmware_vehicles.hpp"
#include "quadtune/linearize.hpp"
#include "quadtune/model/vehicle.hpp"
#include "source_folder.hpp"

namespace quadtune {
namespace {

using ::testing::Contains;
using ::testing::HasSubstr;
using Complex = std::complex<double>;

const FirmwareLoop& loop_of(const std::vector<FirmwareLoop>& loops, CascadeAxis axis) {
  return loops[index_of(axis)];
}

/// The crossover of a loop and its phase margin [deg].
std::pair<double, double> crossover(const std::function<Complex(double)>& L) {
  double low = 1, high = 1000;
  for (int i = 0; i < 200; ++i) {
    const double w = std::sqrt(low * high);
    (std::abs(L(w)) > 1 ? low : high) = w;
  }
  return {low, 180 + std::arg(L(low)) * 180 / std::numbers::pi};
}

// PX4 on its own simulator, whose body damps rotations with 0.025 N m s: 14.311 rad/s and 64.40
// degrees by hand, without the delay of the computation.
TEST(FirmwareImport, Px4RateLoopHasTheCrossoverOfTheWorkedCase) {
  const Vehicle vehicle = testing::sih_vehicle();
  const Firmware px4 = firmware(FirmwareKind::px4, {"1.15", ""}, "test");
  const std::vector<FirmwareLoop> loops = firmware_loops(px4, vehicle, {});
  ContinuousTransferFunction loop =
      firmware_turn_loop(px4, vehicle, loop_of(loops, CascadeAxis::roll), {}, false);
  loop.delay = 0;
  const double J = 0.025, resistance = 0.025;
  const auto [w, phase] = crossover([&](double frequency) {
    const Complex s(0, frequency);
    return loop(s) * J * s / (J * s + resistance);
  });
  EXPECT_NEAR(w, 14.311, 1e-3);
  EXPECT_NEAR(phase, 64.40, 0.01);
}

// A pure gain crosses at k = G P/J, and with a lag where w² (1 + lag² w²) = k²: 13.9267 rad/s and
// 55.15 degrees with 50 ms.
TEST(FirmwareImport, GainAloneCrossesWhereItIsExpected) {
  Vehicle vehicle = testing::sih_vehicle();
  const Firmware px4 = firmware(FirmwareKind::px4, {"1.15", ""}, "test");
  const std::vector<Parameter> values = {
      {"MC_ROLLRATE_I", 0}, {"MC_ROLLRATE_D", 0}, {"IMU_GYRO_CUTOFF", 0}};
  const auto of = [&] {
    const std::vector<FirmwareLoop> loops = firmware_loops(px4, vehicle, values);
    ContinuousTransferFunction loop =
        firmware_turn_loop(px4, vehicle, loop_of(loops, CascadeAxis::roll), values, false);
    loop.delay = 0;
    return crossover([loop](double w) { return loop(Complex(0, w)); });
  };
  const double k = std::sqrt(8.0) * 0.15 / 0.025, lag = 0.05;
  EXPECT_NEAR(of().first, std::sqrt((std::sqrt(1 + 4 * lag * lag * k * k) - 1) / 2) / lag, 1e-9);
  EXPECT_NEAR(of().first, 13.9267, 1e-4);
  EXPECT_NEAR(of().second, 55.15, 0.01);
  for (Rotor& rotor : vehicle.rotors) rotor.lag = 0;
  EXPECT_NEAR(of().first, k, 1e-9);
  EXPECT_NEAR(of().second, 90, 1e-6);
}

// An accelerating rotor turns the body in the opposite direction: (dQ/dw + J_r s) δw about z.
TEST(FirmwareImport, ReactionOfTheRotorsLeadsInYawAlone) {
  Vehicle vehicle = testing::iris_vehicle();
  const Firmware px4 = firmware(FirmwareKind::px4, {"1.15", ""}, "test");
  const auto loop = [&](CascadeAxis axis, Complex s) {
    const FirmwareLoop gains = loop_of(firmware_loops(px4, vehicle, {}), axis);
    return firmware_turn_loop(px4, vehicle, gains, {}, true)(s);
  };
  const Complex s(0, 8);
  const Complex roll = loop(CascadeAxis::roll, s), yaw = loop(CascadeAxis::yaw, s);
  for (Rotor& rotor : vehicle.rotors) rotor.inertia = 6e-5;
  const double w = std::sqrt(1.55 * 9.80665 / 4 / 5.84e-6), torque_slope = 2 * 0.06 * 5.84e-6 * w;
  EXPECT_EQ(loop(CascadeAxis::roll, s), roll);
  const Complex expected = yaw * (1.0 + s * 6e-5 / torque_slope);
  EXPECT_LT(std::abs(loop(CascadeAxis::yaw, s) / expected - 1.0), 1e-12);
}

// The slope of the torque by the rate is that of the linear model; without air on its rotors the
// vehicle is a rigid body.
TEST(FirmwareImport, AirOnTheRotorsDampsTurns) {
  const Vehicle vehicle = load_vehicle(testing::source_folder() + "/vehicles/quad-450.toml");
  Vehicle rigid = vehicle;
  for (Rotor& rotor : rigid.rotors) rotor.drag = rotor.inflow = rotor.flapping = 0;
  const Linearization model = linearize(vehicle, FlightCondition{}, {});
  const Firmware px4 = firmware(FirmwareKind::px4, {}, "test");
  const std::vector<FirmwareTurn> turns = firmware_turns(px4, vehicle, {});
  ASSERT_EQ(turns.size(), 3u);
  for (std::size_t i = 0; i < 3; ++i) {
    const FirmwareTurn& turn = turns[i];
    const Eigen::Index rate = i == 0 ? 9 : i == 1 ? 10 : 11;
    const double damping = -turn.inertia * model.plant.A(rate, rate);
    ASSERT_GT(damping, 0);
    EXPECT_NEAR(turn.damping, damping, 1e-9 * damping) << to_string(turn.gains.axis);
    for (const double w : {0.3, 5.0, 40.0}) {
      const Complex s(0, w);
      const Complex ratio = firmware_turn_loop(px4, vehicle, turn.gains, {}, true)(s) /
                            firmware_turn_loop(px4, rigid, turn.gains, {}, true)(s);
      const Complex expected = turn.inertia * s / (turn.inertia * s + damping);
      EXPECT_LT(std::abs(ratio / expected - 1.0), 1e-9) << to_string(turn.gains.axis);
    }
  }
}

/// The filters of a loop at one frequency.
struct AtOne {
  Complex gyroscope = 1, derivative = 1, error = 1, target = 1;
};

/// The same loop, summed term by term at one frequency.
Complex by_terms(const FirmwareLoop& loop, double J, Complex s, const AtOne& at, bool angle) {
  const Complex asked = angle ? (loop.outer + loop.outer_integral / s) / s * at.target : Complex(0);
  const double od = angle ? loop.outer_derivative : 0;
  Complex torque = (loop.P + loop.I / s) * at.error * ((1 + od) * at.gyroscope + asked);
  torque += loop.D * s * at.derivative * (at.gyroscope + (loop.of_error ? asked : 0));
  if (angle) torque += loop.forward * (od * at.gyroscope + asked);
  return loop.scale * torque / (J * s);
}

TEST(FirmwareImport, LoopsOfEveryFirmwareAreTheSumOfTheirTerms) {
  const auto first = [](Complex s, double Hz) {
    return 1.0 / (1.0 + s / (2 * std::numbers::pi * Hz));
  };
  const auto second = [](Complex s, double Hz) {
    const Complex x = s / (2 * std::numbers::pi * Hz);
    return 1.0 / (x * x + std::sqrt(2.0) * x + 1.0);
  };
  const Vehicle vehicle = testing::crazyflie_vehicle();
  for (const bool angle : {false, true})
    for (const double w : {0.3, 5.0, 40.0, 300.0}) {
      const Complex s(0, w);
      for (const CascadeAxis axis : {CascadeAxis::roll, CascadeAxis::pitch, CascadeAxis::yaw}) {
        const double J = vehicle.inertia.diagonal()(axis == CascadeAxis::roll    ? 0
                                                    : axis == CascadeAxis::pitch ? 1
                                                                                 : 2);
        const bool yaw = axis == CascadeAxis::yaw;
        const auto check = [&](FirmwareKind kind, const AtOne& at, double rate) {
          const Firmware target = firmware(kind, {}, "test");
          FirmwareLoop loop = loop_of(firmware_loops(target, vehicle, {}), axis);
          loop.forward = 0.2 * loop.P;
          const ContinuousTransferFunction L = firmware_turn_loop(target, vehicle, loop, {}, angle);
          EXPECT_DOUBLE_EQ(L.delay, 1.5 / rate);
          const Complex expected = by_terms(loop, J, s, at, angle) * std::exp(-s * L.delay);
          EXPECT_LT(std::abs(L(s) / expected - 1.0), 1e-9) << to_string(kind);
        };
        check(FirmwareKind::crazyflie, {second(s, 80), 1, 1, 1}, 500);
        check(FirmwareKind::betaflight,
              {first(s, 250) * first(s, 500), first(s, 75) * first(s, 150),
               yaw ? first(s, 100) : Complex(1), 1},
              4000);
        const Complex error = yaw ? first(s, 2.5) : Complex(1);
        check(FirmwareKind::ardupilot, {second(s, 20), first(s, 20) * error, error, first(s, 20)},
              400);
      }
    }
}

TEST(FirmwareImport, DefaultsOnABuiltInVehicleAreToldAndFlown) {
  const Vehicle vehicle = load_vehicle(testing::source_folder() + "/vehicles/quad-450.toml");
  const FirmwareImport import =
      import_parameters(firmware(FirmwareKind::px4, {}, "test"), vehicle, {});
  ASSERT_EQ(import.turns.size(), 3u);
  EXPECT_TRUE(import.turns[0].rate.stable);
  EXPECT_GT(import.turns[0].rate.crossover, 5);
  EXPECT_THAT(import.notes, Contains(HasSubstr("roll: D acts as")));
  ASSERT_TRUE(import.content.cascade);
  EXPECT_EQ(import.content.cascade->gains.loops.size(), kCascadeAxes);
  EXPECT_LT(import.content.cascade->gains.loops[index_of(CascadeAxis::x)].Kp, 0);
  ASSERT_TRUE(import.flown);
}

TEST(FirmwareImport, PilotsLoopsAreThoseOfTheDesign) {
  const FirmwareImport import =
      import_parameters(firmware(FirmwareKind::betaflight, {}, "test"),
                        load_vehicle(testing::source_folder() + "/vehicles/quad-450.toml"), {});
  EXPECT_THAT(import.notes, Contains(HasSubstr("x, y and altitude are controlled by the pilot")));
  EXPECT_NE(import.content.cascade->gains.loops[index_of(CascadeAxis::x)].Kp, 0);
}

}  // namespace
}  // namespace quadtune
