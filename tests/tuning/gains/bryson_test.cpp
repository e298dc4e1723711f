// SPDX-License-Identifier: Apache-2.0
#include "quadtune/tuning/bryson.hpp"

#include <limits>

#include "matrix_near.hpp"
#include "quadtune/errors.hpp"

namespace quadtune {
namespace {

using ::testing::HasSubstr;
using testing::MatrixNear;
using ::testing::ThrowsMessage;

TEST(BrysonWeights, MakeALimitCostOne) {
  const Eigen::Vector3d x_max(0.2, 0.1, std::numeric_limits<double>::infinity());
  const Eigen::Vector2d u_max(4, 0.5);
  const LqrWeights weights = bryson_weights(x_max, u_max);
  EXPECT_THAT(weights.Q, MatrixNear(Eigen::Vector3d(25, 100, 0).asDiagonal(), 1e-12));
  EXPECT_THAT(weights.R, MatrixNear(Eigen::Vector2d(0.0625, 4).asDiagonal(), 1e-15));
}

// The cost of reaching both limits at once is the number of limits, whatever the units.
TEST(BrysonWeights, DoNotDependOnUnits) {
  const Eigen::Vector2d metres(0.3, 0.02);
  const Eigen::Vector2d millimetres = 1000 * metres;
  const Eigen::VectorXd u_max = Eigen::VectorXd::Ones(1);
  const double in_metres = metres.dot(bryson_weights(metres, u_max).Q * metres);
  const double in_mm = millimetres.dot(bryson_weights(millimetres, u_max).Q * millimetres);
  EXPECT_NEAR(in_metres, 2, 1e-14);
  EXPECT_NEAR(in_mm, 2, 1e-14);
}

TEST(BrysonWeights, RefuseLimitsThatAreNotPositive) {
  const Eigen::VectorXd one = Eigen::VectorXd::Ones(1);
  EXPECT_THAT([&] { (void)bryson_weights(Eigen::Vector2d(1, 0), one); },
              ThrowsMessage<InvalidInput>(HasSubstr("x_max[2] is 0, expected a positive limit")));
  EXPECT_THAT(
      [&] { (void)bryson_weights(one, std::numeric_limits<double>::infinity() * one); },
      ThrowsMessage<InvalidInput>(HasSubstr("u_max[1] is inf, expected a positive finite limit")));
}

}  // namespace
}  // namespace quadtune
