// SPDX-License-Identifier: Apache-2.0
/// Unknown words of options: the error has the key of the option, and its message no caller.
#include <gmock/gmock.h>

#include <functional>
#include <optional>
#include <string>

#include "quadtune/errors.hpp"
#include "quadtune/model/vehicle.hpp"
#include "quadtune/workbench/design/chosen_law.hpp"
#include "quadtune/workbench/design/design.hpp"
#include "quadtune/workbench/flight/fly.hpp"

namespace quadtune {
namespace {

using ::testing::StartsWith;

/// The message with which a call fails; empty if it throws another exception or none.
std::optional<OptionError> refused(const std::function<void()>& call) {
  try {
    call();
  } catch (const OptionError& error) {
    return error;
  } catch (const std::exception& error) {
    ADD_FAILURE() << "another exception: " << error.what();
    return std::nullopt;
  }
  ADD_FAILURE() << "nothing was thrown";
  return std::nullopt;
}

struct Refusal {
  std::string FlightOptions::*option;
  std::string word, key, message;
};

TEST(OptionError, CarriesTheKeyAndBeginsWithIt) {
  const Vehicle vehicle = load_vehicle("mambo");
  const Refusal refusals[] = {
      {&FlightOptions::estimator, "mamba", "estimator",
       "estimator: no estimator 'mamba', expected "},
      {&FlightOptions::sensors, "reel", "sensors", "sensors is 'reel', expected ideal or real"},
      {&FlightOptions::flow, "none", "flow", "flow: no flow model 'none', expected "},
      {&FlightOptions::wind, "storm", "wind", "wind: no wind 'storm', expected "},
      {&FlightOptions::solver, "rk", "solver", "solver: no solver 'rk', expected "},
      {&FlightOptions::integrator, "rk", "integrator", "integrator: no method 'rk', expected "},
      {&FlightOptions::controller, "mpc", "controller", "controller is 'mpc', expected "}};
  for (const Refusal& refusal : refusals) {
    FlightOptions options;
    options.*refusal.option = refusal.word;
    const auto error = refused([&] { (void)fly(vehicle, options); });
    ASSERT_TRUE(error) << refusal.key;
    EXPECT_EQ(error->option(), refusal.key);
    EXPECT_EQ(error->where(), refusal.key);
    EXPECT_THAT(error->what(), StartsWith(refusal.message));
  }
}

TEST(OptionError, NamesWhatTheVehicleLacks) {
  const Vehicle vehicle = load_vehicle("uquad");
  FlightOptions options;
  options.gains = "published";
  const auto gains = refused([&] { (void)fly(vehicle, options); });
  ASSERT_TRUE(gains);
  EXPECT_EQ(gains->option(), "gains");
  EXPECT_STREQ(gains->what(),
               "gains published: uquad has no published cascade, expected designed or a file");
  options = {};
  options.flow_rate = 50;
  const auto rate = refused([&] { (void)fly(vehicle, options); });
  ASSERT_TRUE(rate);
  EXPECT_EQ(rate->option(), "flow-rate");
}

TEST(OptionError, ComesFromAMissionOfADesignWithoutAFile) {
  DesignRequirements requirements;
  requirements.missions = {{.mission = "hover", .wind = "storm"}};
  const auto wind = refused([&] { (void)design(load_vehicle("mambo"), requirements); });
  ASSERT_TRUE(wind);
  EXPECT_EQ(wind->option(), "wind");
  requirements.missions = {{.mission = "hover", .controller = "lqr"}};
  const auto law = refused([&] { (void)design(load_vehicle("mambo"), requirements); });
  ASSERT_TRUE(law);
  EXPECT_EQ(law->option(), "controller");
  EXPECT_STREQ(law->what(),
               "controller of the mission 'hover' is state-feedback, expected the law "
               "that is designed, cascaded-pid");
}

// As for a design file with both.
TEST(DesignRequirements, HaveOneStateFeedbackOfHover) {
  const auto refusal = [](const DesignRequirements& requirements) -> std::string {
    try {
      (void)design(load_vehicle("mambo"), requirements);
    } catch (const InvalidInput& error) {
      return error.what();
    }
    return "";
  };
  DesignRequirements both;
  both.lqr = usual_lqr(load_vehicle("mambo"), 0.005);
  both.lqi = LqiDesign{};
  EXPECT_THAT(refusal(both),
              ::testing::HasSubstr("weights for both the ideal and the flown plant"));
  DesignRequirements moving;
  moving.lqi = LqiDesign{};
  moving.condition.kind = FlightKind::line;
  moving.condition.speed = 2;
  EXPECT_THAT(refusal(moving), ::testing::HasSubstr("the trim is 'line', expected hover"));
  DesignRequirements turned;
  turned.lqi = LqiDesign{};
  turned.condition.yaw = 0.3;
  EXPECT_THAT(refusal(turned), ::testing::HasSubstr("the trim has the yaw 0.3 rad, expected 0"));
}

TEST(OptionError, IsAnInvalidInput) {
  FlightOptions options;
  options.wind = "storm";
  EXPECT_THROW((void)fly(load_vehicle("mambo"), options), InvalidInput);
  EXPECT_THROW((void)plan_flight(FlightOptions{}, "fly"), OptionError);  // no vehicle
}

}  // namespace
}  // namespace quadtune
