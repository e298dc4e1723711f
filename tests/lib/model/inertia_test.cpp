// SPDX-License-Identifier: Apache-2.0
#include "quadtune/model/inertia.hpp"

#include <gmock/gmock.h>

#include <Eigen/Geometry>
#include <random>

#include "matrix_near.hpp"
#include "quadtune/errors.hpp"

namespace quadtune {
namespace {

using ::testing::HasSubstr;
using testing::MatrixNear;
using testing::MatrixRelativelyNear;
using ::testing::StrEq;
using ::testing::ThrowsMessage;

// The Mambo thesis, equation 2.13: four motors on a plus of arm l around a solid sphere.
TEST(MassProperties, AreTheThesisSphereAndFourMotors) {
  const double M0 = 0.043;
  const double r = 0.03;
  const double m_r = 0.005;
  const double l = 0.0624;
  const MassProperties whole = mass_properties({{M0, r},
                                                {m_r, 0, {l, 0, 0}},
                                                {m_r, 0, {0, l, 0}},
                                                {m_r, 0, {-l, 0, 0}},
                                                {m_r, 0, {0, -l, 0}}});
  const double sphere = 2.0 / 5 * M0 * r * r;
  const Eigen::Vector3d expected(sphere + 2 * l * l * m_r, sphere + 2 * l * l * m_r,
                                 sphere + 4 * l * l * m_r);
  EXPECT_NEAR(whole.mass, 0.063, 1e-15);
  EXPECT_THAT(whole.inertia, MatrixRelativelyNear(Eigen::Matrix3d(expected.asDiagonal()), 1e-14));
}

// Where the parts stand as a whole does not matter, and turning them turns the inertia.
TEST(MassProperties, FollowsTheBodyThatMoves) {
  std::mt19937_64 random(2);
  std::uniform_real_distribution<double> uniform(-1, 1);
  const auto vector = [&] {
    return Eigen::Vector3d(uniform(random), uniform(random), uniform(random));
  };
  for (int i = 0; i < 100; ++i) {
    const Eigen::Matrix3d R =
        Eigen::AngleAxisd(3 * uniform(random), vector().normalized()).toRotationMatrix();
    const Eigen::Vector3d shift = vector();
    std::vector<Sphere> here;
    std::vector<Sphere> there;
    for (int part = 0; part < 5; ++part) {
      here.push_back({1.1 + uniform(random), 1 + uniform(random), vector()});
      there.push_back(here.back());
      there.back().position = R * here.back().position + shift;
    }
    const MassProperties a = mass_properties(here);
    const MassProperties b = mass_properties(there);
    EXPECT_THAT(b.centre_of_mass, MatrixNear(R * a.centre_of_mass + shift, 1e-13));
    EXPECT_THAT(b.inertia,
                MatrixRelativelyNear(Eigen::Matrix3d(R * a.inertia * R.transpose()), 1e-13));
    EXPECT_NO_THROW(require_inertia(a.inertia, "here"));  // every body has a possible inertia
  }
}

TEST(MassProperties, RejectsInvalidParts) {
  EXPECT_THAT(
      [] {
        (void)mass_properties({{1, 1}, {-1, 0}});
      },
      ThrowsMessage<InvalidInput>(StrEq("part 2: mass is -1 kg, expected more than 0")));
  EXPECT_THROW((void)mass_properties({}), InvalidInput);
  EXPECT_THROW((void)mass_properties({{1, -1}}), InvalidInput);
}

TEST(RequireInertia, ReportsTheAxisThatViolatesTheTriangleInequality) {
  EXPECT_THAT(
      [] { require_inertia(Eigen::Vector3d(1e-5, 2e-5, 4e-5).asDiagonal(), "file:3"); },
      ThrowsMessage<InvalidInput>(StrEq(
          "file:3: inertia violates the triangle inequality: about z it is 4e-05 kg m2, which "
          "exceeds the sum of the other two, 3e-05, by 1e-05; no rigid body has such an "
          "inertia")));
  EXPECT_NO_THROW(require_inertia(Eigen::Vector3d(1e-5, 2e-5, 3e-5).asDiagonal(), "a plate"));
  const Eigen::Matrix3d measured = Eigen::Vector3d(1e-5, 2e-5, 3.1e-5).asDiagonal();
  EXPECT_NO_THROW(require_inertia(measured, "here", 0.04));
  EXPECT_THAT([&] { require_inertia(measured, "here", 0.02); },
              ThrowsMessage<InvalidInput>(HasSubstr("by 1e-06; no rigid body has such an inertia "
                                                    "(inertia_tolerance permits 6.2e-07)")));
}

TEST(RequireInertia, RefusesWhatIsNoInertia) {
  EXPECT_THAT([] { require_inertia(Eigen::Vector3d(1, 0, 1).asDiagonal(), "here"); },
              ThrowsMessage<InvalidInput>(HasSubstr("inertia about y is 0 kg m2, expected more")));
  EXPECT_THAT(
      [] { require_inertia(Eigen::Vector3d(1, 1, 1e-10).asDiagonal(), "here"); },
      ThrowsMessage<InvalidInput>(HasSubstr(
          "inertia about z is 1e-10 kg m2, expected at least 1e-09 kg m2, because no real body")));
  EXPECT_THAT([] { require_inertia(Eigen::Vector3d(1, 1, 1).asDiagonal() * 1e-320, "here"); },
              ThrowsMessage<InvalidInput>(HasSubstr("expected at least 1e-30")));
  Eigen::Matrix3d J = Eigen::Matrix3d::Identity();
  J(0, 1) = 0.1;
  EXPECT_THAT([&] { require_inertia(J, "here"); },
              ThrowsMessage<InvalidInput>(HasSubstr("inertia is not symmetric")));
  J(0, 1) = J(1, 0) = 2;  // symmetric, indefinite
  EXPECT_THROW(require_inertia(J, "here"), InvalidInput);
  J(0, 0) = std::numeric_limits<double>::quiet_NaN();
  EXPECT_THROW(require_inertia(J, "here"), InvalidInput);
}

}  // namespace
}  // namespace quadtune
