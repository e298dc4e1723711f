// SPDX-License-Identifier: Apache-2.0
#include "quadtune/internal/in_parallel.hpp"

#include <gtest/gtest.h>

#include <array>
#include <atomic>
#include <numeric>
#include <stdexcept>
#include <thread>
#include <vector>

#include "quadtune/errors.hpp"

namespace quadtune::internal {
namespace {

TEST(InParallel, DoesEachPartOnce) {
  for (const std::size_t threads : {1, 2, 7, 200}) {
    std::vector<int> done(100, 0);
    const auto one = [&](std::size_t part) { ++done[part]; };
    in_parallel(done.size(), threads, [&] { return one; }, {});
    EXPECT_EQ(done, std::vector<int>(100, 1)) << threads;
  }
  in_parallel(0, 4, [] { return [](std::size_t) { FAIL(); }; }, {});
}

TEST(InParallel, ThrowsWhatTheFirstPartThrows) {
  const auto one = [](std::size_t part) {
    if (part >= 3) throw std::runtime_error(std::to_string(part));
  };
  for (const std::size_t threads : {1, 4}) {
    try {
      in_parallel(50, threads, [&] { return one; }, {});
      FAIL();
    } catch (const std::runtime_error& error) {
      EXPECT_STREQ(error.what(), "3");
    }
  }
}

TEST(InParallel, StopsWhereItIsInterrupted) {
  EXPECT_THROW(in_parallel(
                   5, 2, [] { return [](std::size_t) {}; }, [] { return true; }),
               Interrupted);
}

// Work within work would have threads times threads.
TEST(InParallel, PartsOfSharedWorkDoTheirOwnOnTheirThread) {
  std::array<std::atomic<int>, 8> done{};
  std::atomic<int> elsewhere = 0;
  const auto outer = [&](std::size_t) {
    const std::thread::id here = std::this_thread::get_id();
    const auto inner = [&](std::size_t part) {
      ++done[part];
      if (std::this_thread::get_id() != here) ++elsewhere;
    };
    in_parallel(done.size(), 4, [&] { return inner; }, {});
  };
  in_parallel(6, 3, [&] { return outer; }, {});
  EXPECT_EQ(elsewhere, 0);
  for (const auto& count : done) EXPECT_EQ(count, 6);
}

}  // namespace
}  // namespace quadtune::internal
