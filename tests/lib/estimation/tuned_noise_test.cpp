// SPDX-License-Identifier: Apache-2.0
#include "quadtune/estimation/tuned_noise.hpp"

#include <gmock/gmock.h>

#include "matrix_near.hpp"
#include "quadtune/errors.hpp"
#include "quadtune/estimation/filter_file.hpp"

namespace quadtune {
namespace {

using ::testing::HasSubstr;
using testing::MatrixNear;
using ::testing::ThrowsMessage;
using Matrix = Eigen::MatrixXd;

/// The Mambo's altitude filter: its measurement is z itself, not the height.
DiscreteLti altitude_on_board(double dt = 0.005) {
  DiscreteLti filter;
  filter.dt = dt;
  filter.states = {{"z", "m"}, {"vz", "m/s"}};
  filter.A = (Matrix(2, 2) << 1, dt, 0, 1).finished();
  filter.B = (Matrix(2, 1) << 0, dt).finished();
  filter.C = (Matrix(1, 2) << 1, 0).finished();
  return filter;
}
const Matrix kNoiseInput = (Matrix(2, 1) << 0, 1).finished();

// Oliveira 2020, table 3.1: 0.0005 m²/s² each 5 ms, 0.1 m²; the built-in model starts with these.
TEST(TunedNoise, OfTheAltitudeIsThatOfTheTable) {
  const NoisePerStep noise =
      noise_per_step(load_filter_model("altitude"), altitude_on_board(), kNoiseInput, "test");
  EXPECT_THAT(noise.Q, MatrixNear(Matrix::Constant(1, 1, 0.0005), 1e-15));
  EXPECT_THAT(noise.R, MatrixNear(Matrix::Constant(1, 1, 0.1), 1e-15));
}

// Table 3.2: 0.09 and 5 m²/s² for both axes.
TEST(TunedNoise, OfTheVelocityIsThatOfTheTable) {
  DiscreteLti filter;
  filter.dt = 0.005;
  filter.states = {{"vx", "m/s"}, {"vy", "m/s"}};
  filter.A = filter.C = Matrix::Identity(2, 2);
  filter.B = 0.005 * Matrix::Identity(2, 2);
  const NoisePerStep noise =
      noise_per_step(load_filter_model("velocity-xy"), filter, Matrix::Identity(2, 2), "test");
  EXPECT_THAT(noise.Q, MatrixNear(0.09 * Matrix::Identity(2, 2), 1e-15));
  EXPECT_THAT(noise.R, MatrixNear(5 * Matrix::Identity(2, 2), 1e-15));
}

TEST(TunedNoise, GrowsWithThePeriod) {
  const FilterModel model = load_filter_model("altitude");
  EXPECT_THAT(noise_per_step(model, altitude_on_board(0.01), kNoiseInput, "test").Q,
              MatrixNear(Matrix::Constant(1, 1, 0.001), 1e-15));
}

TEST(TunedNoise, RefusesAnotherFilter) {
  const FilterModel model = load_filter_model("altitude");
  const auto refusal = [&](const DiscreteLti& filter, const Matrix& G, const std::string& why) {
    EXPECT_THAT(
        [&] { (void)noise_per_step(model, filter, G, "d.toml:3"); },
        ThrowsMessage<InvalidInput>(HasSubstr("d.toml:3: the tuned model 'altitude' " + why)));
  };
  DiscreteLti filter = altitude_on_board();
  filter.states[1].name = "w";
  refusal(filter, kNoiseInput, "has the states z vz, expected z w as in the filter");
  refusal(altitude_on_board(), Matrix::Identity(2, 2), "has noise on other states");
  filter = altitude_on_board();
  filter.C << 0, 1;
  refusal(filter, kNoiseInput, "measures 'height' differently from the filter");
  filter.C = Matrix::Identity(2, 2);
  refusal(filter, kNoiseInput, "has 1 measurements, expected 2");
}

// What a tuning said of itself comes back with the file.
TEST(TunedNoise, AFileKeepsItsVerdict) {
  FilterModel model = load_filter_model("altitude");
  EXPECT_EQ(model.verdict, "");
  model.verdict = "fail";
  const std::string text = text_of_filter_model(model);
  EXPECT_THAT(text, HasSubstr("verdict = \"fail\"\n"));
  EXPECT_EQ(parse_filter_model(text, "test").verdict, "fail");
}

}  // namespace
}  // namespace quadtune
