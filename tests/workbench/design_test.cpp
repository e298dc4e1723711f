// SPDX-License-Identifier: Apache-2.0
/// A design in memory is identical to that of a file, to the last bit.
#include "quadtune/workbench/design/design.hpp"

#include <fmt/format.h>
#include <gmock/gmock.h>

#include <string>
#include <vector>

#include "quadtune/design/export_target.hpp"
#include "quadtune/errors.hpp"
#include "quadtune/model/vehicle.hpp"
#include "quadtune/workbench/export/export_content.hpp"
#include "same_bits.hpp"
#include "sanitized.hpp"
#include "source_folder.hpp"

namespace quadtune {
namespace {

using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::IsEmpty;
using testing::same_bits;
using ::testing::StartsWith;

const std::string kSource = testing::source_folder();

/// The requirements of a file, in memory.
DesignRequirements requirements_of(const Design& file) {
  DesignRequirements requirements;
  requirements.name = file.name;
  requirements.condition = file.condition;
  requirements.lqr = file.lqr;
  requirements.cascade = file.cascade;
  requirements.kalman = file.kalman;
  requirements.missions = file.missions;
  return requirements;
}

template <class Matrix>
bool same(const Matrix& a, const Matrix& b) {
  if (a.rows() != b.rows() || a.cols() != b.cols()) return false;
  return (a.array() == b.array()).all();
}

// The estimator of a flight program is defined by its exporter, not by the library.
TEST(Design, FliesWithTheEstimatorOfAnAddedExporter) {
  add_export_target({.name = "own-program", .takes_memory = true, .estimator = "general"});
  Design design = load_design(kSource + "/designs/crazyflie-flight.toml");
  EXPECT_EQ(program_estimator(design), "");
  design.exports.push_back({"own-program"});
  EXPECT_EQ(program_estimator(design), "general");
  Sensors& sensors = design.vehicle.sensors;
  sensors.flow.reset();
  sensors.gps.reset();
  sensors.vision.reset();
  EXPECT_EQ(program_estimator(design), "") << "nothing measures the velocity";
}

TEST(Design, InMemoryIsThatOfTheFile) {
  if (testing::kSanitized) GTEST_SKIP() << "minutes of what other tests run too";
  for (const std::string name : {"uquad-hover", "mambo-hover"}) {
    const std::string path = fmt::format("{}/designs/{}.toml", kSource, name);
    DesignOutcome file = run_design(std::filesystem::path(path));
    file.flights = fly_missions(file, 1, false);
    // A design in memory has no export whose estimator it would fly with.
    DesignRequirements requirements = requirements_of(file.design);
    for (MissionRequest& mission : requirements.missions)
      mission.estimator = name == "uquad-hover" ? "uquad" : "mambo";
    const DesignOutcome memory = design(file.design.vehicle, requirements);
    ASSERT_TRUE(file.gains && memory.gains);
    EXPECT_TRUE(same(file.gains->K, memory.gains->K)) << name;
    EXPECT_TRUE(same(file.gains->K_int, memory.gains->K_int)) << name;
    EXPECT_TRUE(same(file.poles, memory.poles)) << name;
    ASSERT_EQ(file.margins->loops.size(), memory.margins->loops.size());
    for (std::size_t i = 0; i < file.margins->loops.size(); ++i)
      EXPECT_TRUE(
          same_bits(file.margins->loops[i].phase_margin, memory.margins->loops[i].phase_margin));
    ASSERT_EQ(file.cascade.has_value(), memory.cascade.has_value());
    if (file.cascade)
      for (std::size_t i = 0; i < file.cascade->cascade.gains.loops.size(); ++i) {
        const PidLoop& a = file.cascade->cascade.gains.loops[i];
        const PidLoop& b = memory.cascade->cascade.gains.loops[i];
        EXPECT_TRUE(same_bits(a.Kp, b.Kp) && same_bits(a.Ki, b.Ki) && same_bits(a.Kd, b.Kd));
      }
    ASSERT_EQ(file.filters.size(), memory.filters.size());
    for (std::size_t i = 0; i < file.filters.size(); ++i)
      EXPECT_TRUE(same(file.filters[i].filter.M, memory.filters[i].filter.M));
    ASSERT_EQ(file.flights.size(), memory.flights.size());
    ASSERT_FALSE(file.flights.empty());
    for (std::size_t i = 0; i < file.flights.size(); ++i) {
      EXPECT_EQ(file.flights[i].result.final_state, memory.flights[i].result.final_state);
      EXPECT_EQ(file.flights[i].plan.law, memory.flights[i].plan.law);
      EXPECT_TRUE(memory.flights[i].passed);
    }
  }
}

TEST(Design, IsTheUsualCascadeWhereNothingIsAsked) {
  for (const std::string& name : built_in_vehicles()) {
    if (testing::kSanitized && name != "mambo") continue;
    const DesignOutcome outcome = design(load_vehicle(name));
    ASSERT_TRUE(outcome.cascade) << name;
    EXPECT_FALSE(outcome.gains);
    EXPECT_TRUE(missions_passed(outcome)) << name;
    ASSERT_EQ(outcome.flights.size(), 1U);
    EXPECT_EQ(outcome.flights[0].plan.law, "cascaded PID of " + name);
    EXPECT_EQ(outcome.flights[0].plan.sensors, "real");
  }
}

// The same cascade, from a file without further settings.
TEST(Design, FilesOfFlightsHaveTheUsualCascadeAndPass) {
  if (testing::kSanitized) GTEST_SKIP() << "minutes of what other tests run too";
  for (const std::string name : {"uquad", "rolling-spider", "crazyflie"}) {
    DesignOutcome file =
        run_design(std::filesystem::path(fmt::format("{}/designs/{}-flight.toml", kSource, name)));
    const DesignOutcome usual = design(load_vehicle(name));
    const CascadeGains &a = file.cascade->cascade.gains, &b = usual.cascade->cascade.gains;
    ASSERT_EQ(a.loops.size(), 6U);
    EXPECT_EQ(a.dt, b.dt);
    for (std::size_t i = 0; i < a.loops.size(); ++i)
      EXPECT_TRUE(same_bits(a.loops[i].Kp, b.loops[i].Kp) &&
                  same_bits(a.loops[i].Ki, b.loops[i].Ki) &&
                  same_bits(a.loops[i].Kd, b.loops[i].Kd))
          << name << i;
    EXPECT_EQ(file.design.cascade->attitude_limit, usual.design.cascade->attitude_limit);
    EXPECT_EQ(file.design.cascade->back_calculation, usual.design.cascade->back_calculation);
    file.flights = fly_missions(file, 1, false);
    ASSERT_EQ(file.flights.size(), 3U);
    EXPECT_TRUE(missions_passed(file)) << name;
  }
}

// The position loops of a cascade, cut at the tilt command.
TEST(Design, PositionLoopsKeepTheirPhase) {
  if (testing::kSanitized) GTEST_SKIP() << "minutes of what other tests run too";
  for (const std::string& name : built_in_vehicles()) {
    const DesignOutcome outcome = design(load_vehicle(name));
    for (const CascadeAxisDesign& loop : outcome.cascade->cascade.loops) {
      if (loop.axis != CascadeAxis::x && loop.axis != CascadeAxis::y) continue;
      EXPECT_GT(loop.design.evidence.margins.phase_margin, 0.52) << name;  // 30 deg
    }
  }
}

TEST(Design, HasTheStandardWeightsOfAnLqr) {
  for (const std::string& name : built_in_vehicles()) {
    if (testing::kSanitized && name != "mambo") continue;
    DesignRequirements requirements;
    requirements.lqr = usual_lqr(load_vehicle(name));
    requirements.missions = {{.mission = "hover", .sensors = "ideal"}};
    const DesignOutcome outcome = design(load_vehicle(name), requirements);
    ASSERT_TRUE(outcome.gains) << name;
    EXPECT_EQ(outcome.gains->K.rows(), 4);
    EXPECT_EQ(outcome.gains->K.cols(), 12);
    EXPECT_LT(outcome.poles.cwiseAbs().maxCoeff(), 1) << name;
    EXPECT_TRUE(missions_passed(outcome)) << name;
    ASSERT_EQ(outcome.flights.size(), 1U);
    EXPECT_EQ(outcome.flights[0].plan.law, "state feedback of " + name);
    EXPECT_FALSE(outcome.cascade);
  }
}

// Five seeds, a gust, and a load of a tenth of the mass that is picked up; all flights must pass.
TEST(Design, FliesSeedsAGustAndALoad) {
  const Vehicle vehicle = load_vehicle("mambo");
  DesignRequirements requirements;
  requirements.cascade = usual_cascade(vehicle);
  requirements.seed = 3;
  DesignOutcome outcome = design(vehicle, requirements);
  ASSERT_EQ(outcome.flights.size(), 1U);
  ASSERT_EQ(outcome.flights[0].seeds.size(), 5U);
  for (std::size_t i = 0; i < 5; ++i) EXPECT_EQ(outcome.flights[0].seeds[i].seed, 3 + i);
  ASSERT_EQ(outcome.disturbed.size(), 2U);
  const FlownFlight &gust = outcome.disturbed[0], &load = outcome.disturbed[1];
  EXPECT_EQ(gust.variant, "gust");
  EXPECT_NEAR(gust.plan.setup.environment.wind.gust.velocity.norm(), kGustSpeed, 1e-12);
  EXPECT_EQ(gust.plan.wind, "a gust of 3 m/s");
  EXPECT_THAT(gust.plan.notes,
              ElementsAre("the file of 'mambo' has no drag: the gust does not move the vehicle"));
  EXPECT_EQ(load.plan.wind, "calm");
  EXPECT_THAT(load.plan.notes, IsEmpty());
  EXPECT_EQ(load.variant, "load");
  ASSERT_EQ(load.plan.setup.mission.events.size(), 1U);
  const FlightEvent& event = load.plan.setup.mission.events[0];
  EXPECT_EQ(event.time, duration_of(load.plan.setup) / 2);
  EXPECT_NEAR(std::get<LoadChange>(event.what).mass, 0.1 * vehicle.mass, 1e-12);
  // The weight initially lowers the vehicle.
  EXPECT_GT(load.result.metrics[Metric::height_max],
            2 * outcome.flights[0].result.metrics[Metric::height_max]);
  EXPECT_TRUE(missions_passed(outcome));
  outcome.disturbed[1].passed = false;
  EXPECT_FALSE(missions_passed(outcome));
}

TEST(Design, TakesACascadeAndFliesIt) {
  if (testing::kSanitized) GTEST_SKIP() << "minutes of what other tests run too";
  const Vehicle vehicle = load_vehicle("mambo");
  DesignRequirements requirements;
  requirements.cascade = usual_cascade(vehicle);
  requirements.keep_logs = true;
  const DesignOutcome outcome = design(vehicle, requirements);
  ASSERT_TRUE(outcome.cascade);
  EXPECT_FALSE(unstable(*outcome.cascade));
  ASSERT_EQ(outcome.flights.size(), 1U);
  EXPECT_FALSE(outcome.flights[0].result.log.columns.empty());
  // The cascade that `quadtune fly` designs gives the same flight.
  FlightOptions options;
  options.controller = "cascaded-pid";
  EXPECT_EQ(outcome.flights[0].result.final_state, fly(vehicle, options).result.final_state);
  // It can be exported like any design.
  const ExportContent content = export_content(outcome);
  EXPECT_EQ(content.cascade->gains.loops.size(), 6U);
  ASSERT_EQ(content.inputs.size(), 1U);
  EXPECT_EQ(content.inputs[0].name, "mambo.toml");
}

/// Its law is that of `fly V --controller state-feedback`, and passes with its own sensors.
TEST(Design, TakesAStateFeedbackForTheFlownPlant) {
  const Vehicle vehicle = load_vehicle("crazyflie");
  DesignRequirements requirements;
  requirements.lqi = LqiDesign();
  requirements.seeds = 1;
  const DesignOutcome outcome = design(vehicle, requirements);
  EXPECT_TRUE(missions_passed(outcome));
  ASSERT_TRUE(outcome.lqi && outcome.gains && outcome.gains->memory);
  EXPECT_FALSE(outcome.cascade);
  FlightOptions flight;
  flight.controller = kStateFeedback;
  const ChosenLaw usual = choose_law(flight, vehicle, "test");
  const Gains& flown = std::get<StateFeedbackController>(usual.controller).gains;
  EXPECT_EQ(outcome.gains->K, flown.K);
  EXPECT_EQ(outcome.gains->memory->K_past, flown.memory->K_past);
  EXPECT_EQ(outcome.gains->limits, flown.limits);
  const ExportContent content = export_content(outcome);
  ASSERT_TRUE(content.estimator && content.estimator->general);
  EXPECT_EQ(content.estimator->name, "general");
}

TEST(Design, NamesItselfWhereThereIsNoFile) {
  Vehicle heavy = load_vehicle("mambo");
  heavy.mass *= 10;
  try {
    (void)design(heavy);
    FAIL() << "it cannot hover";
  } catch (const NoSolution& error) {
    EXPECT_THAT(error.what(), StartsWith("mambo: no hover trim: "));
    EXPECT_EQ(error.where(), "mambo");
  }
}

TEST(Design, FliesNothingWhereNothingIsAsked) {
  DesignRequirements requirements;
  requirements.missions.clear();
  const DesignOutcome outcome = design(load_vehicle("crazyflie"), requirements);
  EXPECT_THAT(outcome.flights, IsEmpty());
  EXPECT_TRUE(missions_passed(outcome));
  EXPECT_THAT(unconfirmed_covariances(outcome.design), IsEmpty());
}

TEST(Design, RefusesAMissionThatThereIsNot) {
  DesignRequirements requirements;
  requirements.missions = {{.mission = "hoover"}};
  try {
    (void)design(load_vehicle("mambo"), requirements);
    FAIL() << "there is no such mission";
  } catch (const InvalidInput& error) {
    EXPECT_THAT(error.what(), HasSubstr("hoover"));
  }
}

}  // namespace
}  // namespace quadtune
