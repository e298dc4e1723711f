// SPDX-License-Identifier: Apache-2.0
#include <gmock/gmock.h>

#include <cmath>
#include <random>
#include <vector>

#include "matrix_near.hpp"
#include "numbers.hpp"
#include "quadtune/errors.hpp"
#include "quadtune/simulation/carried_motion.hpp"
#include "quadtune/simulation/smooth_path.hpp"

namespace quadtune {
namespace {

using Eigen::Vector3d;
using testing::MatrixNear;

using testing::kPi;

// first, first + step, … before last.
std::vector<double> path_times(double first, double last, double step) {
  std::vector<double> all;
  while (first + static_cast<double>(all.size()) * step < last)
    all.push_back(first + static_cast<double>(all.size()) * step);
  return all;
}

Passage passage(double begin, double ramp, Nose nose = Nose::fixed, double yaw = 0) {
  return {begin, ramp, nose, yaw};
}

// Each kind, each nose, both senses; a ramp that takes all of the way as well.
std::vector<SmoothPath> some_paths() {
  std::vector<SmoothPath> paths;
  for (const Nose nose : {Nose::fixed, Nose::ahead}) {
    paths.push_back(LinePath{{1, 2, -1}, {4, -2, -2}, 0.7, passage(1, 1.5, nose, 0.3)});
    for (const double radius : {2.0, -0.5})
      paths.push_back(CirclePath{{1, 0, -1}, radius, 0.4, 0.8, 1.3, passage(0.5, 1, nose, 0.3)});
    paths.push_back(
        LemniscatePath{{0, 1, -0.6}, 0.6, 0.3, 0.9, 5, 1.2, passage(2, 0.8, nose, 0.3)});
    paths.push_back(LemniscatePath{{0, 1, -0.6}, 2, 3, -2, 5, 3, passage(0, 15, nose, 0.3)});
  }
  return paths;
}

TEST(SmoothPath, DerivativesAreThoseOfDifferences) {
  constexpr double kStep = 2e-5;
  for (const SmoothPath& path : some_paths()) {
    const double end = path_end(path);
    for (const double t : path_times(-0.5, end + 1, 0.0371)) {
      const PathPoint before = path_point(path, t - kStep);
      const PathPoint now = path_point(path, t);
      const PathPoint after = path_point(path, t + kStep);
      const auto slope = [&](const auto& later, const auto& earlier) {
        return ((later - earlier) / (2 * kStep)).eval();
      };
      EXPECT_THAT(now.velocity, MatrixNear(slope(after.position, before.position), 1e-8)) << t;
      EXPECT_THAT(now.acceleration, MatrixNear(slope(after.velocity, before.velocity), 1e-7)) << t;
      EXPECT_NEAR(now.yaw_rate, (after.yaw - before.yaw) / (2 * kStep), 4e-7) << t;
    }
  }
}

// The acceleration has no jump either: at the four corners of the law of time its differences stay
// within the jerk.
TEST(SmoothPath, AccelerationIsContinuous) {
  for (const SmoothPath& path : some_paths()) {
    const double end = path_end(path);
    Vector3d before = path_point(path, -0.1).acceleration;
    for (const double t : path_times(-0.1, end + 0.1, 1e-4)) {
      const Vector3d now = path_point(path, t).acceleration;
      ASSERT_LT((now - before).norm(), 5e-3) << t;
      before = now;
    }
  }
}

TEST(SmoothPath, StandsAtItsEnds) {
  for (const SmoothPath& path : some_paths()) {
    for (const double t : {-1e9, -1.0, path_end(path), path_end(path) + 1, 1e9}) {
      const PathPoint point = path_point(path, t);
      EXPECT_EQ(point.velocity, Vector3d::Zero().eval());
      EXPECT_EQ(point.acceleration, Vector3d::Zero().eval());
      EXPECT_EQ(point.yaw_rate, 0);
    }
  }
}

TEST(LinePath, GoesAtItsSpeedAndArrives) {
  const LinePath line{{0, 0, -1}, {3, 4, -1}, 0.5, passage(2, 1)};
  EXPECT_NEAR(path_end(line), 2 + 10 + 1, 1e-12);  // 5 m at 0.5 m/s, and one ramp
  EXPECT_THAT(path_point(line, 2).position, MatrixNear(line.from, 0));
  EXPECT_THAT(path_point(line, 13).position, MatrixNear(line.to, 1e-12));
  EXPECT_THAT(path_point(line, 7.5).position, MatrixNear(Vector3d(1.5, 2, -1), 1e-12));
  EXPECT_THAT(path_point(line, 7.5).velocity, MatrixNear(Vector3d(0.3, 0.4, 0), 1e-12));
  // Half of a ramp: u = 1/2 gives half of the rate and 1/64 - 3/32 + 5/32 = 5/64 of rate · ramp.
  EXPECT_NEAR(path_point(line, 2.5).velocity.norm(), 0.25, 1e-15);
  EXPECT_NEAR((path_point(line, 2.5).position - line.from).norm(), 0.5 * 5 / 64, 1e-15);
  EXPECT_NEAR(path_point(line, 2.5).acceleration.norm(), 0.5 * 1.875, 1e-14);
}

TEST(CirclePath, TurnsRightForPositiveRadii) {
  const CirclePath right{{0, 0, -1}, 2, 0, 1, 1, passage(0, 1, Nose::ahead)};
  EXPECT_THAT(path_point(right, 0).position, MatrixNear(Vector3d(2, 0, -1), 1e-15));
  EXPECT_NEAR(path_point(right, 0).yaw, kPi / 2, 1e-15);  // to the east, round to the south
  EXPECT_NEAR(path_point(right, path_end(right)).yaw, kPi / 2 + 2 * kPi, 1e-12);
  const CirclePath left{{0, 0, -1}, -2, 0, 1, 1, passage(0, 1, Nose::ahead)};
  EXPECT_NEAR(path_point(left, path_end(left)).yaw, -kPi / 2 - 2 * kPi, 1e-12);
  const PathPoint on_the_way = path_point(right, 5);
  EXPECT_NEAR(on_the_way.velocity.norm(), 1, 1e-14);
  EXPECT_NEAR(on_the_way.acceleration.norm(), 0.5, 1e-14);  // v² / r
  EXPECT_NEAR(on_the_way.yaw_rate, 0.5, 1e-15);
  EXPECT_THAT(on_the_way.position + Vector3d(0, 0, 1),
              MatrixNear(-on_the_way.acceleration * 4, 1e-13));
}

// 60 cm from tip to tip, at the tips a quarter and three quarters round, through the crossing
// halfway.
TEST(LemniscatePath, HasItsLengthAndWidth) {
  const LemniscatePath path{{1, 2, -0.6}, 0.6, 0.3, 0, 10, 1, passage(2, 1)};
  EXPECT_NEAR(path_end(path), 13, 1e-12);
  Vector3d min = path_point(path, 0).position, max = min;
  for (const double t : path_times(0, 13, 1e-3)) {
    min = min.cwiseMin(path_point(path, t).position);
    max = max.cwiseMax(path_point(path, t).position);
  }
  EXPECT_THAT(max - min, MatrixNear(Vector3d(0.6, 0.3, 0), 1e-6));
  EXPECT_THAT(path_point(path, 7.5).position, MatrixNear(Vector3d(1, 2, -0.6), 1e-12));
  EXPECT_THAT(path_point(path, 5).position, MatrixNear(Vector3d(1.3, 2, -0.6), 1e-12));
  LemniscatePath turned = path;
  turned.heading = kPi / 2;  // its long axis to the east
  EXPECT_THAT(path_point(turned, 5).position, MatrixNear(Vector3d(1, 2.3, -0.6), 1e-12));
}

TEST(LemniscatePath, NoseFollowsTheVelocityWithoutJumps) {
  LemniscatePath path{{0, 0, -1}, 2, 1, 0.7, 4, 5, passage(0, 1, Nose::ahead)};
  for (const double width : {0.01, 1.0, 20.0}) {
    path.width = width;
    double before = path_point(path, 0).yaw;
    for (const double t : path_times(1e-3, path_end(path) - 1e-2, 1e-3)) {
      const PathPoint point = path_point(path, t);
      ASSERT_LT(std::abs(point.yaw - before), kPi / 2) << t;
      before = point.yaw;
      if (t < 0.01) continue;  // too slow for a direction
      ASSERT_THAT(Vector3d(std::cos(point.yaw), std::sin(point.yaw), 0),
                  MatrixNear(point.velocity.normalized(), 1e-9))
          << t;
    }
    EXPECT_NEAR(path_point(path, path_end(path)).yaw, path_point(path, 0).yaw, 1e-9);
  }
}

TEST(SmoothPath, RefusesWhatIsNoPath) {
  const double nan = std::nan("");
  EXPECT_THROW(validate(LinePath{}, "here"), InvalidInput);
  EXPECT_THROW(validate(LinePath{{0, 0, 0}, {1, 0, 0}, nan, {}}, "here"), InvalidInput);
  EXPECT_THROW(validate(CirclePath{{0, 0, -1}, nan, 0, 1, 1, {}}, "here"), InvalidInput);
  EXPECT_THROW(validate(LemniscatePath{{0, 0, nan}, 1, 1, 0, 9, 1, {}}, "here"), InvalidInput);
  EXPECT_THROW(validate(LemniscatePath{{0, 0, 0}, 1, 1, 0, 0.5, 1, {}}, "here"), InvalidInput);
  EXPECT_THROW(validate(LinePath{{0, 0, 0}, {9, 0, 0}, 1, passage(0, 0)}, "here"), InvalidInput);
  for (const SmoothPath& path : some_paths()) EXPECT_NO_THROW(validate(path, "here"));
}

TEST(CarriedMotion, RefusesWhatIsNoPath) {
  EXPECT_THROW(CarriedMotion({LinePath{}}), InvalidInput);
}

// Attitude, velocity and rates fit together: x' of the kinematics by differences.
TEST(CarriedMotion, ObeysKinematics) {
  constexpr double kStep = 2e-5;
  for (const SmoothPath& path : some_paths()) {
    const CarriedMotion carried({path});
    for (const double t : path_times(0, path_end(path), 0.0513)) {
      const Motion before = carried.at(t - kStep), now = carried.at(t),
                   after = carried.at(t + kStep);
      const Eigen::Matrix3d R_WB =
          rotation_of_euler(now.attitude.x(), now.attitude.y(), now.attitude.z());
      const Vector3d body_velocity = now.state().segment<3>(kVelocity);
      EXPECT_THAT(R_WB * body_velocity,
                  MatrixNear((after.position - before.position) / (2 * kStep), 1e-8));
      EXPECT_THAT(euler_rate_matrix(now.attitude.x(), now.attitude.y()) * now.rates,
                  MatrixNear((after.attitude - before.attitude) / (2 * kStep), 4e-7));
      // v' = R_BW a - w × v, so that the specific force is v' + w × v - R_BW g.
      const Vector3d body_acceleration =
          (after.state() - before.state()).segment<3>(kVelocity) / (2 * kStep);
      const Vector3d force = body_acceleration + now.rates.cross(body_velocity) -
                             R_WB.transpose() * Vector3d(0, 0, 9.81);
      EXPECT_THAT(now.specific_force(9.81), MatrixNear(force, 4e-7)) << t;
    }
  }
}

TEST(CarriedMotion, ArmOfTheExperimentIs60CentimetresLongAndHigh) {
  const Mission arm = load_mission("lemniscate-carried");
  const CarriedMotion carried(std::get<Carried>(arm.kind));
  double min = 0, max = 0;
  for (const double t : path_times(0, arm.duration, 1e-3)) {
    const Motion motion = carried.at(t);
    min = std::min(min, motion.position.x());
    max = std::max(max, motion.position.x());
    ASSERT_EQ(motion.position.z(), -0.6);
    ASSERT_EQ(motion.attitude, Vector3d::Zero().eval());
  }
  EXPECT_NEAR(max - min, 0.6, 1e-6);
  EXPECT_THAT(carried.at(0).specific_force(9.81), MatrixNear(Vector3d(0, 0, -9.81), 0));
  EXPECT_THAT(carried.at(arm.duration).position, MatrixNear(Vector3d(0, 0, -0.6), 1e-12));
}

}  // namespace
}  // namespace quadtune
