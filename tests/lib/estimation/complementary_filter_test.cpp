// SPDX-License-Identifier: Apache-2.0
#include "quadtune/estimation/complementary_filter.hpp"

#include <gmock/gmock.h>

#include <cmath>
#include <limits>
#include <numbers>
#include <random>

#include "integrate.hpp"
#include "matrix_near.hpp"
#include "pack_functions.hpp"
#include "quadtune/errors.hpp"

namespace quadtune {
namespace {

using ::testing::HasSubstr;
using testing::lane_of;
using testing::MatrixNear;
using ::testing::StrEq;
using ::testing::ThrowsMessage;
using Settings = ComplementaryFilterSettings<double>;
using State = ComplementaryFilterState<double>;
using Eigen::Vector3d;

Vector3d force_at_rest(double roll, double pitch) {
  return -9.81 * rotation_of_euler(roll, pitch, 0.0).row(2).transpose();
}

TEST(ComplementaryFilter, ReadsTiltAndYawBack) {
  std::mt19937_64 random(1);
  std::uniform_real_distribution<double> any_angle(-3.1, 3.1);
  for (int i = 0; i < 100; ++i) {
    const double roll = any_angle(random);
    const double pitch = any_angle(random) / 2;
    const double yaw = any_angle(random);
    const Tilt<double> tilt = tilt_from_force<double>(force_at_rest(roll, pitch));
    EXPECT_NEAR(tilt.roll, roll, 1e-13);
    EXPECT_NEAR(tilt.pitch, pitch, 1e-13);
    const double declination = 0.2;
    const Vector3d world(20 * std::cos(declination), 20 * std::sin(declination), 43);
    const Vector3d field = rotation_of_euler(roll, pitch, yaw).transpose() * world;
    EXPECT_NEAR(wrap_angle(yaw_from_field(field, tilt, declination) - yaw), 0, 1e-13);
  }
}

TEST(ComplementaryFilter, TakesWholeTurnsOff) {
  for (const double angle : {-3.1, -1.0, 0.0, 0.5, 3.1})
    for (const int turns : {-3, 0, 7})
      EXPECT_NEAR(wrap_angle(angle + 2 * std::numbers::pi * turns), angle, 1e-14);
}

// A step of tilt: the error decays by τ/(τ + dt) a sample, that is e^(-t/τ) but for O(dt).
TEST(ComplementaryFilter, FindsAStaticTiltWithItsTimeConstant) {
  const Settings settings;
  State state;
  const Vector3d force = force_at_rest(0.3, -0.2);
  for (int k = 1; k <= 1000; ++k) {
    step(settings, state, Vector3d(Vector3d::Zero()), force, true);
    const double left = std::pow(1 / 1.005, k);
    ASSERT_NEAR(state.angles.x(), 0.3 * (1 - left), 1e-12);
    ASSERT_NEAR(state.angles.y(), -0.2 * (1 - left), 1e-12);
    ASSERT_EQ(state.angles.z(), 0);
  }
  EXPECT_NEAR(std::pow(1 / 1.005, 200), std::exp(-1), 1e-3);
}

TEST(ComplementaryFilter, OffsetIsTheBiasTimesTheTimeConstant) {
  for (const double tau : {0.5, 2.0}) {
    Settings settings;
    settings.time_constant = tau;
    settings.force_band = 10;  // full weight, so that the closed form is exact
    State state;
    for (int k = 0; k < 10000; ++k)
      step(settings, state, Vector3d(0.01, 0, 0), force_at_rest(0, 0), true);
    EXPECT_NEAR(state.angles.x(), 0.01 * tau, 1e-12);
    EXPECT_NEAR(state.angles.y(), 0, 1e-12);
    State pitched;
    for (int k = 0; k < 10000; ++k)
      step(settings, pitched, Vector3d(0, -0.02, 0), force_at_rest(0, 0), true);
    EXPECT_NEAR(pitched.angles.y(), -0.02 * tau, 1e-12);
  }
}

TEST(ComplementaryFilter, FindsTheBiasWhereAskedTo) {
  Settings settings;
  settings.bias_time_constant = 5;
  State state;
  const Vector3d bias(0.01, -0.02, 0);
  for (int k = 0; k < 20000; ++k) step(settings, state, bias, force_at_rest(0.1, 0.2), true);
  EXPECT_THAT(state.angles, MatrixNear(Vector3d(0.1, 0.2, state.angles.z()), 1e-9));
  // Of the bias, what turns about the vertical is not seen.
  const Vector3d down = rotation_of_euler(0.1, 0.2, 0.0).row(2).transpose();
  const Vector3d missed = state.gyro_bias - bias;
  EXPECT_THAT(missed - down * down.dot(missed), MatrixNear(Vector3d(Vector3d::Zero()), 1e-9));
}

// One correction goes into the bias along the axes about which the body would have to turn.
TEST(ComplementaryFilter, MovesTheBiasAlongTheBodysAxes) {
  Settings settings;
  settings.bias_time_constant = 5;
  State state;
  state.angles = {0.5, 0.3, 1};
  step(settings, state, Vector3d(Vector3d::Zero()), force_at_rest(0.6, 0.2), true);
  const double alpha = 0.005 / 1.005;
  const Vector3d error(0.1, -0.1, 0);
  const Matrix3<double> to_body =
      body_rate_matrix(0.5 + alpha * error.x(), 0.3 + alpha * error.y());
  EXPECT_THAT(state.gyro_bias, MatrixNear(Vector3d(-alpha / 5 * to_body * error), 1e-15));
}

TEST(ComplementaryFilter, BoundsTheRatesNearTheVertical) {
  for (const double pitch : {0.0, 0.7, -1.2})
    EXPECT_THAT(bounded_euler_rates(0.4, pitch, Vector3d(1, 2, 3)),
                MatrixNear(Vector3d(euler_rate_matrix(0.4, pitch) * Vector3d(1, 2, 3)), 1e-14));
  const double right_angle = std::numbers::pi / 2;
  EXPECT_NEAR(bounded_euler_rates(0.0, right_angle - 0.01, Vector3d(0, 0, 1)).z(), 20, 1e-12);
  EXPECT_NEAR(bounded_euler_rates(0.0, right_angle + 0.01, Vector3d(0, 0, 1)).z(), -20, 1e-12);
}

// Turning on the spot, level and tilted: roll and pitch stay, the yaw counts the turns.
TEST(ComplementaryFilter, ComesBackFromTurnsOfYaw) {
  for (const double tilt : {0.0, 0.4}) {
    Settings settings;
    State state;
    state.angles = {tilt, -tilt / 2, 0};
    const double yaw_rate = 2 * std::numbers::pi / 4;
    const Vector3d rates = body_rate_matrix(tilt, -tilt / 2) * Vector3d(0, 0, yaw_rate);
    state.gyro = rates;
    for (int k = 0; k < 3 * 800; ++k)
      step(settings, state, rates, force_at_rest(tilt, -tilt / 2), true);
    EXPECT_THAT(state.angles, MatrixNear(Vector3d(tilt, -tilt / 2, 6 * std::numbers::pi), 1e-9));
  }
}

// Angles of a motion about all axes, from its sampled rates alone; halving dt quarters the error.
TEST(ComplementaryFilter, IntegratesToSecondOrder) {
  const auto rates = [](double t) {
    return Vector3d(std::sin(3 * t), 0.8 * std::cos(2 * t), 0.5 * std::sin(t) + 0.2);
  };
  using Vector4 = Eigen::Vector4d;
  const Vector4 truth = testing::integrate(
      [&](const Vector4& x) {
        Vector4 d;
        d << euler_rate_matrix(x(0), x(1)) * rates(x(3)), 1;
        return d;
      },
      Vector4(Vector4::Zero()), 1e-3, 5000);
  double errors[2];
  for (int halved = 0; halved < 2; ++halved) {
    Settings settings;
    settings.dt = halved ? 0.005 : 0.01;
    State state;
    state.gyro = rates(0);
    const int steps = halved ? 1000 : 500;
    for (int k = 1; k <= steps; ++k)
      step(settings, state, rates(k * settings.dt), Vector3d(Vector3d::Zero()), false);
    errors[halved] = (state.angles - truth.head<3>()).norm();
  }
  EXPECT_LT(errors[0], 1e-3);
  EXPECT_NEAR(errors[0] / errors[1], 4, 0.2);
}

TEST(ComplementaryFilter, BelievesTheForceByItsLength) {
  const Settings settings;
  const auto corrected = [&](double share, bool fresh) {
    State state;
    step(settings, state, Vector3d(Vector3d::Zero()), Vector3d(share * force_at_rest(0.1, 0)),
         fresh);
    return state.angles.x() * 1.005 / 0.005 / 0.1;  // the weight
  };
  EXPECT_NEAR(corrected(1, true), 1, 1e-12);
  EXPECT_NEAR(corrected(1.1, true), 0.6, 1e-12);
  EXPECT_NEAR(corrected(0.9, true), 0.6, 1e-12);
  EXPECT_EQ(corrected(1.3, true), 0);
  EXPECT_EQ(corrected(0, true), 0);
  EXPECT_EQ(corrected(1, false), 0);
  // Of a fall the direction is noise, and no band makes it believable.
  Settings credulous;
  credulous.force_band = std::numeric_limits<double>::infinity();
  State falling;
  step(credulous, falling, Vector3d(Vector3d::Zero()), Vector3d(0.1, 0.2, 0.3), true);
  EXPECT_EQ(falling.angles, Vector3d::Zero());
  Settings gyro_only;
  gyro_only.time_constant = std::numeric_limits<double>::infinity();
  State state;
  step(gyro_only, state, Vector3d(Vector3d::Zero()), force_at_rest(0.1, 0.1), true);
  EXPECT_EQ(state.angles, Vector3d::Zero());
}

TEST(ComplementaryFilter, StaysFiniteWhenTumbling) {
  const Settings settings;
  State state;
  for (int k = 0; k < 4000; ++k) {
    step(settings, state, Vector3d(3, 8, 1), Vector3d(0, 0, 0), true);
    ASSERT_TRUE(state.angles.allFinite());
  }
  for (int k = 0; k < 8000; ++k)
    step(settings, state, Vector3d(Vector3d::Zero()), force_at_rest(0.1, 0.2), true);
  EXPECT_NEAR(state.angles.x(), 0.1, 1e-9);
  EXPECT_NEAR(state.angles.y(), 0.2, 1e-9);
}

TEST(ComplementaryFilter, LanesDoNotDependOnEachOtherAndFloatFollows) {
  std::mt19937_64 random(5);
  std::normal_distribution<double> normal(0, 0.5);
  ComplementaryFilterSettings<Pack<4>> packed;
  packed.bias_time_constant = 10;
  ComplementaryFilterSettings<Pack<1>> one;
  one.bias_time_constant = 10;
  ComplementaryFilterSettings<float> single;
  single.bias_time_constant = 10;
  ComplementaryFilterState<Pack<4>> together;
  std::array<ComplementaryFilterState<Pack<1>>, 4> alone;
  ComplementaryFilterState<float> rough;
  for (int k = 0; k < 500; ++k) {
    Vector3<Pack<4>> gyro;
    Vector3<Pack<4>> force;
    for (int i = 0; i < 3; ++i)
      for (int l = 0; l < 4; ++l) {
        set_lane(gyro(i), l, normal(random));
        set_lane(force(i), l, normal(random) - (i == 2 ? 9.81 : 0));
      }
    Mask<4> fresh;
    for (int l = 0; l < 4; ++l) set_lane(fresh, l, (k + l) % 3 != 0);
    step(packed, together, gyro, force, fresh);
    for (int l = 0; l < 4; ++l) {
      step(one, alone[l], Vector3<Pack<1>>(lane_of(gyro, l).cast<Pack<1>>()),
           Vector3<Pack<1>>(lane_of(force, l).cast<Pack<1>>()), Mask<1>(lane(fresh, l)));
      ASSERT_EQ(lane_of(together.angles, l), lane_of(alone[l].angles, 0));
      ASSERT_EQ(lane_of(together.gyro_bias, l), lane_of(alone[l].gyro_bias, 0));
    }
    step(single, rough, Vector3<float>(lane_of(gyro, 0).cast<float>()),
         Vector3<float>(lane_of(force, 0).cast<float>()), lane(fresh, 0));
  }
  EXPECT_THAT(rough.angles.cast<double>(), MatrixNear(lane_of(together.angles, 0), 1e-5));
}

TEST(ComplementaryFilter, RefusesWhatCannotRun) {
  EXPECT_NO_THROW(validate(Settings(), "attitude"));
  EXPECT_NO_THROW(validate(ComplementaryFilterSettings<float>(), "attitude"));
  const auto refused = [](auto change, const std::string& message) {
    Settings settings;
    change(settings);
    EXPECT_THAT([&] { validate(settings, "attitude"); },
                ThrowsMessage<InvalidInput>(StrEq("attitude: " + message)));
  };
  refused([](Settings& s) { s.dt = 0; }, "dt is 0 s, expected a positive number");
  refused([](Settings& s) { s.gravity = -1; }, "gravity is -1 m/s2, expected a positive number");
  refused([](Settings& s) { s.time_constant = std::nan(""); },
          "time_constant is nan s, expected 0 or more");
  refused([](Settings& s) { s.force_band = 0; },
          "force_band is 0, expected more than 0 because it divides");
  refused([](Settings& s) { s.bias_time_constant = 3; },
          "bias_time_constant is 3 s, expected at least 4 times the time constant of 1 s because "
          "the estimates of bias and attitude otherwise oscillate");
}

}  // namespace
}  // namespace quadtune
