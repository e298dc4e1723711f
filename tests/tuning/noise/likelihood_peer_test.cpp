// SPDX-License-Identifier: Apache-2.0
// Likelihoods compared with those of statsmodels and R, by the programs that the benchmark also
// runs.
#include <gtest/gtest.h>

#include <cmath>
#include <cstdlib>
#include <random>

#include "kalman_peers.hpp"
#include "plants/filter_models.hpp"
#include "quadtune/estimation/filter_file.hpp"
#include "quadtune/tuning/innovation_likelihood.hpp"

namespace quadtune {
namespace {

using bench::KalmanPeer;
using bench::KalmanProblem;
using bench::PeerTask;

/// A random walk of a level, similar to that of the Nile, over a thousand years.
KalmanProblem wandering_level() {
  std::mt19937_64 random(31);
  FilterModel model = testing::local_level();
  model.parameters[0].start = 1469;
  model.parameters[1].start = 15099;
  model.diffuse = {false};
  model.x0(0) = 1100;
  model.P0(0, 0) = 1e5;
  FilterRecord record = testing::simulated(model, start_of(model), 1000, 1, random);
  return {model, record};
}

KalmanProblem altitude() {
  std::mt19937_64 random(32);
  FilterModel model = load_filter_model("altitude");
  model.diffuse = {false, false};
  model.P0 = Eigen::Matrix2d::Identity();
  FilterRecord record = testing::simulated(model, start_of(model), 3000, 0.005, random);
  return {model, record};
}

void expect_same(KalmanPeer peer, const char* version, const char* name) {
  if (std::system((std::string(version) + " > /dev/null 2>&1").c_str()) != 0)
    GTEST_SKIP() << name << " is not installed";
  for (KalmanProblem problem : {wandering_level(), altitude()})
    for (const double factor : {1.0, 30.0, 0.01}) {
      problem.model.parameters[0].start *= factor;
      const Likelihood ours =
          InnovationLikelihood(problem.model, {problem.record}).evaluate(start_of(problem.model));
      ASSERT_TRUE(ours.computed());
      const auto theirs = bench::ask_peer(peer, PeerTask::every_step, problem);
      ASSERT_TRUE(theirs) << name << " failed";
      EXPECT_NEAR(ours.value, theirs->value, 1e-9 * std::abs(theirs->value))
          << problem.model.name << " " << factor;
    }
}

TEST(LikelihoodPeer, IsThatOfStatsmodels) {
  expect_same(KalmanPeer::statsmodels, "/usr/bin/python3 -c 'import statsmodels'", "statsmodels");
}

TEST(LikelihoodPeer, IsThatOfR) { expect_same(KalmanPeer::r, "Rscript --version", "R"); }

}  // namespace
}  // namespace quadtune
