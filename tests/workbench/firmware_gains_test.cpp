// SPDX-License-Identifier: Apache-2.0
#include "quadtune/workbench/firmware/firmware_gains.hpp"

#include <gmock/gmock.h>

#include <map>
#include <numbers>
#include <optional>

#include "quadtune/errors.hpp"
#include "quadtune/workbench/design/design.hpp"
#include "quadtune/workbench/design/usual_design.hpp"
#include "quadtune/workbench/design/vehicle_cascade.hpp"
#include "quadtune/workbench/firmware/firmware_import.hpp"
#include "quadtune/workbench/vehicle/new_vehicle.hpp"
#include "sanitized.hpp"
#include "source_folder.hpp"

namespace quadtune {
namespace {

using ::testing::HasSubstr;
using ::testing::StrEq;
using ::testing::ThrowsMessage;

Vehicle quad_450() { return load_vehicle(testing::source_folder() + "/vehicles/quad-450.toml"); }

/// The largest Ms of roll and pitch in a firmware's loops, without and with the angle loop.
double worst_Ms(const Firmware& target, const Vehicle& vehicle, const CascadeGains& cascade) {
  double worst = 0;
  for (const FirmwareTurn& turn :
       firmware_turns(target, vehicle, firmware_parameters(target, vehicle, cascade).values)) {
    EXPECT_TRUE(turn.whole.stable) << to_string(turn.gains.axis);
    worst = std::max(worst, turn.whole.Ms);
  }
  return worst;
}

// Gains for the flown plant alone exceed the bound in both firmwares, whose filters and delays the
// flown plant does not have. The other gains meet it in both, and in the flown loop.
TEST(FirmwareGains, MeetTheBoundInTheFirmwaresLoops) {
  const Vehicle vehicle = quad_450();
  const std::vector<Firmware> firmwares = {firmware(FirmwareKind::px4, {}, "test"),
                                           firmware(FirmwareKind::ardupilot, {}, "test")};
  FlownGainsOptions options;
  options.structure = CascadeStructure::p_pi;
  const FlownGains plain = flown_gains(vehicle, options);
  options.structure = CascadeStructure::pid;  // firmware_gains() chooses what the firmwares fly
  const FlownGains both = firmware_gains(vehicle, firmwares, options);
  for (const Firmware& target : firmwares) {
    EXPECT_GT(worst_Ms(target, vehicle, as_cascade(plain, options.dt)), 2.041)
        << to_string(target.kind);
    EXPECT_LT(worst_Ms(target, vehicle, as_cascade(both, options.dt)), 2.041)
        << to_string(target.kind);
  }
  EXPECT_LT(both.Ms(), 2.011);
  EXPECT_GT(both.disk(), 0.497);
  // The vertical axis was not designed again.
  EXPECT_EQ(both.axes[2].F, plain.axes[2].F);
}

// A lead of half the motor lag lets slow motors close a faster tilt loop with the same bound.
TEST(FirmwareGains, LeadOfTheRateMakesSlowMotorsFaster) {
  Vehicle vehicle = quad_450();
  for (Rotor& rotor : vehicle.rotors) rotor.lag = rotor.lag_down = 0.078;
  const std::vector<Firmware> px4 = {firmware(FirmwareKind::px4, {}, "test")};
  FlownGainsOptions options;
  options.structure = CascadeStructure::p_pi;
  const CascadeGains without = as_cascade(flown_gains(vehicle, options), options.dt),
                     with = as_cascade(firmware_gains(vehicle, px4, options), options.dt);
  EXPECT_LT(worst_Ms(px4.front(), vehicle, with), 2.041);
  for (const CascadeAxis axis : {CascadeAxis::pitch, CascadeAxis::roll}) {
    const PidLoop &a = without.loops[index_of(axis)], &b = with.loops[index_of(axis)];
    EXPECT_EQ(a.rate_lead, 0);
    EXPECT_DOUBLE_EQ(b.rate_lead, 0.039);
    EXPECT_NEAR(b.rate_filter, 1 / (2 * std::numbers::pi * 30), 1e-12);
    EXPECT_GT(b.Kp, 1.4 * a.Kp) << to_string(axis);
  }
  EXPECT_EQ(with.loops[index_of(CascadeAxis::yaw)].rate_lead, 0);
  const std::vector<Firmware> both = {px4.front(), firmware(FirmwareKind::betaflight, {}, "test")};
  EXPECT_EQ(as_cascade(firmware_gains(vehicle, both, options), options.dt)
                .loops[index_of(CascadeAxis::roll)]
                .rate_lead,
            0);
}

TEST(FirmwareGains, LeadOnRequestReplacesTheOneThatIsChosen) {
  Vehicle vehicle = quad_450();
  for (Rotor& rotor : vehicle.rotors) rotor.lag = rotor.lag_down = 0.078;
  const auto roll_of = [&](const std::vector<Firmware>& firmwares, std::optional<double> lead) {
    FlownGainsOptions options;
    options.rate_lead = lead;
    return as_cascade(firmware_gains(vehicle, firmwares, options), options.dt)
        .loops[index_of(CascadeAxis::roll)];
  };
  const PidLoop without = roll_of({}, {}), with = roll_of({}, 0.039);
  EXPECT_EQ(without.rate_lead, 0);
  EXPECT_EQ(with.rate_lead, 0.039);
  EXPECT_DOUBLE_EQ(with.rate_filter, 0.039 / 4);
  EXPECT_GT(with.Kp, 1.2 * without.Kp);
  if constexpr (testing::kSanitized) return;  // minutes of designs like those above
  EXPECT_EQ(roll_of({firmware(FirmwareKind::px4, {}, "test")}, 0).rate_lead, 0);
}

/// A small vehicle with brushed motors and optical flow.
Vehicle brushed_toy(double mass, double arm, double propeller) {
  MeasuredVehicle measured;
  measured.name = "toy";
  measured.mass = mass;
  measured.arm = arm;
  measured.propeller = propeller;
  measured.brushed = true;
  measured.thrust_to_weight = 2.2;
  measured.sensors = SensorSet::flow;
  return new_vehicle(measured).vehicle;
}

// With a lead of half the lag of brushed motors, no gain on the angle before a PID controller of
// the rate, whose D acts on the error, has the loops of a small vehicle. A shorter lead has.
TEST(FirmwareGains, LeadIsAsShortAsArdupilotNeedsIt) {
  if constexpr (testing::kSanitized) GTEST_SKIP() << "a minute of designs like those above";
  const Vehicle vehicle = brushed_toy(0.047, 0.034, 0.0447);
  const Firmware ardupilot = firmware(FirmwareKind::ardupilot, {}, "test");
  const CascadeGains gains = as_cascade(firmware_gains(vehicle, {ardupilot}, {}), 0.005);
  const double lead = gains.loops[index_of(CascadeAxis::roll)].rate_lead;
  EXPECT_LT(lead, 0.9 * 0.039);
  EXPECT_GT(lead, 0.01);
  EXPECT_LT(worst_Ms(ardupilot, vehicle, gains), 2.041);
}

// The motors of this vehicle are so slow that its tilt loops cannot have both the usual integral
// and the margins in a structure that ArduPilot represents. The design then reduces the integral.
TEST(FirmwareGains, IntegralIsAsSlowAsTheStructureNeedsIt) {
  if constexpr (testing::kSanitized) GTEST_SKIP() << "a minute of designs like those above";
  const Vehicle vehicle = brushed_toy(0.035, 0.0299, 0.0393);
  const Firmware ardupilot = firmware(FirmwareKind::ardupilot, {}, "test");
  const CascadeGains gains = as_cascade(firmware_gains(vehicle, {ardupilot}, {}), 0.005);
  for (const CascadeAxis axis : {CascadeAxis::roll, CascadeAxis::pitch}) {
    const PidLoop& loop = gains.loops[index_of(axis)];
    EXPECT_NE(loop.Ki, 0) << loop.name;
    EXPECT_LE(4 * std::abs(loop.Ki * loop.Kd), loop.Kp * loop.Kp * (1 + 1e-9)) << loop.name;
  }
  EXPECT_NO_THROW((void)firmware_parameters(ardupilot, vehicle, gains));
}

TEST(FirmwareGains, WithoutAFirmwareAreTheFlownGains) {
  const Vehicle vehicle = load_vehicle("crazyflie");
  const FlownGains plain = flown_gains(vehicle), same = firmware_gains(vehicle, {}, {});
  ASSERT_EQ(plain.axes.size(), same.axes.size());
  for (std::size_t k = 0; k < plain.axes.size(); ++k) EXPECT_EQ(plain.axes[k].F, same.axes[k].F);
}

TEST(FirmwareGains, StructureIsThatOfTheFirmware) {
  EXPECT_EQ(structure_of(FirmwareKind::px4), CascadeStructure::p_pi);
  EXPECT_EQ(structure_of(FirmwareKind::ardupilot), CascadeStructure::p_pi);
  EXPECT_EQ(structure_of(FirmwareKind::betaflight), CascadeStructure::p_pi);
  EXPECT_EQ(structure_of(FirmwareKind::crazyflie), CascadeStructure::pid);
}

TEST(UsualDesign, ExportsWhatIsAskedFor) {
  const auto exports = [](const std::vector<std::string>& to) {
    std::vector<std::string> names;
    for (const ExportRequest& request : usual_design("crazyflie", to).exports)
      names.push_back(request.to);
    return names;
  };
  using Names = std::vector<std::string>;
  EXPECT_EQ(exports({}), (Names{"json", "c"}));
  EXPECT_EQ(exports({"px4", "json"}), (Names{"px4", "json"}));
}

TEST(UsualDesign, HasALeadOfHalfTheLagIfTheMotorsAreSlow) {
  const auto lead = [](const std::string& vehicle, const std::vector<std::string>& to) {
    return usual_design(vehicle, to).cascade->rate_lead;
  };
  const std::string quad = testing::source_folder() + "/vehicles/quad-450.toml";
  EXPECT_EQ(lead(quad, {}), 0.025);  // half of the 50 ms of falling speed
  EXPECT_EQ(lead("crazyflie", {"json"}), 0.036);
  // A firmware has its own lead, or none; the motors of a Mambo have no lag; the loops of a uquad
  // are designed one by one.
  EXPECT_EQ(lead(quad, {"json", "px4"}), std::nullopt);
  EXPECT_EQ(lead("mambo", {}), std::nullopt);
  EXPECT_EQ(lead("uquad", {}), std::nullopt);
}

TEST(UsualDesign, RefusesExportsThatDoNotExistOrHoldNoCascade) {
  const std::map<std::string, std::vector<std::string>> refused = {
      {"to: no export to 'px5', expected uquad, mambo, json, mat, c, px4, ardupilot, betaflight, "
       "crazyflie",
       {"json", "px5"}},
      {"to: 'json' is requested twice, expected once", {"json", "c", "json"}},
      {"to: 'uquad' holds the gains of a state feedback, expected json, mat, c or a firmware, "
       "because "
       "a design without a design file is a cascade",
       {"uquad"}}};
  for (const auto& entry : refused)
    EXPECT_THAT([&] { (void)usual_design("crazyflie", entry.second); },
                ThrowsMessage<OptionError>(StrEq(entry.first)));
  const std::filesystem::path file = testing::source_folder() + "/designs/uquad-hover.toml";
  EXPECT_THAT([&] { (void)run_design(file, {"json"}); },
              ThrowsMessage<OptionError>(HasSubstr("because a design file lists its exports")));
}

TEST(VehicleCascade, RefusesFirmwareOptionsThatContradictEachOther) {
  const auto refusal = [](const CascadeOptions& options) -> std::string {
    try {
      (void)vehicle_cascade(load_vehicle("crazyflie"), options, "test");
    } catch (const OptionError& error) {
      return error.option() + ": " + error.what();
    }
    return "accepted";
  };
  CascadeOptions options;
  options.firmware.version = "1.16";
  EXPECT_EQ(refusal(options),
            "firmware: firmware is given without a firmware, expected --for as well");
  options.for_firmware = "px5";
  EXPECT_EQ(refusal(options),
            "for: for: no firmware 'px5', expected px4, ardupilot, betaflight, crazyflie");
  options.for_firmware = "px4";
  options.firmware.version = "0.9";
  EXPECT_THAT(refusal(options), HasSubstr("firmware: px4"));
  options.firmware.version = "";
  options.structure = "pid";
  EXPECT_EQ(refusal(options),
            "structure: structure is 'pid', expected p-pi, because px4 flies a gain before a PI "
            "controller of the rate");
  options.structure = {};
  options.firmware.setup = "legacy";
  EXPECT_THAT(refusal(options), HasSubstr("setup: set-up 'legacy' does not apply to px4"));
  options.firmware.setup = "";
  options.bandwidth = "20";
  EXPECT_EQ(
      refusal(options),
      "for: for requires the flown plant, expected --method flown, because --method loops does "
      "not include the filters of a firmware");
}

}  // namespace
}  // namespace quadtune
