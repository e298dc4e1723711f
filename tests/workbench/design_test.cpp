// SPDX-License-Identifier: Apache-2.0
/// A design in memory is that of a file, to the last bit.
#include "quadtune/workbench/design.hpp"

#include <gmock/gmock.h>

#include <string>
#include <vector>

#include "quadtune/errors.hpp"
#include "quadtune/model/vehicle.hpp"
#include "quadtune/workbench/export_content.hpp"
#include "same_bits.hpp"
#include "source_folder.hpp"

namespace quadtune {
namespace {

using ::testing::HasSubstr;
using ::testing::IsEmpty;
using testing::same_bits;
using ::testing::StartsWith;

const std::string kSource = testing::source_folder();

/// What a file asks for, in memory.
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

TEST(Design, InMemoryIsThatOfTheFile) {
  for (const std::string name : {"uquad-hover", "mambo-hover"}) {
    const std::string path = kSource + "/designs/" + name + ".toml";
    DesignOutcome file = run_design(std::filesystem::path(path));
    file.flights = fly_missions(file, 1, false);
    const DesignOutcome memory = design(file.design.vehicle, requirements_of(file.design));
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

TEST(Design, HasStandardWeightsWhereNothingIsAsked) {
  for (const std::string& name : built_in_vehicles()) {
    DesignRequirements requirements;
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

TEST(Design, TakesACascadeAndFliesIt) {
  const Vehicle vehicle = load_vehicle("mambo");
  DesignRequirements requirements;
  requirements.cascade = usual_cascade(vehicle);
  requirements.keep_logs = true;
  const DesignOutcome outcome = design(vehicle, requirements);
  ASSERT_TRUE(outcome.cascade);
  EXPECT_FALSE(unstable(*outcome.cascade));
  ASSERT_EQ(outcome.flights.size(), 1U);
  EXPECT_FALSE(outcome.flights[0].result.log.columns.empty());
  // The cascade that `quadtune fly` designs flies the same.
  FlightOptions options;
  options.controller = "cascaded-pid";
  EXPECT_EQ(outcome.flights[0].result.final_state, fly(vehicle, options).result.final_state);
  // Files can be made of it as of any design.
  const ExportContent content = export_content(outcome);
  EXPECT_EQ(content.cascade->gains.loops.size(), 6U);
  ASSERT_EQ(content.inputs.size(), 1U);
  EXPECT_EQ(content.inputs[0].name, "mambo.toml");
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
  EXPECT_THAT(doubtful_covariances(outcome.design), IsEmpty());
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
