// SPDX-License-Identifier: Apache-2.0
#include <atomic>
#include <cstdlib>
#include <new>

#include "matrix_near.hpp"
#include "plants/riccati_problems.hpp"
#include "quadtune/errors.hpp"
#include "quadtune/synthesis/riccati.hpp"
#include "quadtune/synthesis/riccati_batch.hpp"

// Eigen allocates by malloc, the standard library by operator new; with glibc both are counted
// here.
extern "C" void* __libc_malloc(std::size_t size);
namespace {
std::atomic<long> allocations{0};
}  // namespace
#if !defined(__SANITIZE_ADDRESS__) && !defined(__SANITIZE_THREAD__) && defined(__GLIBC__)
#define QUADTUNE_COUNTS_ALLOCATIONS
extern "C" void* malloc(std::size_t size) {
  ++allocations;
  return __libc_malloc(size);
}
#endif

namespace quadtune {
namespace {

using Eigen::MatrixXd;
using ::testing::HasSubstr;
using testing::MatrixRelativelyNear;
using testing::RiccatiCase;
using ::testing::ThrowsMessage;

RiccatiOptions essential() {
  RiccatiOptions options;
  options.evidence = RiccatiEvidence::essential;
  return options;
}

TEST(RiccatiSolver, SolvesAgainAndAgainWithoutAllocating) {
#ifndef QUADTUNE_COUNTS_ALLOCATIONS
  GTEST_SKIP() << "malloc cannot be counted in this build";
#endif
  std::mt19937_64 random(1);
  for (const Eigen::Index n : {3, 12, 16, 24, 40, 100}) {
    const Eigen::Index m = (n + 2) / 3;
    const RiccatiCase c = testing::random_case(n, m, false, false, random);
    const RiccatiCase cross = testing::random_case(n, m, false, true, random);
    const RiccatiCase d = testing::random_case(n, m, true, false, random);
    RiccatiSolver solver(n, m, essential());
    ASSERT_TRUE(solver.care(c.A, c.B, c.Q, c.R).solved());
    const long before = allocations;
    for (int k = 0; k < 3; ++k) {
      EXPECT_TRUE(solver.care(c.A, c.B, c.Q, c.R).solved());
      EXPECT_TRUE(solver.care(cross.A, cross.B, cross.Q, cross.R, cross.N).solved());
      EXPECT_TRUE(solver.dare(d.A, d.B, d.Q, d.R).solved());
    }
    EXPECT_EQ(allocations - before, 0) << "n = " << n;
  }
}

TEST(RiccatiBatch, SolvesAgainAndAgainWithoutAllocating) {
#ifndef QUADTUNE_COUNTS_ALLOCATIONS
  GTEST_SKIP() << "malloc cannot be counted in this build";
#endif
  std::mt19937_64 random(1);
  const RiccatiCase c = testing::random_case(12, 4, false, false, random);
  const RiccatiCase cross = testing::random_case(12, 4, true, true, random);
  const std::vector<RiccatiMatrices> problems(RiccatiBatch::kLanes, {c.A, c.B, c.Q, c.R, {}});
  const std::vector<RiccatiMatrices> discrete(RiccatiBatch::kLanes,
                                              {cross.A, cross.B, cross.Q, cross.R, cross.N});
  RiccatiBatch batch(12, 4);
  (void)batch.care(problems);
  const long before = allocations;
  for (int k = 0; k < 3; ++k) {
    EXPECT_TRUE(batch.care(problems)[7].solved());
    EXPECT_TRUE(batch.dare(discrete)[7].solved());
  }
  EXPECT_EQ(allocations - before, 0);
  EXPECT_EQ(batch.fallbacks(), 0u);
}

// A hover has four decoupled groups; the memory for them is reused as well.
TEST(RiccatiSolver, ReusesTheMemoryOfGroups) {
#ifndef QUADTUNE_COUNTS_ALLOCATIONS
  GTEST_SKIP() << "malloc cannot be counted in this build";
#endif
  const RiccatiCase c = testing::small_hover();
  RiccatiSolver solver(12, 4, essential());
  ASSERT_TRUE(solver.care(c.A, c.B, c.Q, c.R).solved());
  const long before = allocations;
  EXPECT_TRUE(solver.care(c.A, c.B, c.Q, c.R).solved());
  EXPECT_EQ(allocations - before, 0);
}

TEST(RiccatiSolver, IsTheSameAsTheFunctions) {
  std::mt19937_64 random(2);
  RiccatiSolver solver(7, 2, essential());
  for (int k = 0; k < 5; ++k) {
    const RiccatiCase c = testing::random_case(7, 2, false, k % 2 == 0, random);
    const RiccatiCase d = testing::random_case(7, 2, true, k % 2 == 0, random);
    EXPECT_EQ(solver.care(c.A, c.B, c.Q, c.R, c.N).X, care(c.A, c.B, c.Q, c.R, c.N).X);
    EXPECT_EQ(solver.dare(d.A, d.B, d.Q, d.R, d.N).X, dare(d.A, d.B, d.Q, d.R, d.N).X);
  }
}

// A solve must not affect the next one.
TEST(RiccatiSolver, IsUnaffectedByAnEarlierFailure) {
  RiccatiCase c = testing::small_hover();
  RiccatiSolver solver(12, 4);
  ASSERT_TRUE(solver.care(c.A, c.B, c.Q, c.R).solved());
  RiccatiCase blind = c;
  blind.Q(5, 5) = 0;
  const RiccatiResult& failed = solver.care(blind.A, blind.B, blind.Q, blind.R);
  EXPECT_EQ(failed.status, RiccatiStatus::not_detectable);
  EXPECT_TRUE(failed.X.array().isNaN().all());
  EXPECT_EQ(failed.poles.size(), 0);
  const RiccatiResult& again = solver.care(c.A, c.B, c.Q, c.R);
  EXPECT_TRUE(again.solved());
  EXPECT_TRUE(again.culprit.empty());
  EXPECT_EQ(again.poles.size(), 12);
}

TEST(RiccatiSolver, RefusesOtherSizes) {
  EXPECT_THAT(
      [] { RiccatiSolver(0, 1); },
      ThrowsMessage<InvalidInput>("RiccatiSolver: sizes are nx = 0, nu = 1, expected both >= 1"));
  RiccatiSolver solver(3, 1);
  const RiccatiCase c = testing::small_hover();
  EXPECT_THAT([&] { solver.care(c.A, c.B, c.Q, c.R); },
              ThrowsMessage<InvalidInput>(HasSubstr("expected the sizes of this solver, A 3x3")));
}

}  // namespace
}  // namespace quadtune
