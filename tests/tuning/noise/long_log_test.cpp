// SPDX-License-Identifier: Apache-2.0
// The memory that a fit requires does not grow with the log.
#include <gtest/gtest.h>
#include <sys/resource.h>

#include <cstdlib>
#include <random>

#include "data_memory.hpp"
#include "plants/filter_models.hpp"
#include "quadtune/tuning/noise_tuning.hpp"
#include "sanitized.hpp"

namespace quadtune {
namespace {

// bytes, in addition to the memory at the start of the program
constexpr rlim_t kAllowed = 48 << 20;
/// The measurements alone have that size.
constexpr int kSamples = 6'000'000;

/// Variances of the steps of the level and of the measurements, for which the log-likelihood is
/// almost zero, but the rounding error of its sum is not.
constexpr double kStep = 5.294e-4, kNoise = 5.294e-2;

FilterRecord long_level() {
  std::mt19937_64 random(3);
  std::normal_distribution<double> normal;
  FilterRecord record;
  record.name = "long";
  record.time.resize(kSamples);
  record.y.resize(1, kSamples);
  record.u.resize(0, kSamples);
  double level = 0;
  for (int k = 0; k < kSamples; ++k) {
    record.time[static_cast<std::size_t>(k)] = k;
    record.y(0, k) = level + std::sqrt(kNoise) * normal(random);
    level += std::sqrt(kStep) * normal(random);
  }
  return record;
}

/// 0: the fit has converged to the right result.
int tune_long_log() {
  const rlim_t max = static_cast<rlim_t>(testing::data_memory()) + kAllowed;
  const rlimit limit{max, max};
  if (setrlimit(RLIMIT_DATA, &limit) != 0) return 2;
  FilterModel model = testing::local_level();
  model.parameters[0].start = 30 * kStep;
  model.parameters[1].start = 0.03 * kNoise;
  try {
    NoiseTuningOptions options;
    options.fit.starts = 1;
    const NoiseTuning tuning = tune_noise(model, {long_level()}, options);
    for (const FittedParameter& p : tuning.fit.parameters)
      if (!(std::abs(p.value / (p.name == "R.y" ? kNoise : kStep) - 1) < 0.02)) return 3;
    return tuning.fit.converged() && tuning.after.outputs.front().samples > kSamples / 2 ? 0 : 4;
  } catch (const std::bad_alloc&) {
    return 5;
  }
}

TEST(LongLog, IsFittedInMemoryThatDoesNotGrow) {
  if (testing::kSanitized) GTEST_SKIP() << "sanitizers take memory of their own";
  EXPECT_EXIT(std::exit(tune_long_log()), ::testing::ExitedWithCode(0), "");
}

TEST(LongLog, WouldNotFitIntoTheHeap) {
  if (testing::kSanitized) GTEST_SKIP() << "sanitizers take memory of their own";
  EXPECT_EXIT(
      {
        setenv("TMPDIR", "/nowhere/at/all", 1);
        std::exit(tune_long_log());
      },
      ::testing::ExitedWithCode(5), "");
}

}  // namespace
}  // namespace quadtune
