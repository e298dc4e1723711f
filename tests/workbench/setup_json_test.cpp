// SPDX-License-Identifier: Apache-2.0
#include "campaign/setup_json.hpp"

#include <gmock/gmock.h>

#include <algorithm>
#include <cstddef>
#include <limits>
#include <type_traits>
#include <utility>
#include <vector>

#include "quadtune/errors.hpp"
#include "quadtune/internal/json.hpp"

namespace quadtune {
namespace {

using ::testing::HasSubstr;
using ::testing::ThrowsMessage;

/// Changes every field of settings with a visitor to a distinct number.
template <class Settings>
void change_all(Settings& settings) {
  double next = 0.1;
  Settings::each_field(
      [&next](const char*, auto& field) {
        using Field = std::remove_reference_t<decltype(field)>;
        next += 1.0 / 3;
        if constexpr (std::is_same_v<Field, bool>)
          field = !field;
        else if constexpr (std::is_same_v<Field, MamboPosition>)
          field = MamboPosition::flow_velocity;
        else if constexpr (std::is_same_v<Field, int>)
          field += 3;
        else if constexpr (requires { field.size(); })
          for (auto& entry : field) entry = next += 1.0 / 3;
        else
          field = next;
      },
      settings);
}

/// Sets every field that setup_to_json() writes to another value than its default.
FlightSetup changed_setup() {
  FlightSetup setup;
  setup.estimator = EstimatorKind::general;
  setup.flow = FlowModel::simplified;
  setup.allocation = AllocationRule::prioritized;
  setup.integrator = Integrator::euler;
  setup.real_sensors = false;
  setup.flow_rate = 51.3;
  setup.step = 0.1 / 3;
  setup.duration = 7.7;
  setup.safety = {0.7, 31, 2.5, std::numeric_limits<double>::infinity()};
  setup.environment.dynamic = true;
  setup.environment.ground_height = 412.5;
  setup.environment.magnetic_field = {19, -1, 1.0 / 3};
  setup.environment.wind.mean = {1, 2, 3};
  setup.environment.wind.gust = {{4, 5, 6}, 7, 8};
  setup.environment.wind.turbulence = 9;
  setup.environment.wind.turbulence_height = 10;
  setup.mission.start.take_off_by = TakeOff::thrust;
  setup.mission.start.take_off = 1.25;
  setup.mission.limits = {{Metric::tilt_max, 0.5}, {Metric::energy, 1e-300}};
  setup.mission.settling = {0.01, 0.02, 3, 0.04, 0.05};
  change_all(setup.mambo_estimator);
  change_all(setup.uquad_filter);
  change_all(setup.general_noise);
  return setup;
}

TEST(SetupJson, EveryFieldReadsBackToTheSameBits) {
  const FlightSetup written = changed_setup();
  // Through text, as in a plan.
  const auto json = internal::Json::parse(internal::readable(internal::setup_to_json(written)));
  FlightSetup read;
  internal::setup_from_json(json, "plan.json", read);
  EXPECT_EQ(read.estimator, written.estimator);
  EXPECT_EQ(read.flow, written.flow);
  EXPECT_EQ(read.allocation, written.allocation);
  EXPECT_EQ(read.integrator, written.integrator);
  EXPECT_EQ(read.real_sensors, written.real_sensors);
  EXPECT_EQ(read.flow_rate, written.flow_rate);
  EXPECT_EQ(read.step, written.step);
  EXPECT_EQ(read.duration, written.duration);
  EXPECT_EQ(read.safety, written.safety);
  EXPECT_EQ(read.environment.dynamic, written.environment.dynamic);
  EXPECT_EQ(read.environment.ground_height, written.environment.ground_height);
  EXPECT_EQ(read.environment.magnetic_field, written.environment.magnetic_field);
  EXPECT_EQ(read.environment.wind.mean, written.environment.wind.mean);
  EXPECT_EQ(read.environment.wind.gust.velocity, written.environment.wind.gust.velocity);
  EXPECT_EQ(read.environment.wind.gust.start, written.environment.wind.gust.start);
  EXPECT_EQ(read.environment.wind.gust.length, written.environment.wind.gust.length);
  EXPECT_EQ(read.environment.wind.turbulence, written.environment.wind.turbulence);
  EXPECT_EQ(read.environment.wind.turbulence_height, written.environment.wind.turbulence_height);
  EXPECT_EQ(read.mission, written.mission);
  EXPECT_EQ(read.mambo_estimator, written.mambo_estimator);
  EXPECT_EQ(read.uquad_filter, written.uquad_filter);
  EXPECT_EQ(read.general_noise, written.general_noise);
}

/// Between the fields that a visitor visits there is room only for padding, not for a number.
template <class Settings>
void expect_visits_all() {
  const Settings settings;
  std::vector<std::pair<const char*, const char*>> fields;  // begin and end
  Settings::each_field(
      [&fields](const char*, const auto& field) {
        const auto* begin = reinterpret_cast<const char*>(&field);
        fields.emplace_back(begin, begin + sizeof(field));
      },
      settings);
  std::sort(fields.begin(), fields.end());
  const auto* at = reinterpret_cast<const char*>(&settings);
  fields.emplace_back(at + sizeof(settings), nullptr);
  for (const auto& [begin, end] : fields) {
    EXPECT_LT(begin - at, static_cast<std::ptrdiff_t>(sizeof(double)));
    at = end;
  }
}

TEST(SetupJson, VisitorsShowEveryField) {
  expect_visits_all<MamboEstimatorSettings<double>>();
  expect_visits_all<UquadFilterSettings<double>>();
  expect_visits_all<GeneralFilterNoise>();
}

// A missing field would silently keep its default, and the flight would differ.
TEST(SetupJson, AMissingFieldIsRefused) {
  const internal::Json whole = internal::setup_to_json(changed_setup());
  for (const std::string& key : whole.keys()) {
    internal::Json less = internal::Json::object();
    for (const std::string& other : whole.keys())
      if (other != key) less[other] = whole[other];
    FlightSetup setup;
    EXPECT_THAT([&] { internal::setup_from_json(less, "plan.json", setup); },
                ThrowsMessage<InvalidInput>(HasSubstr(key)))
        << key;
  }
}

}  // namespace
}  // namespace quadtune
