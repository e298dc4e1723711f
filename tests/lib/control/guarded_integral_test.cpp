// SPDX-License-Identifier: Apache-2.0
#include "quadtune/control/guarded_integral.hpp"

#include <gmock/gmock.h>

#include <limits>

#include "quadtune/errors.hpp"

namespace quadtune {
namespace {

using ::testing::StrEq;
using ::testing::ThrowsMessage;

// The uquad program's limits of the height: enabled within 2 m, 2.5e-3 m s a sample, 2 m s in all.
constexpr GuardedIntegralSettings<double> kHeight = {0.01, 2, 2.5e-3, 2};

TEST(GuardedIntegral, IsFrozenFarFromTheSetPoint) {
  for (const double sign : {1.0, -1.0}) {
    GuardedIntegralState<double> state = {0.5};
    EXPECT_EQ(step(kHeight, state, sign * 2.0001), 0.5);
    EXPECT_EQ(step(kHeight, state, sign * 2), 0.5 + sign * 2.5e-3);  // the threshold is still near
  }
}

TEST(GuardedIntegral, LimitsTheIncrementNotTheError) {
  for (const double sign : {1.0, -1.0}) {
    GuardedIntegralState<double> state;
    EXPECT_DOUBLE_EQ(step(kHeight, state, sign * 0.1), sign * 0.001);    // err · dt
    EXPECT_DOUBLE_EQ(step(kHeight, state, sign * 0.25), sign * 0.0035);  // just at the limit
    EXPECT_DOUBLE_EQ(step(kHeight, state, sign * 1.0), sign * (0.0035 + 2.5e-3));
  }
}

TEST(GuardedIntegral, StopsAtItsLimitOnBothSides) {
  for (const double sign : {1.0, -1.0}) {
    GuardedIntegralState<double> state;
    for (int k = 0; k < 799; ++k) step(kHeight, state, sign);
    EXPECT_LT(std::abs(state.integral), 2);
    for (int k = 0; k < 10; ++k) step(kHeight, state, sign);
    EXPECT_EQ(state.integral, sign * 2);
    EXPECT_DOUBLE_EQ(step(kHeight, state, -sign), sign * (2 - 2.5e-3));  // and comes off at once
  }
}

TEST(GuardedIntegral, CrossesZeroLikeAnyOther) {
  GuardedIntegralState<double> state = {0.001};
  EXPECT_DOUBLE_EQ(step(kHeight, state, -0.2), -0.001);
}

TEST(GuardedIntegral, IgnoresAnErrorThatIsNoNumber) {
  GuardedIntegralState<float> state = {0.25F};
  const GuardedIntegralSettings<float> settings = {0.01F, 2, 1, 2};
  EXPECT_EQ(step(settings, state, std::numeric_limits<float>::quiet_NaN()), 0.25F);
  EXPECT_EQ(step(settings, state, std::numeric_limits<float>::infinity()), 0.25F);
  static_assert(noexcept(step(settings, state, 0.0F)));
}

TEST(GuardedIntegral, RejectsInvalidLimits) {
  EXPECT_NO_THROW(validate(kHeight, "here"));
  GuardedIntegralSettings<double> settings = kHeight;
  settings.increment_limit = -1;
  EXPECT_THAT([&] { validate(settings, "here"); },
              ThrowsMessage<InvalidInput>(StrEq("here: increment_limit is -1, expected 0 or more "
                                                "because it bounds an absolute value")));
  settings = kHeight;
  settings.error_limit = std::numeric_limits<double>::quiet_NaN();
  EXPECT_THROW(validate(settings, "here"), InvalidInput);
  settings = kHeight;
  settings.dt = 0;
  EXPECT_THROW(validate(settings, "here"), InvalidInput);
  EXPECT_THROW(validate(GuardedIntegralSettings<float>{}, "here"), InvalidInput);
}

}  // namespace
}  // namespace quadtune
