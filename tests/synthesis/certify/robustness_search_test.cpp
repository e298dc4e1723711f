// SPDX-License-Identifier: Apache-2.0
#include "certify/robustness_search.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <cstdint>
#include <limits>
#include <string>

namespace quadtune::internal {
namespace {

using Eigen::MatrixXd;
using Eigen::VectorXd;

/// x' = θ u, u = -x once per second: the pole is 1 - θ. The parameters p in -1 … 1, nominally 0,
/// give θ = θ₀ + |p - centre|²/20, so the largest pole is 1 - θ₀, at the centre.
LoopFamily bowl(const VectorXd& centre, double theta0) {
  LoopFamily family;
  family.loop.plant.A = MatrixXd::Zero(1, 1);
  family.loop.plant.B = MatrixXd::Zero(1, 1);
  family.loop.terms = {{"gain", {}, MatrixXd::Ones(1, 1)}};
  family.loop.law.A = MatrixXd(0, 0);
  family.loop.law.B = MatrixXd(0, 1);
  family.loop.law.C = MatrixXd(1, 0);
  family.loop.law.D = -MatrixXd::Ones(1, 1);
  family.loop.law.dt = 1;
  for (Eigen::Index i = 0; i < centre.size(); ++i)
    family.parameters.push_back({"p" + std::to_string(i), "", -1, 0, 1});
  family.at = [=](const VectorXd& p) {
    LoopPoint point;
    point.numbers = VectorXd::Constant(1, theta0 + (p - centre).squaredNorm() / 20);
    return point;
  };
  family.over = [](const VectorXd&, const VectorXd&) {
    return LoopBox{VectorXd::Constant(1, 0), VectorXd::Constant(1, 2), 0, 0};
  };
  return family;
}

// With five parameters no start is near the centre, so the search has to increase some parameters
// and to decrease others.
TEST(RobustnessSearch, ClimbsToAMaximumInsideTheBox) {
  VectorXd centre(5);
  centre << 0.31, -0.42, -0.17, 0.23, -0.05;
  const LoopFamily family = bowl(centre, 0.5);
  for (const std::uint64_t seed : {1, 2, 3}) {
    const WorstCase worst = RobustnessSearch(family, seed, 1, {}).worst();
    ASSERT_EQ(worst.parameters.size(), 5);
    EXPECT_LT((worst.parameters - centre).cwiseAbs().maxCoeff(), 2e-3) << seed;
    EXPECT_NEAR(worst.radius, 0.5, 1e-6);
    EXPECT_FALSE(worst.unstable());
  }
}

// Unstable in a disc around the centre. The smallest square around 0 that touches it does so with a
// side, at the point of the disc that is nearest to this side.
TEST(RobustnessSearch, FindsTheSmallestBoxWithAnUnstableLoop) {
  const double theta0 = -0.01, radius = std::sqrt(-20 * theta0);
  for (const double side : {-1.0, 1.0}) {
    const VectorXd centre = Eigen::Vector2d(0.8 * side, -0.3 * side);
    const LoopFamily family = bowl(centre, theta0);
    const RobustnessSearch::Nearest nearest = RobustnessSearch(family, 1, 2, {}).nearest();
    EXPECT_NEAR(nearest.scale, 0.8 - radius, 1e-3);
    ASSERT_EQ(nearest.found.parameters.size(), 2);
    EXPECT_NEAR(nearest.found.parameters(0), nearest.scale * side, 1e-12);
    EXPECT_NEAR(nearest.found.parameters(1), centre(1), 0.03);
    EXPECT_TRUE(nearest.found.unstable());
  }
  EXPECT_EQ(RobustnessSearch(bowl(Eigen::Vector2d(0.8, 0.3), 0.01), 1, 1, {}).nearest().scale,
            std::numeric_limits<double>::infinity());
}

}  // namespace
}  // namespace quadtune::internal
