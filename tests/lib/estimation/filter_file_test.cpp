// SPDX-License-Identifier: Apache-2.0
#include "quadtune/estimation/filter_file.hpp"

#include <fmt/format.h>
#include <gmock/gmock.h>

#include <cmath>

#include "matrix_near.hpp"
#include "quadtune/errors.hpp"

namespace quadtune {
namespace {

using Eigen::MatrixXd;
using Eigen::VectorXd;
using ::testing::ElementsAre;
using ::testing::HasSubstr;
using testing::MatrixNear;
using ::testing::StrEq;
using ::testing::ThrowsMessage;

const std::string kHead = R"(name = "cart"
period_s = 0.1
states = ["p [m]", "v [m/s]"]
inputs = ["a [m/s2]"]
noises = ["a", "b"]
A = [[1, 0.1], [0, 1]]
B = [[0.005], [0.1]]
G = [[1, 0], [0, 1]]
)";
const std::string kSensor = R"([[sensors]]
name = "camera"
outputs = ["x [m]", "y [m]"]
C = [[1, 0], [0, 1]]
D = [[0], [0.5]]
delay_s = 0.2
)";

TEST(FilterFile, SaysWhatIsToBeFound) {
  const FilterModel m = parse_filter_model(kHead + R"(
[[Q]]
entries = ["a"]
variance = 2
unit = "m2"
prior_median = 3
prior_deviation = 0.5
[[Q]]
entries = ["b"]
kind = "fixed"
variance = 4
)" + kSensor + R"(
[[sensors.R]]
kind = "full"
covariance = [[4, 1], [1, 9]]
[initial]
x = [1, 2]
variance = [3, 0]
)",
                                           "m.toml");
  EXPECT_EQ(m.name, "cart");
  EXPECT_EQ(m.dt, 0.1);
  EXPECT_EQ(m.states[1], (Signal{"v", "m/s"}));
  EXPECT_EQ(m.inputs[0].unit, "m/s2");
  ASSERT_EQ(m.parameters.size(), 4u);
  EXPECT_EQ(m.parameters[0].name, "Q.a");
  EXPECT_EQ(m.parameters[0].unit, "m2");
  EXPECT_EQ(m.parameters[0].prior->median, 3);
  EXPECT_EQ(m.parameters[1].name, "R.x");
  EXPECT_EQ(m.parameters[2].name, "R.y:x");
  EXPECT_FALSE(m.parameters[2].logarithmic);
  EXPECT_EQ(m.parameters[3].name, "R.y");
  const VectorXd theta = start_of(m);
  EXPECT_THAT(covariance(m.Q, theta), MatrixNear(MatrixXd{{2, 0}, {0, 4}}, 1e-15));
  EXPECT_THAT(covariance(m.sensors[0].R, theta), MatrixNear(MatrixXd{{4, 1}, {1, 9}}, 1e-14));
  EXPECT_EQ(m.sensors[0].delay, 0.2);
  EXPECT_THAT(m.sensors[0].D, MatrixNear(MatrixXd{{0}, {0.5}}, 0));
  EXPECT_THAT(m.x0, MatrixNear(VectorXd{{1, 2}}, 0));
  EXPECT_THAT(m.P0, MatrixNear(MatrixXd{{3, 0}, {0, 0}}, 0));
  EXPECT_THAT(m.diffuse, ElementsAre(false, false));
}

TEST(FilterFile, SharesOneVarianceOrGivesEachItsOwn) {
  const auto with = [](const std::string& R) {
    return parse_filter_model(
        kHead + "[[Q]]\nvariance = [1, 2]\n" + kSensor + "[[sensors.R]]\nvariance = 5\n" + R,
        "m.toml");
  };
  const FilterModel each = with("");
  EXPECT_EQ(each.parameters.size(), 4u);
  EXPECT_EQ(each.parameters[2].name, "R.x");
  const FilterModel shared = with("kind = 'shared'\n");
  EXPECT_EQ(shared.parameters.size(), 3u);
  EXPECT_EQ(shared.parameters[2].name, "R.x-y");
  EXPECT_THAT(covariance(shared.sensors[0].R, start_of(shared)),
              MatrixNear(5 * MatrixXd::Identity(2, 2), 1e-14));
  EXPECT_THAT(each.diffuse, ElementsAre(true, true));
}

TEST(FilterFile, BuiltInModelsAreThoseOfTheSources) {
  std::vector<std::string> names;
  for (const FilterModelTitle& title : built_in_filter_models()) {
    names.push_back(title.name);
    EXPECT_FALSE(title.description.empty());
  }
  EXPECT_THAT(names, ElementsAre("local-level", "constant-velocity", "altitude", "velocity-xy",
                                 "attitude", "inertial", "inertial-ned", "uquad"));
  // Oliveira 2020, tables 3.1 and 3.2: 0.0005 and 0.09 a step of 5 ms.
  const FilterModel altitude = load_filter_model("altitude");
  EXPECT_NEAR(covariance(altitude.Q, start_of(altitude))(0, 0) * 0.005, 0.0005, 1e-15);
  const FilterModel velocity = load_filter_model("velocity-xy");
  EXPECT_THAT(covariance(velocity.Q, start_of(velocity)) * 0.005,
              MatrixNear(0.09 * MatrixXd::Identity(2, 2), 1e-14));
  EXPECT_THAT(covariance(velocity.sensors[0].R, start_of(velocity)),
              MatrixNear(5 * MatrixXd::Identity(2, 2), 1e-14));
}

