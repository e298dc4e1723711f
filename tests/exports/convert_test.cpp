// SPDX-License-Identifier: Apache-2.0
#include "quadtune/exports/convert.hpp"

#include <gmock/gmock.h>

#include "matrix_near.hpp"
#include "plants/export_models.hpp"
#include "quadtune/errors.hpp"

namespace quadtune {
namespace {

using ::testing::HasSubstr;
using testing::hover_gains;
using testing::MatrixNear;
using testing::sampled_mambo;
using testing::sampled_uquad;
using ::testing::ThrowsMessage;

Gains uquad_gains() {
  return hover_gains(sampled_uquad(), "uquad", InputKind::rotor_speed, 0.01,
                     {"x", "y", "z", "theta"});
}

// 1 m too far north: the rotors must do the same in any convention.
TEST(InConvention, CommandsTheSameMotorsInTheSameFlight) {
  const Gains uquad = uquad_gains();
  const Gains ned = in_convention(uquad, ned_convention());
  EXPECT_EQ(names(ned.states), "px py pz roll pitch yaw u v w p q r");
  EXPECT_EQ(names(ned.integrals), "px py pz yaw");
  Eigen::VectorXd x_ned(12);
  x_ned << 1, 2, -3, 0.1, 0.2, 0.3, 4, 5, 6, 7, 8, 9;
  const Eigen::VectorXd x_uquad = convention("uquad", "test").from_ned * x_ned;
  EXPECT_THAT(ned.K * x_ned, MatrixNear(uquad.K * x_uquad, 1e-10));
}

TEST(InConvention, TurnsAWrenchAndComesBack) {
  Gains mambo = hover_gains(sampled_mambo(), "mambo", InputKind::wrench, 1, {"pz", "psi"});
  mambo.u0 << 0.618, 0.1, 0.2, 0.3;
  mambo.x0.setLinSpaced(1, 12);
  const Gains uquad = in_convention(mambo, convention("uquad", "test"));
  EXPECT_THAT(uquad.u0, MatrixNear(Eigen::Vector4d(0.618, 0.1, -0.2, -0.3), 0));
  const Gains back = in_convention(uquad, convention("mambo", "test"));
  EXPECT_THAT(back.K, MatrixNear(mambo.K, 0));
  EXPECT_THAT(back.K_int(Eigen::all, {1, 0}), MatrixNear(mambo.K_int, 0));  // the states' order
  EXPECT_EQ(names(back.integrals), "psi pz");
  EXPECT_THAT(back.x0, MatrixNear(mambo.x0, 0));
}

// The same past commands in other axes give the same command.
TEST(InConvention, TurnsTheMemoryOfCommands) {
  Gains mambo = hover_gains(sampled_mambo(), "mambo", InputKind::wrench, 1, {"pz", "psi"});
  CommandMemory memory{Eigen::Vector4d(0.05, 0.06, 0.07, 0.08), Eigen::MatrixXd(4, 4), 2,
                       Eigen::MatrixXd(4, 8)};
  for (Eigen::Index i = 0; i < 16; ++i) memory.K_lag(i / 4, i % 4) = static_cast<double>(i + 1);
  for (Eigen::Index i = 0; i < 32; ++i) memory.K_past(i / 8, i % 8) = static_cast<double>(50 + i);
  mambo.memory = memory;
  const Convention& source = convention("mambo", "test");
  const Convention& target = convention("uquad", "test");
  const Eigen::MatrixXd W = target.wrench_from_ned * source.wrench_from_ned.transpose();
  const Gains uquad = in_convention(mambo, target);
  ASSERT_TRUE(uquad.memory);
  const Eigen::Vector4d m(0.6, 0.01, -0.02, 0.03), newest(0.5, 0.3, 0.2, 0.1),
      older(0.4, -0.1, 0.7, -0.3);
  Eigen::VectorXd past(8), past_there(8);
  past << newest, older;
  past_there << W * newest, W * older;
  EXPECT_THAT(uquad.memory->K_lag * (W * m), MatrixNear(W * (memory.K_lag * m), 1e-12));
  EXPECT_THAT(uquad.memory->K_past * past_there, MatrixNear(W * (memory.K_past * past), 1e-12));
  EXPECT_THAT(uquad.memory->lag, MatrixNear(W.cwiseAbs() * memory.lag, 0));
  const Gains back = in_convention(uquad, source);
  EXPECT_THAT(back.memory->K_lag, MatrixNear(memory.K_lag, 0));
  EXPECT_THAT(back.memory->K_past, MatrixNear(memory.K_past, 0));
}

TEST(InConvention, NegatesTheGainForTheOtherSignLaw) {
  const Gains gains = uquad_gains();
  const Gains other =
      in_convention(gains, convention("uquad", "test"), SignLaw::state_minus_set_point);
  EXPECT_THAT(other.K, MatrixNear(-gains.K, 0));
  EXPECT_THAT(other.K_int, MatrixNear(-gains.K_int, 0));
}

TEST(InConvention, RefusesAStateThatTheConventionDoesNotHave) {
  Gains gains = uquad_gains();
  gains.states[2].name = "altitude";
  EXPECT_THAT([&] { (void)in_convention(gains, ned_convention()); },
              ThrowsMessage<InvalidInput>(HasSubstr("no state 'altitude' in convention uquad")));
}

}  // namespace
}  // namespace quadtune
