// SPDX-License-Identifier: Apache-2.0
#include "quadtune/model/rotation.hpp"

#include <gtest/gtest.h>

#include <numbers>
#include <random>

#include "matrix_near.hpp"

namespace quadtune {
namespace {

using testing::MatrixNear;

constexpr double kRightAngle = std::numbers::pi / 2;

class RandomAngles : public ::testing::Test {
 protected:
  double angle(double limit) {
    return std::uniform_real_distribution<double>(-limit, limit)(random_);
  }
  Eigen::Vector3d regular() { return {angle(3.1), angle(1.5), angle(3.1)}; }
  std::mt19937_64 random_{20};
};
using Rotation = RandomAngles;

TEST_F(Rotation, IsTheProductOfTheThreeTurns) {
  for (int i = 0; i < 100; ++i) {
    const Eigen::Vector3d e = regular();
    const Eigen::Matrix3d expected = (Eigen::AngleAxisd(e.z(), Eigen::Vector3d::UnitZ()) *
                                      Eigen::AngleAxisd(e.y(), Eigen::Vector3d::UnitY()) *
                                      Eigen::AngleAxisd(e.x(), Eigen::Vector3d::UnitX()))
                                         .toRotationMatrix();
    EXPECT_THAT(rotation_of_euler(e.x(), e.y(), e.z()), MatrixNear(expected, 1e-15));
    EXPECT_THAT(quaternion_of_euler(e.x(), e.y(), e.z()).toRotationMatrix(),
                MatrixNear(expected, 2e-15));
  }
}

// Nose up (pitch > 0) turns the forward axis to -z, that is up; yaw to the right turns it east.
TEST_F(Rotation, PositiveAnglesMeanNoseUpRightWingDownAndTurnRight) {
  const Eigen::Vector3d forward(1, 0, 0), right(0, 1, 0);
  EXPECT_LT((rotation_of_euler(0.0, 0.1, 0.0) * forward).z(), 0);
  EXPECT_GT((rotation_of_euler(0.1, 0.0, 0.0) * right).z(), 0);
  EXPECT_GT((rotation_of_euler(0.0, 0.0, 0.1) * forward).y(), 0);
}

TEST_F(Rotation, AnglesReadBack) {
  for (int i = 0; i < 100; ++i) {
    const Eigen::Vector3d e = regular();
    // The angles of a matrix lose 1/cos(pitch) ≤ 15 of the rounding of its entries.
    EXPECT_THAT(euler_of_rotation(rotation_of_euler(e.x(), e.y(), e.z())), MatrixNear(e, 2e-14));
    EXPECT_THAT(euler_of_quaternion(quaternion_of_euler(e.x(), e.y(), e.z())),
                MatrixNear(e, 2e-14));
  }
}

TEST_F(Rotation, StraightUpAndDownKeepTheRotation) {
  for (const double pitch : {kRightAngle, -kRightAngle})
    for (int i = 0; i < 20; ++i) {
      const Eigen::Matrix3d R = rotation_of_euler(angle(3), pitch, angle(3));
      const Eigen::Vector3d e = euler_of_rotation(R);
      EXPECT_EQ(e.x(), 0);
      EXPECT_THAT(rotation_of_euler(e.x(), e.y(), e.z()), MatrixNear(R, 1e-15));
    }
}

TEST_F(Rotation, RatesAreInverseAndMatchTheTurningMatrix) {
  const double h = 1e-6;
  for (int i = 0; i < 100; ++i) {
    const Eigen::Vector3d e = regular();
    const Eigen::Vector3d rates(angle(2), angle(2), angle(2));
    EXPECT_THAT(body_rate_matrix(e.x(), e.y()) * euler_rate_matrix(e.x(), e.y()),
                MatrixNear(Eigen::Matrix3d::Identity(), 1e-13));
    // Rᵀ R' = [w]×, with R' by central differences along the Euler rates; their size, up to
    // 4/cos 1.5 rad = 57, enters the third derivative.
    const Eigen::Vector3d d = euler_rate_matrix(e.x(), e.y()) * rates;
    const Eigen::Vector3d a = e - h * d, b = e + h * d;
    const Eigen::Matrix3d dR =
        (rotation_of_euler(b.x(), b.y(), b.z()) - rotation_of_euler(a.x(), a.y(), a.z())) / (2 * h);
    const Eigen::Matrix3d W = rotation_of_euler(e.x(), e.y(), e.z()).transpose() * dR;
    EXPECT_THAT(Eigen::Vector3d(W(2, 1), W(0, 2), W(1, 0)), MatrixNear(rates, 1e-6));
  }
}

TEST_F(Rotation, FlagsTheSingularPitch) {
  EXPECT_TRUE(euler_angles_are_regular(0));
  EXPECT_TRUE(euler_angles_are_regular(1.57));
  EXPECT_FALSE(euler_angles_are_regular(kRightAngle));
  EXPECT_FALSE(euler_angles_are_regular(-kRightAngle + 1e-7));
  EXPECT_FALSE(euler_angles_are_regular(std::nan("")));
}

}  // namespace
}  // namespace quadtune
