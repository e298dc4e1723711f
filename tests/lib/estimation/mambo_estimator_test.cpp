// SPDX-License-Identifier: Apache-2.0
#include "quadtune/estimation/mambo_estimator.hpp"

#include <gmock/gmock.h>

#include <array>
#include <cmath>
#include <limits>
#include <numbers>
#include <random>
#include <utility>

#include "matrix_near.hpp"
#include "numbers.hpp"
#include "pack_functions.hpp"
#include "quadtune/errors.hpp"

namespace quadtune {
namespace {

using Eigen::Vector2d;
using Eigen::Vector3d;
using testing::lane_of;
using testing::MatrixNear;
using ::testing::StrEq;
using ::testing::ThrowsMessage;
using MamboSettings = MamboEstimatorSettings<double>;
using MamboState = MamboEstimatorState<double>;
using Frame = SensorFrame<double>;
using Vector12 = StateVector<double>;
using testing::kNaN;
constexpr double kGravity = 9.81;
constexpr double kA = 0.6;  // half fields of view, as tangents
constexpr double kB = 0.4;

/// What perfect sensors say in the state x with the acceleration a of the world; all are fresh.
Frame perfect_frame(const Vector12& x, const Vector3d& a = Vector3d::Zero()) {
  const Eigen::Matrix3d R = rotation_of_euler(x(3), x(4), x(5));
  const Vector3d v = x.segment<3>(kVelocity);
  const Vector3d w = x.tail<3>();
  const double depth = -x(2) / R(2, 2);
  Frame frame;
  frame.specific_force = {R.transpose() * (a - Vector3d(0, 0, kGravity)), true, 0};
  frame.rates = {w, true, 0};
  frame.sonar = {depth, true, 0};
  // Mean of the pinhole's motion field over the image.
  frame.flow = {Vector2d(-v.x() / depth - w.y() * (1 + kA * kA / 3),
                         -v.y() / depth + w.x() * (1 + kB * kB / 3)),
                true, 0};
  return frame;
}

Vector12 at_height(double height) {
  Vector12 x = Vector12::Zero();
  x(2) = -height;
  return x;
}

/// Exact sensors need neither the original's correction factor nor its neglect of turning.
MamboSettings exact_settings() {
  MamboSettings settings;
  settings.flow_scale = 1;
  settings.flow_compensation_x = 1 + kA * kA / 3;
  settings.flow_compensation_y = 1 + kB * kB / 3;
  return settings;
}

TEST(MamboEstimator, HoversWhereItWasPut) {
  Vector12 x = at_height(1.1);
  x.head<2>() << 3, -2;
  x(5) = 8;  // more than a turn of yaw
  const MamboSettings settings = exact_settings();
  MamboState state = mambo_estimator_start(settings, x);
  for (int k = 0; k < 1000; ++k) {
    const Estimate<double> estimate = step(settings, state, perfect_frame(x));
    ASSERT_THAT(estimate.x, MatrixNear(x, 1e-12));
    ASSERT_TRUE(estimate.finite && estimate.height_used && estimate.flow_used);
    ASSERT_FALSE(estimate.flow_disagrees);
    ASSERT_EQ(estimate.innovation_freedom, 3);
  }
}

TEST(MamboEstimator, RunsTheFiltersOfThePublishedTables) {
  const MamboSettings settings;
  const Vector12 x = at_height(1);
  MamboState state = mambo_estimator_start(settings, x);
  for (int k = 0; k < 20000; ++k) step(settings, state, perfect_frame(x));
  // Published steady gains, P Cᵀ (C P Cᵀ + R)⁻¹ of the predicted covariances.
  const Vector2d gain = state.altitude.P.col(0) / (state.altitude.P(0, 0) + 0.1);
  EXPECT_THAT(gain, MatrixNear(Vector2d(0.0262414206418703, 0.0697767360714920), 1e-14));
  EXPECT_NEAR(state.velocity.P(0, 0) / (state.velocity.P(0, 0) + 5), 0.1254656089860898, 1e-14);
}

TEST(MamboEstimator, FindsTheBiasesWhileItStands) {
  MamboSettings settings = exact_settings();
  settings.calibration_time = 0.5;
  Vector12 x = Vector12::Zero();
  x.segment<3>(3) << 0.05, -0.1, 1;  // on a slope that is known
  MamboState state = mambo_estimator_start(settings, x);
  const Vector3d gyro_bias(-0.0095, -0.0075, 0.0015);
  const Vector3d force_bias(0.09, -0.06, 0.337);
  for (int k = 0; k < 100; ++k) {
    Frame frame = perfect_frame(x);
    const double flicker = k % 2 ? 1 : -1;
    frame.rates.value += gyro_bias + Vector3d::Constant(0.1 * flicker);
    frame.specific_force.value += force_bias + Vector3d::Constant(flicker);
    ASSERT_EQ(step(settings, state, frame).x, x) << "period " << k;
  }
  EXPECT_THAT(state.attitude.gyro_bias, MatrixNear(gyro_bias, 1e-14));
  EXPECT_THAT(state.force_bias, MatrixNear(force_bias, 1e-13));
  Frame frame = perfect_frame(x);
  frame.rates.value += gyro_bias;
  frame.specific_force.value += force_bias;
  // The last sample of the time had flickered; half of it is in the first mean of two.
  state.attitude.gyro = frame.rates.value;
  for (int k = 0; k < 100; ++k) ASSERT_THAT(step(settings, state, frame).x, MatrixNear(x, 1e-12));
}

TEST(MamboEstimator, FollowsARamp) {
  const MamboSettings settings;
  Vector12 x = at_height(0.5);
  MamboState state = mambo_estimator_start(settings, x);
  x(3) = 0.3;  // the sonar looks aside, and the estimator has to know
  state.attitude.angles.x() = 0.3;
  Estimate<double> estimate;
  for (int k = 0; k < 2000; ++k) {
    x(2) = -0.5 - 0.2 * k * settings.dt;
    estimate = step(settings, state, perfect_frame(x));
  }
  EXPECT_NEAR(estimate.x(2), x(2), 1e-9);
  const Eigen::Matrix3d R = rotation_of_euler(0.3, 0.0, 0.0);
  EXPECT_NEAR((R * estimate.x.segment<3>(kVelocity)).z(), -0.2, 1e-9);
}

TEST(MamboEstimator, PredictsHeightByTheAccelerationWithoutEcho) {
  const MamboSettings settings;
  Vector12 x = at_height(1);
  MamboState state = mambo_estimator_start(settings, x);
  Estimate<double> estimate;
  for (int k = 0; k < 200; ++k) {
    Frame frame = perfect_frame(x, Vector3d(0, 0, -0.5));
    frame.sonar.value = kNaN;
    estimate = step(settings, state, frame);
    ASSERT_FALSE(estimate.height_used);
  }
  // Sums, not integrals: vz[k] = a dt k, z[k] = z[0] + a dt² k (k - 1)/2.
  EXPECT_NEAR(estimate.x(8), -0.5 * 0.005 * 199, 1e-12);
  EXPECT_NEAR(estimate.x(2), -1 - 0.5 * 0.005 * 0.005 * 199 * 198 / 2, 1e-12);
}

TEST(MamboEstimator, RefusesEchoesThatJump) {
  const MamboSettings settings;
  const Vector12 x = at_height(1);
  MamboState with = mambo_estimator_start(settings, x);
  MamboState without = with;
  for (int k = 0; k < 400; ++k) {
    Frame frame = perfect_frame(x);
    const bool outlier = k % 3 == 1;
    if (outlier) frame.sonar.value = k % 2 ? 1.31 : 0.69;
    const Estimate<double> estimate = step(settings, with, frame);
    // After an outlier the next good echo is a jump as well: it is the one after that which counts.
    ASSERT_EQ(estimate.height_used, k % 3 == 0) << k;
    if (k % 3 != 0) frame.sonar.value = kNaN;
    ASSERT_EQ(estimate.x, step(settings, without, frame).x);
  }
  // Within the gate it is believed.
  Frame frame = perfect_frame(x);
  frame.sonar.value = 1.29;
  MamboState near = mambo_estimator_start(settings, x);
  EXPECT_TRUE(step(settings, near, frame).height_used);
}

TEST(MamboEstimator, ComesBackFromAFloorThatIsAnother) {
  const MamboSettings settings;
  const Vector12 x = at_height(1.5);
  MamboState state = mambo_estimator_start(settings, x);
  int refused = 0;
  bool found = false;
  double z = 0;
  for (int k = 0; k < 400 && !found; ++k) {
    Frame frame = perfect_frame(x);
    frame.sonar.value = 1;  // a table of half a metre
    const Estimate<double> estimate = step(settings, state, frame);
    found = estimate.height_used;
    refused += !found;
    z = estimate.x(2);
  }
  EXPECT_TRUE(found);
  EXPECT_NEAR(z, -1, 1e-12);
  EXPECT_EQ(refused, 200);  // a second, and not a period more
}

TEST(MamboEstimator, BelievesTheSonarWithinItsRangeOnly) {
  MamboSettings settings;
  for (const double range : {0.05, 0.2, 4.9, 5.1}) {
    MamboState state = mambo_estimator_start(settings, at_height(range));
    EXPECT_EQ(step(settings, state, perfect_frame(at_height(range))).height_used,
              range > 0.1 && range < 5);
  }
  Vector12 tipped = at_height(1);
  tipped(3) = 1.2;
  MamboState state = mambo_estimator_start(settings, tipped);
  const Estimate<double> estimate = step(settings, state, perfect_frame(tipped));
  EXPECT_FALSE(estimate.height_used);
  EXPECT_FALSE(estimate.flow_used);
}

TEST(MamboEstimator, ReadsTheVelocityOfFlowInEveryAttitude) {
  std::mt19937_64 random(3);
  std::uniform_real_distribution<double> some(-0.6, 0.6);
  for (int i = 0; i < 100; ++i) {
    Vector12 x = at_height(1.3);
    x.segment<3>(3) << some(random), some(random), 10 * some(random);
    const Vector3d v_W(some(random), some(random), some(random));
    const Eigen::Matrix3d R = rotation_of_euler(x(3), x(4), x(5));
    x.segment<3>(6) = R.transpose() * v_W;
    const Frame frame = perfect_frame(x);
    EXPECT_THAT(velocity_of_flow(frame.flow.value, 1.3, v_W.z(), R),
                MatrixNear(Vector2d(v_W.head<2>()), 1e-14));
  }
}

TEST(MamboEstimator, TakesTheTurningOutOfTheFlow) {
  Vector12 x = at_height(1.2);
  x.tail<3>() << 3e-4, -5e-4, 2e-4;  // small, so that the attitude stays level in one period
  MamboSettings settings = exact_settings();
  settings.position = MamboPosition::flow_velocity;
  MamboState state = mambo_estimator_start(settings, x);
  step(settings, state, perfect_frame(x));
  EXPECT_THAT(state.flow_position, MatrixNear(Vector2d(Vector2d::Zero()), 1e-18));

  // Left in, it is a velocity of height · rate · (1 + a²/3), times the correction factor.
  settings = MamboSettings();
  state = mambo_estimator_start(settings, x);
  step(settings, state, perfect_frame(x));
  const Vector2d wrong(1.15 * 1.2 * x(10) * (1 + kA * kA / 3),
                       -1.15 * 1.2 * x(9) * (1 + kB * kB / 3));
  EXPECT_THAT(state.flow_position, MatrixNear(Vector2d(0.005 * wrong), 1e-11));
}

/// Turning to and fro on the spot at 1 m: the largest velocity that the flow is taken for. The
/// gyroscope's reading is `lag` late, the flow comes every third period, `delay` after its image.
double velocity_of_turning(MamboSettings settings, double lag, double delay) {
  const Vector12 x0 = at_height(1);
  MamboState state = mambo_estimator_start(settings, x0);
  const auto rate = [](double t) { return 0.5 * std::sin(20 * t); };
  double worst = 0;
  for (int k = 0; k < 400; ++k) {
    const double t = k * settings.dt;
    // Images are taken at their own instants, between the control periods.
    const double image = std::floor((t - delay) / 0.017) * 0.017;
    const bool fresh = image > (k - 1) * settings.dt - delay;
    Frame frame = perfect_frame(x0);
    frame.rates.value.y() = rate(t - lag);
    frame.flow = {Vector2d(-rate(image) * (1 + kA * kA / 3), 0), fresh, t - image};
    step(settings, state, frame);
    // What the flow alone says, before the attitude's share.
    if (k > 20) worst = std::max(worst, std::abs(state.flow(0)));
  }
  return worst;
}

TEST(MamboEstimator, TakesOutTheTurningOfTheImagesOwnInstant) {
  MamboSettings settings = exact_settings();
  for (const auto& [lag, delay] : {std::pair(0.0124, 0.0), std::pair(0.0, 0.03),
                                   std::pair(0.02, 0.013), std::pair(0.013, 0.0131)}) {
    settings.gyro_lag = 0;
    settings.aligned_periods = 0;
    const double before = velocity_of_turning(settings, lag, delay);
    settings.gyro_lag = lag;
    settings.aligned_periods = flow_alignment_periods(lag, delay, settings.dt);
    const double after = velocity_of_turning(settings, lag, delay);
    // A straight line between readings 5 ms apart misses (20 · 5 ms)²/8 of the rate.
    EXPECT_LT(after, 0.5 * 1.2 * 0.01 / 8) << lag << " " << delay;
    EXPECT_GT(before, 10 * after) << lag << " " << delay;
  }
  EXPECT_EQ(flow_alignment_periods(0, 0, 0.005), 0);
  EXPECT_EQ(flow_alignment_periods(10, 0, 0.005), kMaxAlignedPeriods);
}

TEST(MamboEstimator, FollowsAFlightOverTheGround) {
  const MamboSettings settings = exact_settings();
  Vector12 x = at_height(1);
  x(5) = 2;
  const Vector3d v_W(0.5, -0.3, 0);
  x.segment<3>(6) = rotation_of_euler(0.0, 0.0, 2.0).transpose() * v_W;
  MamboState state = mambo_estimator_start(settings, at_height(1));
  state.attitude.angles.z() = 2;
  Estimate<double> estimate;
  for (int k = 0; k < 1000; ++k) estimate = step(settings, state, perfect_frame(x));
  EXPECT_THAT(estimate.x.segment<3>(6), MatrixNear(Vector3d(x.segment<3>(6)), 1e-12));
  // From a start at rest, the filter loses what it had not yet believed.
  EXPECT_NEAR(estimate.x(0), 999 * 0.005 * 0.5, 0.03);
  // The original's factor shows as it is where the sensor is exact.
  MamboSettings original;
  state = mambo_estimator_start(original, x);
  for (int k = 0; k < 1000; ++k) estimate = step(original, state, perfect_frame(x));
  EXPECT_THAT(estimate.x.segment<3>(6), MatrixNear(Vector3d(1.15 * x.segment<3>(6)), 1e-12));
}

TEST(MamboEstimator, HoldsTheFlowOrUsesItOnce) {
  const Vector12 x = at_height(1);
  for (const bool hold : {true, false}) {
    MamboSettings settings;
    settings.hold_flow = hold;
    MamboState state = mambo_estimator_start(settings, x);
    int used = 0;
    int come = 0;
    for (int k = 0; k < 200; ++k) {
      Frame frame = perfect_frame(x);
      frame.flow.fresh = k * 60 / 200 != (k - 1) * 60 / 200;  // 60 Hz in 200 Hz
      come += frame.flow.fresh;
      used += step(settings, state, frame).flow_used;
    }
    EXPECT_EQ(come, 59);
    // The first sample comes in the fourth period.
    EXPECT_EQ(used, hold ? 196 : come);
  }
}

TEST(MamboEstimator, LetsOldAndLowFlowGo) {
  const MamboSettings settings;
  const Vector12 low = at_height(0.39);
  MamboState state = mambo_estimator_start(settings, low);
  EXPECT_FALSE(step(settings, state, perfect_frame(low)).flow_used);
  const Vector12 high = at_height(0.41);
  state = mambo_estimator_start(settings, high);
  EXPECT_TRUE(step(settings, state, perfect_frame(high)).flow_used);
  int used = 0;
  for (int k = 0; k < 100; ++k) {
    Frame frame = perfect_frame(high);
    frame.flow.fresh = false;
    used += step(settings, state, frame).flow_used;
  }
  EXPECT_NEAR(used, 20, 1);  // 0.1 s
}

TEST(MamboEstimator, IntegratesWhatItIsAskedTo) {
  MamboSettings settings = exact_settings();
  MamboSettings raw = settings;
  raw.position = MamboPosition::flow_velocity;
  std::mt19937_64 random(4);
  std::normal_distribution<double> noise(0, 0.2);
  MamboState filtered_state = mambo_estimator_start(settings, at_height(1));
  MamboState raw_state = filtered_state;
  Vector2d filtered_sum = Vector2d::Zero();
  Vector2d raw_sum = Vector2d::Zero();
  for (int k = 0; k < 500; ++k) {
    Frame frame = perfect_frame(at_height(1));
    frame.flow.value += Vector2d(noise(random), noise(random));
    const Estimate<double> filtered = step(settings, filtered_state, frame);
    const Estimate<double> unfiltered = step(raw, raw_state, frame);
    ASSERT_THAT(filtered.x.head<2>(), MatrixNear(filtered_sum, 1e-13));
    ASSERT_THAT(unfiltered.x.head<2>(), MatrixNear(raw_sum, 1e-13));
    filtered_sum += 0.005 * filtered.x.segment<2>(6);
    raw_sum -= 0.005 * frame.flow.value;  // at one metre
    ASSERT_EQ(filtered.x.tail<10>(), unfiltered.x.tail<10>());
  }
  EXPECT_GT((filtered_sum - raw_sum).norm(), 1e-3);
}

// Its position is some metres off; images at 5 Hz, processed in 0.2 s, measure it. The error of a
// scalar filter for a random walk whose variance grows by q per period has a steady variance P with
// P = (P + q) R/(P + q + R) after a measurement with variance R.
TEST(MamboEstimator, BelievesImagesAsTheirVarianceSays) {
  const MamboSettings settings = exact_settings();
  Vector12 x = at_height(1);
  x.segment<3>(6) << 0.5, -0.2, 0;
  Vector12 believed = x;
  believed.head<2>() << 2, -3;
  MamboState state = mambo_estimator_start(settings, believed);
  constexpr int kPeriods = 40;
  const double walk = kPeriods * settings.position_Q;
  double P = 0;
  Estimate<double> estimate;
  Vector2d error = believed.head<2>();
  for (int k = 1; k <= 8000; ++k) {
    const Vector2d truth = x.head<2>() + (k - 1) * 0.005 * x.segment<2>(6);
    Frame frame = perfect_frame(x);
    frame.vision.age = 0.2;
    frame.vision.value << truth - 0.2 * x.segment<2>(6), 77;  // its height is not used
    frame.vision.fresh = k % kPeriods == 1 && k > 1;
    estimate = step(settings, state, frame);
    if (frame.vision.fresh) {
      P += walk;
      error *= 1 - P / (P + settings.vision_R);
      P *= 1 - P / (P + settings.vision_R);
    }
    ASSERT_THAT(estimate.x.head<2>(), MatrixNear(Vector2d(truth + error), 1e-10)) << k;
    ASSERT_EQ(estimate.x(2), -1);
  }
  EXPECT_LT(error.norm(), 1e-6);
  EXPECT_NEAR(P * P + walk * P, walk * settings.vision_R, 1e-15);
  // The flow's own sum is corrected too.
  MamboSettings raw = settings;
  raw.position = MamboPosition::flow_velocity;
  EXPECT_THAT(step(raw, state, perfect_frame(x)).x.head<2>(),
              MatrixNear(Vector2d(8000 * 0.005 * x.segment<2>(6)), 1e-6));
  // Values that are not numbers are ignored.
  Frame bad = perfect_frame(x);
  bad.vision = {Vector3d(kNaN, 0, 0), true, 0};
  EXPECT_THAT(step(settings, state, bad).x.head<2>(),
              MatrixNear(Vector2d(8001 * 0.005 * x.segment<2>(6)), 1e-6));
}

// Oliveira 2020, section 6.3: carried along a lemniscate of 60 cm at 60 cm height. There the mean
// absolute error is 0.7 mm with the full flow; here the raw integral of perfect flow at 200 Hz.
TEST(MamboEstimator, DrawsALemniscate) {
  MamboSettings settings = exact_settings();
  settings.position = MamboPosition::flow_velocity;
  // The arm accelerates it without tilting it, which the accelerometer would take for a tilt.
  settings.attitude_time_constant = std::numeric_limits<double>::infinity();
  settings.bias_time_constant = std::numeric_limits<double>::infinity();
  const double rate = 2 * std::numbers::pi / 10;
  const auto place = [&](double t) {  // of Gerono
    return Vector3d(0.3 * std::sin(rate * t), 0.15 * std::sin(2 * rate * t), -0.6);
  };
  const double h = 1e-4;
  const auto state_at = [&](double t) {
    Vector12 x = Vector12::Zero();
    x.head<3>() = place(t);
    x.segment<3>(6) = (place(t + h) - place(t - h)) / (2 * h);
    return x;
  };
  MamboState state = mambo_estimator_start(settings, state_at(0));
  double raw_error = 0;
  double filtered_error = 0;
  constexpr int kPeriods = 2000;
  for (int k = 0; k < kPeriods; ++k) {
    const double t = k * settings.dt;
    const Vector3d a = (place(t + h) - 2 * place(t) + place(t - h)) / (h * h);
    const Vector2d filtered = state.position;
    const Estimate<double> estimate = step(settings, state, perfect_frame(state_at(t), a));
    raw_error += (estimate.x.head<2>() - place(t).head<2>()).cwiseAbs().mean() / kPeriods;
    filtered_error += (filtered - place(t).head<2>()).cwiseAbs().mean() / kPeriods;
  }
  EXPECT_LT(raw_error, 0.7e-3);
  EXPECT_LT(filtered_error, 0.7e-3);
}

TEST(MamboEstimator, SaysWhenFlowDisagrees) {
  const MamboSettings settings = exact_settings();
  const Vector12 x = at_height(1);
  MamboState state = mambo_estimator_start(settings, x);
  for (const double velocity : {0.99, 1.01}) {
    MamboState now = state;
    Frame frame = perfect_frame(x);
    frame.flow.value.x() -= velocity;
    EXPECT_EQ(step(settings, now, frame).flow_disagrees, velocity > 1);
  }
}

TEST(MamboEstimator, IsNotPoisonedBySensors) {
  const MamboSettings settings;
  const Vector12 x = at_height(1);
  MamboState state = mambo_estimator_start(settings, x);
  for (const double bad : {kNaN, std::numeric_limits<double>::infinity()})
    for (int which = 0; which < 4; ++which) {
      Frame frame = perfect_frame(x);
      if (which == 0) frame.rates.value.y() = bad;
      if (which == 1) frame.specific_force.value.z() = bad;
      if (which == 2) frame.flow.value.x() = bad;
      if (which == 3) frame.sonar.value = bad;
      const Estimate<double> estimate = step(settings, state, frame);
      EXPECT_TRUE(estimate.finite);
      EXPECT_THAT(estimate.x, MatrixNear(x, 1e-12));
    }
  state.velocity.x(0) = kNaN;  // if it happens all the same, it is said
  EXPECT_FALSE(step(settings, state, perfect_frame(x)).finite);
}

// Lanes with noises, masks and echoes of their own, against each alone; the first also in float.
TEST(MamboEstimator, LanesDoNotDependOnEachOtherAndFloatFollows) {
  MamboSettings settings;
  settings.calibration_time = 0.1;
  settings.bias_time_constant = 20;
  settings.gyro_lag = 0.012;
  settings.aligned_periods = 5;
  const auto packed = mambo_estimator_cast<Pack<4>>(settings);
  const auto one = mambo_estimator_cast<Pack<1>>(settings);
  const auto single = mambo_estimator_cast<float>(settings);
  const Vector12 x = at_height(1);
  auto together = mambo_estimator_start<Pack<4>>(packed, x.cast<Pack<4>>());
  auto rough = mambo_estimator_start<float>(single, x.cast<float>());
  MamboState exact = mambo_estimator_start(settings, x);
  std::array<MamboEstimatorState<Pack<1>>, 4> alone;
  for (auto& state : alone) state = mambo_estimator_start<Pack<1>>(one, x.cast<Pack<1>>());
  std::mt19937_64 random(7);
  std::normal_distribution<double> noise(0, 0.1);
  const auto put = [](auto& sample, int l, const auto& from) {
    for (int i = 0; i < from.value.size(); ++i) set_lane(sample.value(i), l, from.value(i));
    set_lane(sample.fresh, l, from.fresh);
  };
  const auto copy = [](auto& sample, const auto& from) {
    for (int i = 0; i < from.value.size(); ++i) sample.value(i) = static_cast<float>(from.value(i));
    sample.fresh = from.fresh;
  };
  for (int k = 0; k < 600; ++k) {
    SensorFrame<Pack<4>> frames;
    std::array<Frame, 4> frame;
    for (int l = 0; l < 4; ++l) {
      Frame& f = frame[l] = perfect_frame(x);
      for (int i = 0; i < 3; ++i) f.rates.value(i) += noise(random);
      for (int i = 0; i < 3; ++i) f.specific_force.value(i) += noise(random);
      for (int i = 0; i < 2; ++i) f.flow.value(i) += noise(random);
      f.sonar.value += 0.3 * noise(random);
      if (k % (5 + l) == 0) f.sonar.value = kNaN;
      f.flow.fresh = (k + l) % 3 == 0;
      f.rates.fresh = (k + l) % 17 != 0;
      put(frames.rates, l, f.rates);
      put(frames.specific_force, l, f.specific_force);
      put(frames.flow, l, f.flow);
      set_lane(frames.sonar.value, l, f.sonar.value);
      set_lane(frames.sonar.fresh, l, true);
    }
    const Estimate<Pack<4>> estimate = step(packed, together, frames);
    for (int l = 0; l < 4; ++l) {
      SensorFrame<Pack<1>> f;
      put(f.rates, 0, frame[l].rates);
      put(f.specific_force, 0, frame[l].specific_force);
      put(f.flow, 0, frame[l].flow);
      f.sonar = {frame[l].sonar.value, true, 0};
      const Estimate<Pack<1>> lonely = step(one, alone[l], f);
      ASSERT_EQ(lane_of(estimate.x, l), lane_of(lonely.x, 0)) << "period " << k;
      ASSERT_EQ(lane(estimate.height_used, l), lane(lonely.height_used, 0));
      ASSERT_EQ(lane(estimate.flow_used, l), lane(lonely.flow_used, 0));
      ASSERT_EQ(lane(estimate.innovation_square, l), lane(lonely.innovation_square, 0));
    }
    SensorFrame<float> f;
    copy(f.rates, frame[0].rates);
    copy(f.specific_force, frame[0].specific_force);
    copy(f.flow, frame[0].flow);
    f.sonar = {static_cast<float>(frame[0].sonar.value), true, 0};
    const Estimate<float> coarse = step(single, rough, f);
    ASSERT_THAT(coarse.x.cast<double>(), MatrixNear(step(settings, exact, frame[0]).x, 2e-5));
  }
}

// Every setting another than its default, so that one that is forgotten or swapped shows.
TEST(MamboEstimator, CastKeepsEverySetting) {
  const MamboSettings settings = {0.01, 1.5, 2,     3,     4,
                                  5,    6,   7,     8,     9,
                                  10,   11,  12,    13,    14,
                                  15,   16,  17,    0.175, 3,
                                  18,   19,  false, 20,    MamboPosition::flow_velocity};
  EXPECT_EQ(mambo_estimator_cast<double>(settings), settings);
}

TEST(MamboEstimator, RefusesWhatCannotRun) {
  EXPECT_NO_THROW(validate(MamboSettings(), "estimator"));
  EXPECT_NO_THROW(validate(MamboEstimatorSettings<float>(), "estimator"));
  const auto refused = [](auto change, const std::string& message) {
    MamboSettings settings;
    change(settings);
    EXPECT_THAT([&] { validate(settings, "estimator"); },
                ThrowsMessage<InvalidInput>(StrEq("estimator: " + message)));
  };
  refused([](MamboSettings& s) { s.dt = -1; }, "dt is -1 s, expected a positive number");
  refused([](MamboSettings& s) { s.force_band = 0; },
          "force_band is 0, expected more than 0 because it divides");
  refused([](MamboSettings& s) { s.calibration_time = kNaN; },
          "calibration_time is nan s, expected 0 or more and finite");
  refused([](MamboSettings& s) { s.vision_R = 0; }, "vision_R is 0 m2, expected a positive number");
  refused([](MamboSettings& s) { s.altitude_R = 0; },
          "altitude_R is 0 m2, expected a positive number");
  refused([](MamboSettings& s) { s.velocity_Q = -1; },
          "velocity_Q is -1 m2/s2, expected 0 or more and finite because it is a variance");
  refused(
      [](MamboSettings& s) { s.sonar_min = 6; },
      "sonar_least is 6 m and sonar_greatest 5 m, expected sonar_least < sonar_greatest because "
      "echoes lie between them");
  refused([](MamboSettings& s) { s.gyro_lag = kNaN; }, "gyro_lag is nan s, expected 0 or more");
  refused([](MamboSettings& s) { s.aligned_periods = 33; },
          "aligned_periods is 33, expected 0 to 32");
  refused([](MamboSettings& s) { s.flow_scale = 0; },
          "flow_scale is 0, expected a positive number");
  refused([](MamboSettings& s) { s.flow_compensation_y = kNaN; },
          "flow_compensation is 0 and nan, expected finite numbers");
  refused([](MamboSettings& s) { s.flow_timeout = -0.1; },
          "flow_timeout is -0.1 s, expected 0 or more");
}

}  // namespace
}  // namespace quadtune
