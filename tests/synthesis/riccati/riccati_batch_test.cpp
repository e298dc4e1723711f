// SPDX-License-Identifier: Apache-2.0
#include "quadtune/synthesis/riccati_batch.hpp"

#include <gmock/gmock.h>

#include <Eigen/Eigenvalues>

#include "matrix_near.hpp"
#include "plants/riccati_problems.hpp"
#include "quadtune/errors.hpp"

namespace quadtune {
namespace {

using Eigen::MatrixXd;
using ::testing::HasSubstr;
using testing::MatrixRelativelyNear;
using testing::RiccatiCase;
using ::testing::ThrowsMessage;

RiccatiMatrices as_matrices(const RiccatiCase& c) { return {c.A, c.B, c.Q, c.R, c.N}; }

/// Eight similar problems: a random problem, changed by a few per cent in each lane.
std::vector<RiccatiCase> neighbours(Eigen::Index nx, Eigen::Index nu, bool discrete, bool cross,
                                    std::mt19937_64& random) {
  const RiccatiCase base = testing::random_case(nx, nu, discrete, cross, random);
  std::vector<RiccatiCase> all(RiccatiBatch::kLanes, base);
  for (RiccatiCase& c : all) {
    c.A += 0.03 * testing::random_matrix(nx, nx, random).cwiseProduct(base.A);
    c.B += 0.03 * testing::random_matrix(nx, nu, random).cwiseProduct(base.B);
  }
  return all;
}

std::vector<RiccatiMatrices> as_matrices(const std::vector<RiccatiCase>& cases) {
  std::vector<RiccatiMatrices> all;
  all.reserve(cases.size());
  for (const RiccatiCase& c : cases) all.push_back(as_matrices(c));
  return all;
}

void expect_stable(const RiccatiCase& c, const MatrixXd& K, bool discrete) {
  const Eigen::VectorXcd poles = Eigen::EigenSolver<MatrixXd>(c.A - c.B * K).eigenvalues();
  if (discrete)
    EXPECT_LT(poles.cwiseAbs().maxCoeff(), 1);
  else
    EXPECT_LT(poles.real().maxCoeff(), 0);
}

TEST(RiccatiBatch, AgreesWithRiccatiSolver) {
  std::mt19937_64 random(7);
  for (const Eigen::Index nx : {1, 2, 5, 8, 12, 13, 16, 30, 40})
    for (const bool discrete : {false, true})
      for (const bool cross : {false, true}) {
        const Eigen::Index nu = (nx + 2) / 3;
        const std::vector<RiccatiCase> cases = neighbours(nx, nu, discrete, cross, random);
        const std::vector<RiccatiMatrices> problems = as_matrices(cases);
        RiccatiBatch batch(nx, nu);
        const auto results = discrete ? batch.dare(problems) : batch.care(problems);
        ASSERT_EQ(results.size(), RiccatiBatch::kLanes);
        for (std::size_t lane = 0; lane < cases.size(); ++lane) {
          const RiccatiCase& c = cases[lane];
          const RiccatiResult one =
              discrete ? dare(c.A, c.B, c.Q, c.R, c.N) : care(c.A, c.B, c.Q, c.R, c.N);
          const std::string where = "nx " + std::to_string(nx) + (discrete ? " discrete" : "") +
                                    (cross ? " cross" : "") + " lane " + std::to_string(lane);
          ASSERT_TRUE(one.solved()) << where << one;
          ASSERT_TRUE(results[lane].solved()) << where << results[lane];
          EXPECT_THAT(results[lane].X, MatrixRelativelyNear(one.X, 1e-9)) << where;
          EXPECT_THAT(results[lane].K, MatrixRelativelyNear(one.K, 1e-9)) << where;
          EXPECT_LT(testing::riccati_residual(c, results[lane].X, discrete), 2e-12) << where;
          EXPECT_LE(results[lane].residual, 1e-12) << where;
          expect_stable(c, results[lane].K, discrete);
        }
        // The lanes must have solved it, not the fallback.
        if (nx <= 16) {
          EXPECT_EQ(batch.fallbacks(), 0u) << nx;
        }
        if (nx > 32) {
          EXPECT_EQ(batch.fallbacks(), RiccatiBatch::kLanes);
        }
      }
}

// Entries 1/J = 2e4 and g = 10: inaccurate without scaling.
TEST(RiccatiBatch, SolvesASmallHoverInSiUnits) {
  for (const bool discrete : {false, true}) {
    const RiccatiCase c = discrete ? testing::small_hover_sampled(0.005) : testing::small_hover();
    std::vector<RiccatiMatrices> problems(RiccatiBatch::kLanes, as_matrices(c));
    for (std::size_t lane = 0; lane < problems.size(); ++lane)
      problems[lane].B *= 1 + 0.02 * static_cast<double>(lane);
    RiccatiBatch batch(12, 4);
    const auto results = discrete ? batch.dare(problems) : batch.care(problems);
    for (std::size_t lane = 0; lane < problems.size(); ++lane) {
      const RiccatiMatrices& p = problems[lane];
      const RiccatiResult one = discrete ? dare(p.A, p.B, p.Q, p.R) : care(p.A, p.B, p.Q, p.R);
      ASSERT_TRUE(results[lane].solved()) << results[lane];
      EXPECT_THAT(results[lane].K, MatrixRelativelyNear(one.K, 1e-9));
      EXPECT_LT(results[lane].residual, 1e-13);
    }
    EXPECT_EQ(batch.fallbacks(), 0u);
  }
}

TEST(RiccatiBatch, AcceptsFewerProblemsThanLanes) {
  std::mt19937_64 random(8);
  const std::vector<RiccatiMatrices> problems = as_matrices(neighbours(6, 2, false, false, random));
  RiccatiBatch batch(6, 2);
  std::vector<MatrixXd> all;
  all.reserve(problems.size());
  for (const RiccatiResult& result : batch.care(problems)) all.push_back(result.K);
  for (std::size_t count = 1; count <= problems.size(); ++count) {
    const auto results = batch.care(std::span(problems).first(count));
    for (std::size_t lane = 0; lane < count; ++lane)
      EXPECT_THAT(results[lane].K, MatrixRelativelyNear(all[lane], 1e-12));
  }
}

// The result of a lane does not depend on the other lanes, bit by bit, as long as the first lane,
// which determines the scales, is the same.
TEST(RiccatiBatch, LanesDoNotMix) {
  std::mt19937_64 random(9);
  std::vector<RiccatiMatrices> problems = as_matrices(neighbours(5, 2, true, false, random));
  RiccatiBatch batch(5, 2);
  const MatrixXd third = batch.dare(problems)[2].K;
  std::swap(problems[2], problems[6]);
  const MatrixXd moved = batch.dare(problems)[6].K;
  EXPECT_EQ(third, moved);
}

TEST(RiccatiBatch, NamesTheCulpritOfALane) {
  std::mt19937_64 random(10);
  std::vector<RiccatiCase> cases = neighbours(4, 2, false, false, random);
  cases[3].A.row(3).setZero();
  cases[3].A(3, 3) = 1;
  cases[3].B.row(3).setZero();
  const std::vector<RiccatiMatrices> problems = as_matrices(cases);
  RiccatiBatch batch(4, 2);
  const auto results = batch.care(problems);
  for (std::size_t lane = 0; lane < cases.size(); ++lane) {
    if (lane != 3) {
      ASSERT_TRUE(results[lane].solved()) << results[lane];
      EXPECT_LT(testing::riccati_residual(cases[lane], results[lane].X, false), 1e-12);
      continue;
    }
    EXPECT_EQ(results[lane].status, RiccatiStatus::not_stabilizable);
    EXPECT_THAT(results[lane].culprit, HasSubstr("cannot be controlled"));
    EXPECT_TRUE(results[lane].K.array().isNaN().all());
  }
}

TEST(RiccatiBatch, RejectsInvalidInput) {
  std::mt19937_64 random(11);
  std::vector<RiccatiMatrices> problems = as_matrices(neighbours(3, 1, false, false, random));
  RiccatiBatch batch(3, 1);
  EXPECT_THAT([&] { batch.care({}); },
              ThrowsMessage<InvalidInput>(HasSubstr("0 problems are given, expected 1 to 8")));
  problems[1].R(0, 0) = -1;
  EXPECT_THAT([&] { batch.care(problems); },
              ThrowsMessage<InvalidInput>(HasSubstr("R has eigenvalue -1")));
  problems[1] = problems[0];
  problems[5].A(0, 0) = std::nan("");
  EXPECT_THAT([&] { batch.care(problems); }, ThrowsMessage<InvalidInput>(HasSubstr("A")));
  problems[5] = {MatrixXd::Zero(2, 2), MatrixXd::Zero(2, 1), MatrixXd::Identity(2, 2),
                 MatrixXd::Identity(1, 1), MatrixXd()};
  EXPECT_THAT([&] { batch.care(problems); }, ThrowsMessage<InvalidInput>(HasSubstr("A is 2x2")));
}

}  // namespace
}  // namespace quadtune