TEST(FilterFile, RefusesWhatNonlinearFiltersDoNotLookAt) {
  std::string text = text_of_filter_model(load_filter_model("inertial"));
  const std::size_t at = text.find("[[sensors.R]]");
  text.insert(at, "D = [[1, 0, 0, 0, 0, 0], [0, 0, 0, 0, 0, 0], [0, 0, 0, 0, 0, 0]]\n");
  EXPECT_THAT([&] { (void)parse_filter_model(text, "m.toml"); },
              ThrowsMessage<InvalidInput>(::testing::HasSubstr(
                  "D is given, expected no such key because the dynamics are 'inertial'")));
}

TEST(FilterFile, RefusesWhatItCannotRead) {
  const auto refused = [](const std::string& text, const std::string& message) {
    EXPECT_THAT([&] { (void)parse_filter_model(text, "m.toml"); },
                ThrowsMessage<InvalidInput>(StrEq(message)));
  };
  const std::string R = "[[sensors.R]]\nvariance = 5\n";
  refused(kHead + kSensor + R + "colour = 1\n",
          "m.toml:17: key 'colour' in [[R]] 1 is not known, expected one of entries, kind, "
          "parameter, unit, variance, interval, covariance, prior_median, prior_deviation");
  refused(kHead + kSensor + R + "kind = 'ful'\n",
          "m.toml:17: kind in [[R]] 1 is 'ful', expected 'separate' or 'shared' or 'full' or "
          "'fixed'");
  refused(kHead + kSensor + R + "entries = ['z']\n",
          "m.toml:17: 'z' in entries of [[R]] 1 is unknown, expected one of x, y");
  refused(kHead + kSensor + R + "parameter = 'R'\n",
          "m.toml:17: parameter in [[R]] 1 names one parameter for 2 entries, expected kind = "
          "\"shared\", or a table for each entry");
  refused(kHead + kSensor + "[[sensors.R]]\nvariance = 0\n",
          "m.toml:16: variance in [[R]] 1 is 0, expected more than 0");
  refused(kHead + kSensor + "[[sensors.R]]\nvariance = [1, 2, 3]\n",
          "m.toml:16: variance in [[R]] 1 has 3 entries, expected 2 or one number");
  refused(kHead + kSensor,
          "m.toml: R of sensor 'camera' is not positive definite at the initial values of its "
          "parameters, "
          "expected every measurement to have some noise");
  refused(kHead, "m.toml: the model has no sensors, expected at least one");
  refused(
      "name = 'a'\nstates = ['x m]']\n",
      "m.toml:2: 'x m]' is invalid, expected a name and, in brackets, its unit, as in 'vz [m/s]'");
  refused("name = 'a'\nstates = ['x']\nA = [[1, 2]]\n",
          "m.toml:3: A is 1x2, expected 1x1 (states x states)");
  refused("name = 'a'\nA = [[1]]\n", "m.toml:1: the file has no key 'states', which is required");
  EXPECT_THAT([] { (void)load_filter_model("altitud"); },
              ThrowsMessage<InvalidInput>(StrEq(
                  "filter model: no model 'altitud', expected local-level, constant-velocity, "
                  "altitude, velocity-xy, attitude, inertial, inertial-ned, uquad or a file; did "
                  "you mean 'altitude'?")));
}

TEST(FilterFile, WritesWhatItReads) {
  std::vector<FilterModel> models;
  for (const FilterModelTitle& title : built_in_filter_models())
    models.push_back(load_filter_model(title.name));
  models.push_back(parse_filter_model(
      kHead + "[[Q]]\nvariance = [1.1, 2e-9]\nprior_median = 3\nprior_deviation = 0.5\n[[Q]]\n" +
          "kind = 'fixed'\nvariance = 0.25\n" + kSensor +
          "[[sensors.R]]\nkind = 'full'\ncovariance = [[4, 1], [1, 9]]\n[initial]\n" +
          "variance = [3, 0.1]\n",
      "m.toml"));
  for (const FilterModel& model : models) {
    const FilterModel again = parse_filter_model(text_of_filter_model(model, {"a note"}), "again");
    EXPECT_EQ(again.name, model.name);
    EXPECT_EQ(again.states, model.states);
    EXPECT_EQ(again.inputs, model.inputs);
    EXPECT_THAT(again.A, MatrixNear(model.A, 0));
    EXPECT_THAT(again.B, MatrixNear(model.B, 0));
    EXPECT_THAT(again.G, MatrixNear(model.G, 0));
    EXPECT_EQ(again.parameters, model.parameters);
    EXPECT_THAT(covariance(again.Q, start_of(again)),
                MatrixNear(covariance(model.Q, start_of(model)), 1e-14));
    EXPECT_THAT(covariance(again.sensors[0].R, start_of(again)),
                MatrixNear(covariance(model.sensors[0].R, start_of(model)), 1e-14));
    EXPECT_EQ(again.sensors[0].delay, model.sensors[0].delay);
    EXPECT_THAT(again.P0, MatrixNear(model.P0, 0));
    EXPECT_EQ(again.diffuse, model.diffuse);
  }
}

TEST(CovarianceModel, ItsBlocksAreAnyPositiveDefiniteMatrix) {
  const MatrixXd block{{4, 1, -2}, {1, 9, 0.5}, {-2, 0.5, 3}};
  const VectorXd parameters = parameters_of_block(block);
  CovarianceModel model;
  model.fixed = MatrixXd::Zero(3, 3);
  model.full = {{{0, 1, 2}, 0}};
  EXPECT_THAT(covariance(model, parameters), MatrixNear(block, 1e-14));
  EXPECT_FALSE(parameters_of_block(MatrixXd{{1, 2}, {2, 1}}).allFinite());
}

}  // namespace
}  // namespace quadtune
