// SPDX-License-Identifier: Apache-2.0
// The worked cases are derived from the sources that docs/bibliography.md lists under "Firmware".
#include "quadtune/exports/firmware.hpp"

#include <fmt/format.h>
#include <gmock/gmock.h>

#include <algorithm>
#include <cmath>
#include <random>

#include "plants/firmware_vehicles.hpp"
#include "quadtune/errors.hpp"
#include "quadtune/exports/export.hpp"
#include "quadtune/exports/exporter.hpp"
#include "quadtune/exports/verify.hpp"
#include "temporary_directory.hpp"

namespace quadtune {
namespace {

using ::testing::Contains;
using ::testing::HasSubstr;
using ::testing::ThrowsMessage;

Firmware newest(FirmwareKind kind) { return firmware(kind, {}, "test"); }

const FirmwareLoop& loop_of(const std::vector<FirmwareLoop>& loops, CascadeAxis axis) {
  return loops[index_of(axis)];
}

double value_of(const std::vector<Parameter>& values, const std::string& name) {
  for (const Parameter& parameter : values)
    if (parameter.name == name) return parameter.value;
  ADD_FAILURE() << name << " is not written";
  return std::nan("");
}

void expect_share(double value, double expected, double share = 1e-4) {
  EXPECT_NEAR(value, expected, share * std::abs(expected));
}

TEST(Firmware, DefaultsOfPx4OnItsOwnSimulatorAreKnownInSi) {
  const Firmware px4 = firmware(FirmwareKind::px4, {"1.15.4", ""}, "test");
  const std::vector<FirmwareLoop> loops = firmware_loops(px4, testing::sih_vehicle(), {});
  const FirmwareScale scale = firmware_scale(px4, testing::sih_vehicle(), {});
  expect_share(scale.torque[0], 2.828427);
  expect_share(scale.torque[2], 0.4);
  expect_share(scale.hover, 0.490333);
  const FirmwareLoop& roll = loop_of(loops, CascadeAxis::roll);
  expect_share(roll.scale * roll.P, 0.424264);
  expect_share(roll.scale * roll.I, 0.565685);
  expect_share(roll.derivative(), 0.00848528);
  const FirmwareLoop& yaw = loop_of(loops, CascadeAxis::yaw);
  expect_share(yaw.scale * yaw.P / 0.030, 2.66667);
}

TEST(Firmware, IrisIsMixedByItsParametersAndTurnedByItsRotors) {
  const Firmware px4 = firmware(FirmwareKind::px4, {"1.15", ""}, "test");
  std::vector<Parameter> values = {{"CA_ROTOR_COUNT", 4}};
  const double places[][3] = {{0.1515, 0.245, 0.05},
                              {-0.1515, -0.1875, 0.05},
                              {0.1515, -0.245, -0.05},
                              {-0.1515, 0.1875, -0.05}};
  for (int i = 0; i < 4; ++i) {
    values.push_back({fmt::format("CA_ROTOR{}_PX", i), places[i][0]});
    values.push_back({fmt::format("CA_ROTOR{}_PY", i), places[i][1]});
    values.push_back({fmt::format("CA_ROTOR{}_KM", i), places[i][2]});
  }
  const FirmwareScale scale = firmware_scale(px4, testing::iris_vehicle(), values);
  expect_share(scale.torque[0], 3.920598);
  expect_share(scale.torque[1], 3.464335);
  expect_share(scale.torque[2], 1.995872);
  expect_share(scale.hover, 0.706657);
  expect_share(scale.thrust, 4 * 9.421748);
  // 4 1/s² per m/s acts as 7.0: the slope of a quadratic thrust at hover.
  const std::vector<FirmwareLoop> loops = firmware_loops(px4, testing::iris_vehicle(), values);
  expect_share(loop_of(loops, CascadeAxis::altitude).Kd() / 1.55, 4 * 1.7521);
  // A motor in another place would turn the vehicle over.
  values[1].value = -0.1515;
  EXPECT_THAT([&] { (void)firmware_scale(px4, testing::iris_vehicle(), values); },
              ThrowsMessage<InvalidInput>(
                  HasSubstr("a rotor in another place would turn the vehicle over")));
}

TEST(Firmware, ArduCopterHoverAndCurveGiveTheTorque) {
  const Firmware ardupilot = firmware(FirmwareKind::ardupilot, {"4.5.4", ""}, "test");
  const std::vector<Parameter> values = {
      {"MOT_SPIN_MIN", 0}, {"MOT_SPIN_MAX", 1}, {"MOT_THST_EXPO", 0.65}};
  const FirmwareScale scale = firmware_scale(ardupilot, testing::arducopter_vehicle(), values);
  expect_share(scale.hover, 0.39);
  expect_share(scale.torque[0], 9.33470);
  const auto loops = firmware_loops(ardupilot, testing::arducopter_vehicle(), values);
  const FirmwareLoop& roll = loop_of(loops, CascadeAxis::roll);
  expect_share(roll.scale * roll.P, 1.260185);
  expect_share(roll.scale * roll.P / 0.02296875, 54.865);
}

TEST(Firmware, BetaflightUnitsArePerThousandAndPerDegree) {
  const Firmware betaflight = firmware(FirmwareKind::betaflight, {"4.5.5", ""}, "test");
  const auto loops =
      firmware_loops(betaflight, testing::racing_vehicle(CommandLaw::speed_squared), {});
  const FirmwareLoop& roll = loop_of(loops, CascadeAxis::roll);
  expect_share(roll.scale, 0.0034);
  expect_share(roll.scale * roll.P, 0.280774);
  expect_share(roll.scale * roll.I, 3.808544);
  expect_share(roll.derivative(), 0.00309157);
  EXPECT_DOUBLE_EQ(roll.outer, 5);
  const FirmwareLoop& yaw = loop_of(loops, CascadeAxis::yaw);
  expect_share(yaw.scale * yaw.P, 0.0617704);
  expect_share(yaw.scale * yaw.I, 2.094699);
  // An integral of the rate acts as a gain on the heading.
  expect_share(yaw.Kp(), 2.094699);
  EXPECT_EQ(yaw.Ki(), 0);
  EXPECT_FALSE(loop_of(loops, CascadeAxis::x).flies);
  const FirmwareScale quadratic =
      firmware_scale(betaflight, testing::racing_vehicle(CommandLaw::speed), {});
  expect_share(quadratic.hover, 0.465805);
  expect_share(quadratic.thrust / 4, 7.918682);
  // Without D-min, the maximum D is used.
  const auto max = firmware_loops(betaflight, testing::racing_vehicle(CommandLaw::speed_squared),
                                  {{"d_min_roll", 0}});
  expect_share(loop_of(max, CascadeAxis::roll).derivative(), 0.00412209);
}

TEST(Firmware, CrazyflieScaleChangesWithVersionAndPropellers) {
  const Vehicle vehicle = testing::crazyflie_vehicle();
  const auto roll_of = [&](const char* version, const char* setup) {
    return firmware_scale(firmware(FirmwareKind::crazyflie, {version, setup}, "test"), vehicle, {})
        .torque[0];
  };
  const double now = roll_of("2026.08", "standard");
  expect_share(now, 1.1911893e-7);
  expect_share(roll_of("2025.02", "standard") / now, 1.2262);
  expect_share(roll_of("2025.12", "standard") / now, 0.9375);
  expect_share(roll_of("2025.12.1", "thrust-kit") / now, 1.5);
  expect_share(roll_of("2025.12", "brushless") / now, 0.20 / 0.12);
  expect_share(roll_of("2026.08", "brushless") / now, 0.20 / 0.12);
  EXPECT_THAT([&] { (void)roll_of("2025.09", "brushless"); },
              ThrowsMessage<InvalidInput>(HasSubstr("expected 2025.12 or newer")));
  const auto loops = firmware_loops(newest(FirmwareKind::crazyflie), vehicle, {});
  const FirmwareLoop& roll = loop_of(loops, CascadeAxis::roll);
  expect_share(roll.scale * roll.P, 1.706253e-3);
  expect_share(roll.scale * roll.I, 3.412506e-3);
  expect_share(roll.derivative(), 1.706253e-5);
  const FirmwareLoop& yaw = loop_of(loops, CascadeAxis::yaw);
  expect_share(yaw.scale * yaw.P, 3.521509e-4);
  // D of the attitude also acts on the rate.
  expect_share(yaw.Kd(), 1.35 * 3.521509e-4);
  expect_share(loop_of(loops, CascadeAxis::altitude).Kd(), 0.183108);
  expect_share(9.81 * loop_of(loops, CascadeAxis::x).Kd(), 4.2804);
  expect_share(firmware_scale(newest(FirmwareKind::crazyflie), vehicle, {}).hover, 38841.8);
}

TEST(Firmware, CascadeBecomesTheParametersThatWereDerivedByHand) {
  CascadeGains gains = testing::usual_firmware_cascade();
  gains.loops[index_of(CascadeAxis::roll)].Kp = 3.0;
  gains.loops[index_of(CascadeAxis::roll)].Ki = 2.0;
  gains.loops[index_of(CascadeAxis::roll)].Kd = -0.35;
  for (const CascadeAxis axis : {CascadeAxis::x, CascadeAxis::y}) {
    const double sign = axis == CascadeAxis::x ? -1 : 1;
    PidLoop& loop = gains.loops[index_of(axis)];
    loop.Kp = sign * 0.1834;
    loop.Ki = sign * 0.03979;
    loop.Kd = -sign * 0.1684;
  }
  const auto px4 = firmware_parameters(newest(FirmwareKind::px4), testing::sih_vehicle(), gains);
  expect_share(value_of(px4.values, "MC_ROLL_P"), 7.842828, 1e-6);
  expect_share(value_of(px4.values, "MC_ROLLRATE_P"), 0.1237437, 1e-6);
  expect_share(value_of(px4.values, "MC_ROLLRATE_I"), 0.0901597, 1e-6);
  expect_share(value_of(px4.values, "MPC_XY_P"), 0.790);
  expect_share(value_of(px4.values, "MPC_XY_VEL_P_ACC"), 1.6514);
  expect_share(value_of(px4.values, "MPC_XY_VEL_I_ACC"), 0.4940);
  EXPECT_THAT(px4.notes, Contains(HasSubstr("MPC_XY_VEL_D_ACC is 0, below the published range")));

  CascadeGains small = testing::usual_firmware_cascade();
  small.loops[index_of(CascadeAxis::roll)].Kp = 0.0105;
  small.loops[index_of(CascadeAxis::roll)].Ki = 0.03;  // Kp² < 4 |Kd| Ki
  small.loops[index_of(CascadeAxis::roll)].Kd = -0.0017;
  for (const CascadeAxis axis : {CascadeAxis::pitch, CascadeAxis::yaw})
    small.loops[index_of(axis)] = {to_string(axis), "", "", 0.004, 0.002, -0.0008};
  const auto crazyflie =
      firmware_parameters(newest(FirmwareKind::crazyflie), testing::crazyflie_vehicle(), small);
  expect_share(value_of(crazyflie.values, "pid_rate.roll_kp"), 249.0838, 1e-6);
  EXPECT_EQ(value_of(crazyflie.values, "pid_rate.roll_ki"), 0);
  expect_share(value_of(crazyflie.values, "pid_attitude.roll_kp"), 6.176471, 1e-6);
  expect_share(value_of(crazyflie.values, "pid_attitude.roll_ki"), 17.647059, 1e-6);
  EXPECT_EQ(value_of(crazyflie.values, "posCtlPid.thrustBase"), 38842);
}

TEST(Firmware, GainsThatDoNotFactorAreRefusedWithTheGreatestIntegral) {
  CascadeGains gains = testing::usual_firmware_cascade();
  PidLoop& roll = gains.loops[index_of(CascadeAxis::roll)];
  roll.Kp = 0.01078;
  roll.Ki = 0.02777;
  roll.Kd = -0.001508;
  for (const FirmwareKind kind :
       {FirmwareKind::px4, FirmwareKind::ardupilot, FirmwareKind::betaflight})
    EXPECT_THAT([&] { (void)firmware_parameters(newest(kind), testing::sih_vehicle(), gains); },
                ThrowsMessage<InvalidInput>(HasSubstr("|Ki| <= Kp^2/(4 |Kd|) = 0.0192653")));
  roll.Kd = 0.001508;
  EXPECT_THAT(
      [&] { (void)firmware_parameters(newest(FirmwareKind::px4), testing::sih_vehicle(), gains); },
      ThrowsMessage<InvalidInput>(HasSubstr("gains are positive and damp")));
}

TEST(Firmware, BetaflightRoundsAndSaysSo) {
  const Firmware betaflight = firmware(FirmwareKind::betaflight, {"4.5", ""}, "test");
  CascadeGains gains = testing::usual_firmware_cascade();
  // P 40.0678 and I 21.0054: 0.25 N m s and 1.0 N m behind 3 1/s.
  for (const CascadeAxis axis : {CascadeAxis::roll, CascadeAxis::pitch}) {
    PidLoop& loop = gains.loops[index_of(axis)];
    loop.Kp = 0.25 * 7 + 1.0;
    loop.Ki = 1.0 * 7;
    loop.Kd = -0.25;
  }
  gains.loops[index_of(CascadeAxis::yaw)] = {"yaw", "tau_z", "N m/rad", 1, 0.1, -0.05};
  const Vehicle vehicle = testing::racing_vehicle(CommandLaw::speed_squared);
  const auto written = firmware_parameters(betaflight, vehicle, gains);
  EXPECT_EQ(value_of(written.values, "p_roll"), 40);
  EXPECT_EQ(value_of(written.values, "i_roll"), 21);
  EXPECT_EQ(value_of(written.values, "angle_p_gain"), 70);
  EXPECT_EQ(value_of(written.values, "d_min_roll"), 0);
  EXPECT_THAT(written.notes, Contains(HasSubstr("p_roll is rounded from 40.0678 to 40 (-0.17 %)")));
  gains.loops[index_of(CascadeAxis::yaw)].Kd = -1e-4;  // p_yaw 0.07
  EXPECT_THAT([&] { (void)firmware_parameters(betaflight, vehicle, gains); },
              ThrowsMessage<InvalidInput>(HasSubstr("expected a whole number from 1 to 250")));
}

TEST(Firmware, NoiseDensityIsAStepsDeviation) {
  expect_share(filter_noise(0.005, 0.01), 0.05);
  expect_share(filter_noise(0.02, 0.01), 0.2);
  // 5e-4 m²/s² in each step of 5 ms.
  expect_share(filter_noise(std::sqrt(5e-4 / 0.005), 0.01), 3.16228);
}

TEST(Firmware, NoiseOfItsEstimatorIsThatOfTheGeneralFilter) {
  GeneralFilterSettings filter;
  filter.gyroscope.density = {0.001, 0.005, 0.002};
  filter.accelerometer.density.setConstant(0.02);
  filter.gyroscope.walk = 1e-4;
  filter.range = RangeAid{{0, 0.09, 1}};
  filter.flow = FlowAid{0, 0.04};
  filter.gps_velocity = Aid{0, 0.25, 1};
  const FirmwareParameters px4 = noise_parameters(newest(FirmwareKind::px4), filter);
  expect_share(value_of(px4.values, "EKF2_GYR_NOISE"), 0.05);  // of the noisiest axis
  expect_share(value_of(px4.values, "EKF2_ACC_NOISE"), 0.2);
  expect_share(value_of(px4.values, "EKF2_GYR_B_NOISE"), 1e-3);
  expect_share(value_of(px4.values, "EKF2_RNG_NOISE"), 0.3);
  expect_share(value_of(px4.values, "EKF2_OF_N_MIN"), 0.2);
  EXPECT_EQ(px4.values.size(), 6u);  // what the filter does not have keeps its default
  const FirmwareParameters ardupilot = noise_parameters(newest(FirmwareKind::ardupilot), filter);
  expect_share(value_of(ardupilot.values, "EK3_GYRO_P_NSE"), 0.005 / std::sqrt(0.012));
  expect_share(value_of(ardupilot.values, "EK3_VELNE_M_NSE"), 0.5);
  expect_share(value_of(noise_parameters(newest(FirmwareKind::crazyflie), filter).values,
                        "kalman.mNGyro_rollpitch"),
               0.005 / std::sqrt(0.001));
  EXPECT_THAT([&] { (void)noise_parameters(newest(FirmwareKind::betaflight), filter); },
              ThrowsMessage<InvalidInput>(HasSubstr("has no estimator of position")));
}

TEST(Firmware, NoiseIsHeldToThePublishedRangeAndSaysSo) {
  GeneralFilterSettings filter;
  filter.gyroscope.density.setConstant(1e-6);
  filter.accelerometer.density.setConstant(1);
  const FirmwareParameters px4 = noise_parameters(newest(FirmwareKind::px4), filter);
  EXPECT_EQ(value_of(px4.values, "EKF2_GYR_NOISE"), 1e-4);
  EXPECT_EQ(value_of(px4.values, "EKF2_ACC_NOISE"), 1);
  EXPECT_THAT(px4.notes,
              Contains(HasSubstr("EKF2_GYR_NOISE would be 1e-05 rad/s, limited to 0.0001")));
  EXPECT_THAT(px4.notes, Contains(HasSubstr("much less than the default of 0.015")));
  EXPECT_THAT(px4.notes, Contains(HasSubstr("EKF2_ACC_NOISE would be 10 m/s^2, limited to 1")));
}

/// Random gains with ratios Kp²/(|Kd| Ki) of at least 4.
CascadeGains random_cascade(std::mt19937& random, bool any_integral) {
  std::uniform_real_distribution<double> unit(0, 1);
  std::vector<Eigen::Vector3d> sizes;
  for (std::size_t i = 0; i < kCascadeAxes; ++i) {
    const double Kd = std::exp(3 * unit(random) - 2), Kp = Kd * std::exp(2 * unit(random));
    const double share = any_integral ? 2 * unit(random) : unit(random);
    sizes.emplace_back(Kp, unit(random) < 0.2 ? 0 : share * Kp * Kp / (4 * Kd), Kd);
  }
  sizes[1] = sizes[0];
  return testing::firmware_cascade(sizes);
}

TEST(Firmware, EveryCascadeComesBackFromTheTextOfItsParameters) {
  std::mt19937 random(7);
  for (const FirmwareKind kind :
       {FirmwareKind::px4, FirmwareKind::ardupilot, FirmwareKind::crazyflie})
    for (const std::string& version : firmware_versions(kind))
      for (int i = 0; i < 25; ++i) {
        const Firmware target = firmware(kind, {version, ""}, "test");
        const Vehicle vehicle = kind == FirmwareKind::crazyflie ? testing::crazyflie_vehicle()
                                                                : testing::iris_vehicle();
        CascadeGains gains = random_cascade(random, kind == FirmwareKind::crazyflie);
        // ArduPilot's D acts on the error, which limits the lead to a quarter of Kd/Kp.
        std::uniform_real_distribution<double> share(0, 0.24);
        for (PidLoop& loop : gains.loops)
          loop.rate_lead = i % 3 == 0 ? 0 : share(random) * std::abs(loop.Kd / loop.Kp);
        gains.loops[1].rate_lead = gains.loops[0].rate_lead;
        // The output of a Crazyflie saturates at 571 per degree per second.
        if (kind == FirmwareKind::crazyflie)
          for (const CascadeAxis axis : {CascadeAxis::pitch, CascadeAxis::roll, CascadeAxis::yaw}) {
            PidLoop& loop = gains.loops[index_of(axis)];
            loop.Kp *= 5e-4;
            loop.Ki *= 5e-4;
            loop.Kd *= 5e-4;
          }
        const FirmwareParameters written = firmware_parameters(target, vehicle, gains);
        const std::string text = parameter_text(target, written.values, {"a comment"});
        const ParameterFile read = parse_parameters(target, text, "file");
        ASSERT_EQ(read.values.size(), written.values.size());
        for (std::size_t k = 0; k < read.values.size(); ++k) {
          EXPECT_EQ(read.values[k].name, written.values[k].name);
          EXPECT_EQ(static_cast<float>(read.values[k].value),
                    static_cast<float>(written.values[k].value));
        }
        const CascadeGains back =
            cascade_of(firmware_loops(target, vehicle, read.values), {}, gains.dt);
        for (std::size_t k = 0; k < kCascadeAxes; ++k) {
          expect_share(back.loops[k].Kp, gains.loops[k].Kp, 1e-6);
          expect_share(back.loops[k].Ki, gains.loops[k].Ki, 1e-6);
          expect_share(back.loops[k].Kd, gains.loops[k].Kd, 1e-6);
          expect_share(back.loops[k].rate_lead, gains.loops[k].rate_lead, 2e-6);
          // A Crazyflie differentiates its rates without a filter.
          EXPECT_EQ(back.loops[k].rate_filter > 0,
                    gains.loops[k].rate_lead > 0 &&
                        (kind != FirmwareKind::crazyflie || k == 0 || k == 1 || k == 5));
        }
      }
}

// A vehicle whose thrust is several times its weight hovers below the published minimum of 0.2.
TEST(Firmware, HoverThrottleOfAStrongVehicleIsReadBack) {
  const Firmware target = newest(FirmwareKind::ardupilot);
  Vehicle vehicle = testing::arducopter_vehicle();
  for (const bool limited : {false, true}) {
    vehicle.motor.max *= 1.5;
    const FirmwareParameters written =
        firmware_parameters(target, vehicle, testing::usual_firmware_cascade());
    const double hover = firmware_scale(target, vehicle, written.values).hover;
    EXPECT_LT(hover, 0.2);
    EXPECT_THAT(written.notes, Contains(HasSubstr("below the published range 0.2 to 0.8")));
    EXPECT_EQ(hover < 0.125, limited);
    EXPECT_EQ(std::any_of(written.notes.begin(), written.notes.end(),
                          [](const std::string& note) {
                            return note.starts_with("ArduPilot limits MOT_THST_HOVER");
                          }),
              limited);
    const ParameterFile read =
        parse_parameters(target, parameter_text(target, written.values, {}), "file");
    EXPECT_EQ(read.values.size(), written.values.size());
  }
}

TEST(Firmware, SharedGainsAreTheGeometricMeanAndStillFactor) {
  CascadeGains gains = testing::usual_firmware_cascade();
  PidLoop& x = gains.loops[index_of(CascadeAxis::x)];
  x.Kp *= 1.21;
  x.Ki *= 1.21;
  x.Kd *= 1.21;
  const auto written =
      firmware_parameters(newest(FirmwareKind::px4), testing::sih_vehicle(), gains);
  expect_share(value_of(written.values, "MPC_XY_VEL_P_ACC"), 1.1 * 0.1684 * 9.80665, 1e-6);
  EXPECT_THAT(written.notes, Contains(HasSubstr("x and y share their gains")));
}

void expect_refused(FirmwareKind kind, const std::string& text, const std::string& message,
                    const char* version = "") {
  EXPECT_THAT(
      [&] {
        (void)parse_parameters(firmware(kind, {version, ""}, "test"), text, "file");
      },
      ThrowsMessage<InvalidInput>(HasSubstr(message)))
      << text;
}

TEST(Firmware, BadFilesAreRefusedWithTheirLine) {
  using enum FirmwareKind;
  expect_refused(px4, "1\t1\tMC_ROLL_P\tnan\t9\n", "file:1: MC_ROLL_P is 'nan', expected a finite");
  expect_refused(px4, "1\t1\tMC_ROLL_P\t6\t9\n1\t1\tMC_ROLL_P\t6\t9\n",
                 "file:2: MC_ROLL_P occurs twice");
  expect_refused(px4, "1 1 MC_ROLL_P 6 9\n", "file:1: has 1 column, expected 5");
  expect_refused(px4, "1\t1\tMC_ROLL_P\t6\t4\n", "file:1: type of MC_ROLL_P is '4'");
  expect_refused(px4, "1\t1\tMC_ROLLRATE_P\t-0.1\t9\n", "drives a rotor the wrong way");
  expect_refused(px4, "1\t1\tTHR_MDL_FAC\t40\t9\n", "THR_MDL_FAC is 40, expected 0 to 1");
  expect_refused(px4, "1\t1\tMC_ROLL_P\t1e300\t9\n", "fits a float");
  expect_refused(betaflight, "set p_roll = 300\n", "p_roll is 300, expected 0 to 250");
  expect_refused(crazyflie, "params: {}\ntype: persistent_param_state\nversion: 1\n",
                 "version: '1'\", in which 1 is in quotes");
  expect_refused(px4, "# nothing\n", "has no parameter of the control loops of px4");
  expect_refused(px4, std::string("1\0", 2), "file");
  expect_refused(ardupilot, "ATC_ANG_RLL_P\n", "file:1: has 1 words");
  expect_refused(ardupilot, "MOT_THST_HOVER,1\n", "is 1, expected more than 0 and less than 1");
  expect_refused(ardupilot, "MOT_THST_HOVER,0\n", "is 0, expected more than 0 and less than 1");
  expect_refused(ardupilot, "MOT_SPIN_MIN,0.4\n", "MOT_SPIN_MIN is 0.4, expected 0 to 0.3");
  expect_refused(ardupilot, "PSC_NE_POS_P,1\n", "PSC_NE_POS_P belongs to ardupilot 4.7", "4.5");
  expect_refused(ardupilot, "PSC_POSXY_P,1\n", "PSC_POSXY_P belongs to ardupilot 4.6", "4.7");
  expect_refused(betaflight, "set p_roll = 45.5\n", "file:1: p_roll is 45.5, expected a whole");
  expect_refused(betaflight, "set d_min_roll = 30\n", "belongs to betaflight 4.5", "2025.12");
  expect_refused(crazyflie, "params: 3\n", "has no map 'params'");
  expect_refused(crazyflie, "params: {}\ntype: other\nversion: '1'\n", "persistent_param_state");
  expect_refused(crazyflie, "params: [\n", "is not YAML");
  expect_refused(crazyflie,
                 "params:\n  pid_rate.roll_kp:\n    is_stored: true\ntype: "
                 "persistent_param_state\nversion: '1'\n",
                 "file:2: pid_rate.roll_kp lacks default_value");
}

TEST(Firmware, FilesOfOtherProgramsAreRead) {
  using enum FirmwareKind;
  const ParameterFile windows =
      parse_parameters(newest(ardupilot),
                       "\xef\xbb\xbf# a comment\r\nATC_ANG_RLL_P 6\r\nSYSID_THISMAV,1\r\n", "file");
  ASSERT_EQ(windows.values.size(), 1u);
  EXPECT_EQ(windows.values[0].value, 6);
  EXPECT_EQ(windows.others, 1u);
  const ParameterFile dump = parse_parameters(
      newest(betaflight),
      "# diff all\nbatch start\nset gyro_lpf1_static_hz = 250\nprofile 0\nset p_roll = 50\n"
      "profile 1\nset p_roll = 60\nsave\n",
      "file");
  ASSERT_EQ(dump.values.size(), 2u);
  EXPECT_EQ(dump.values[1].value, 60);  // of the profile that is selected last
  EXPECT_THAT(dump.notes, Contains(HasSubstr("does not set simplified_pids_mode = OFF")));
  const ParameterFile misspelled =
      parse_parameters(newest(px4), "1\t1\tMC_ROLL_P\t6\t9\n1\t1\tMC_PICH_P\t6\t9\n", "file");
  EXPECT_EQ(misspelled.others, 0u);
  EXPECT_THAT(misspelled.notes, Contains(HasSubstr("did you mean MC_PITCH_P?")));
  // A name of another parameter that differs in its first letter only
  const ParameterFile other =
      parse_parameters(newest(betaflight), "set p_roll = 50\nset s_roll = 90\n", "file");
  EXPECT_EQ(other.others, 1u);
}

TEST(Firmware, VersionsAndSetupsAreRefusedByName) {
  EXPECT_EQ(firmware(FirmwareKind::px4, {"1.15.4", ""}, "here").version, "1.15");
  EXPECT_EQ(firmware(FirmwareKind::crazyflie, {"2025.10", ""}, "here").version, "2025.09");
  EXPECT_EQ(firmware(FirmwareKind::crazyflie, {"2025.12.1", ""}, "here").version, "2025.12.1");
  for (const char* version : {"1.13", "x", "1..15", "1.15.4.2.1"})
    EXPECT_THAT(
        [&] {
          (void)firmware(FirmwareKind::px4, {version, ""}, "here");
        },
        ThrowsMessage<InvalidInput>(HasSubstr("here: px4 has no version")));
  EXPECT_THAT(
      [] {
        (void)firmware(FirmwareKind::px4, {"", "legacy"}, "here");
      },
      ThrowsMessage<InvalidInput>(HasSubstr("does not apply to px4")));
  EXPECT_THAT(
      [] {
        (void)firmware(FirmwareKind::crazyflie, {"", "legcy"}, "here");
      },
      ThrowsMessage<InvalidInput>(HasSubstr("legacy")));
}

TEST(Firmware, FramesThatAMixerDoesNotKnowAreRefused) {
  Vehicle vehicle = testing::racing_vehicle(CommandLaw::speed);
  std::swap(vehicle.rotors[0].spin, vehicle.rotors[1].spin);
  for (const FirmwareKind kind :
       {FirmwareKind::ardupilot, FirmwareKind::betaflight, FirmwareKind::crazyflie})
    EXPECT_THAT([&] { (void)firmware_scale(newest(kind), vehicle, {}); },
                ThrowsMessage<InvalidInput>(HasSubstr("the firmware's mixer is made for it")));
  vehicle.rotors.pop_back();
  EXPECT_THAT([&] { (void)firmware_scale(newest(FirmwareKind::betaflight), vehicle, {}); },
              ThrowsMessage<InvalidInput>(HasSubstr("the vehicle has 3 rotors")));
  vehicle = testing::racing_vehicle(CommandLaw::speed);
  vehicle.mass = 10;
  EXPECT_THROW((void)firmware_scale(newest(FirmwareKind::betaflight), vehicle, {}), NoSolution);
}

TEST(Firmware, ExportIsVerifiedAndAChangedNumberIsFound) {
  const Vehicle vehicle = testing::sih_vehicle();
  for (const FirmwareKind kind : {FirmwareKind::px4, FirmwareKind::ardupilot}) {
    ExportContent content;
    content.vehicle = vehicle;
    content.cascade.emplace();
    content.cascade->gains = testing::usual_firmware_cascade();
    const testing::TemporaryDirectory directory;
    const ExportKind export_to(to_string(kind));
    (void)write_export(directory.path(), export_to, content);
    for (const VerifyCheck& check : firmware_checks(directory.path(), vehicle))
      EXPECT_TRUE(check.ok) << check.detail;
    // Changes each gain separately by one per cent.
    const Firmware target = newest(kind);
    const FirmwareParameters written = firmware_parameters(
        target, vehicle, exporter_of(export_to, "test").fit(content).cascade->gains);
    int found = 0, changed = 0;
    for (std::size_t i = 0; i < written.values.size(); ++i) {
      std::vector<Parameter> values = written.values;
      if (values[i].value == 0 || values[i].name == "MPC_THR_HOVER" ||
          values[i].name == "MOT_THST_HOVER" || values[i].name.find("ACCZ") != std::string::npos ||
          values[i].name.starts_with("CA_ROTOR"))
        continue;  // does not change these loops, or is checked with the geometry
      values[i].value *= 1.01;
      const CascadeGains read = cascade_of(firmware_loops(target, vehicle, values), {}, 0.0025);
      const CascadeGains meant =
          cascade_of(firmware_loops(target, vehicle, written.values), {}, 0.0025);
      bool differs = false;
      for (std::size_t k = 0; k < kCascadeAxes; ++k)
        differs |= std::abs(read.loops[k].Kp / meant.loops[k].Kp - 1) > 1e-4 ||
                   std::abs(read.loops[k].Kd / meant.loops[k].Kd - 1) > 1e-4;
      ++changed;
      found += differs;
      EXPECT_TRUE(differs) << values[i].name;
    }
    EXPECT_GT(changed, 10);
    EXPECT_EQ(found, changed);
  }
}

TEST(Firmware, FeedForwardAndTheDerivativeOfTheErrorAreFeedbackToo) {
  const Vehicle vehicle = testing::arducopter_vehicle();
  const Firmware ardupilot = firmware(FirmwareKind::ardupilot, {"4.5", ""}, "test");
  const auto roll = [&](const std::vector<Parameter>& values) {
    return loop_of(firmware_loops(ardupilot, vehicle, values), CascadeAxis::roll);
  };
  const FirmwareLoop usual = roll({});
  EXPECT_NEAR(usual.Kd(), usual.scale * (0.135 + 0.0036 * 4.5), 1e-12);
  const FirmwareLoop forward = roll({{"ATC_RAT_RLL_FF", 0.1}});
  EXPECT_NEAR(forward.Kp() - usual.Kp(), usual.scale * 0.1 * 4.5, 1e-12);
}

// D of 0.0036 and P of 0.135: a lead of 27 ms. ArduPilot's D acts on the error, so its P is Kd -
// A D, and a lead of more than Kd/(4 Kp) cannot be flown.
TEST(Firmware, LeadOfTheRateIsTheDerivativeGain) {
  CascadeGains gains = testing::usual_firmware_cascade();
  PidLoop& roll = gains.loops[index_of(CascadeAxis::roll)];
  roll.Ki = 0;
  roll.rate_lead = 0.2 * std::abs(roll.Kd / roll.Kp);
  const auto value = [&](FirmwareKind kind, const Vehicle& vehicle, const std::string& name) {
    return value_of(firmware_parameters(newest(kind), vehicle, gains).values, name);
  };
  const Vehicle sih = testing::sih_vehicle();
  expect_share(value(FirmwareKind::px4, sih, "MC_ROLLRATE_D"),
               roll.rate_lead * value(FirmwareKind::px4, sih, "MC_ROLLRATE_P"), 1e-6);
  const Vehicle copter = testing::arducopter_vehicle();
  const double P = value(FirmwareKind::ardupilot, copter, "ATC_RAT_RLL_P"),
               D = value(FirmwareKind::ardupilot, copter, "ATC_RAT_RLL_D"),
               A = value(FirmwareKind::ardupilot, copter, "ATC_ANG_RLL_P");
  expect_share((P * A) / (P + A * D), std::abs(roll.Kp / roll.Kd), 1e-6);
  expect_share(D / (P + A * D), roll.rate_lead, 1e-6);
  roll.rate_lead = 0.26 * std::abs(roll.Kd / roll.Kp);
  EXPECT_THAT(
      [&] { (void)value(FirmwareKind::ardupilot, copter, "ATC_RAT_RLL_P"); },
      ThrowsMessage<InvalidInput>(HasSubstr("because the firmware differentiates the error")));
  roll.rate_lead = std::nan("");
  EXPECT_THAT([&] { (void)value(FirmwareKind::px4, sih, "MC_ROLLRATE_P"); },
              ThrowsMessage<InvalidInput>(HasSubstr("the roll loop has rate_lead nan s")));
}

TEST(Firmware, RotorsOfABoardAreKnownByTheirPlaces) {
  Vehicle vehicle = testing::sih_vehicle();
  const Firmware px4 = newest(FirmwareKind::px4);
  const FirmwareScale own = firmware_scale(px4, vehicle, {});
  // The same rotors in another order, and similar but unequal places.
  std::vector<Parameter> values = {{"CA_ROTOR_COUNT", 4}};
  const double places[][3] = {{1, -1, -0.05}, {1, 1, 0.05}, {-1, 1, -0.05}, {-1, -1, 0.05}};
  for (int i = 0; i < 4; ++i) {
    values.push_back({fmt::format("CA_ROTOR{}_PX", i), places[i][0]});
    values.push_back({fmt::format("CA_ROTOR{}_PY", i), places[i][1]});
    values.push_back({fmt::format("CA_ROTOR{}_KM", i), places[i][2]});
  }
  const FirmwareScale other = firmware_scale(px4, vehicle, values);
  for (std::size_t i = 0; i < 3; ++i) EXPECT_NEAR(other.torque[i], own.torque[i], 1e-12);
  values.pop_back();
  EXPECT_THAT([&] { (void)firmware_scale(px4, vehicle, values); },
              ThrowsMessage<InvalidInput>(HasSubstr("gives 11 of CA_ROTOR*_PX, PY and KM")));
}

TEST(Firmware, StateFeedbackIsRefused) {
  ExportContent content;
  content.vehicle = testing::sih_vehicle();
  content.gains = Gains{};
  EXPECT_THAT([&] { (void)export_files(ExportKind("px4"), content); },
              ThrowsMessage<InvalidInput>(HasSubstr("cannot represent a gain matrix")));
}

}  // namespace
}  // namespace quadtune
