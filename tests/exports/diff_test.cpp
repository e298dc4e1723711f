// SPDX-License-Identifier: Apache-2.0
#include "quadtune/exports/diff.hpp"

#include <gmock/gmock.h>

#include "plants/export_models.hpp"
#include "quadtune/errors.hpp"
#include "quadtune/exports/convert.hpp"
#include "quadtune/exports/uquad.hpp"
#include "shared_data.hpp"

namespace quadtune {
namespace {

using ::testing::HasSubstr;
using testing::hover_gains;
using testing::sampled_uquad;
using ::testing::ThrowsMessage;
using testing::without_horizontal_position;

Gains gains_by_weight(double R = 0.01) {
  return hover_gains(sampled_uquad(), "uquad", InputKind::rotor_speed, R, {"x", "y", "z", "theta"});
}

TEST(Diff, FindsNothingBetweenConventionsAndSignLaws) {
  const Gains a = gains_by_weight();
  EXPECT_TRUE(diff(a, a).entries.empty());
  const Gains b = in_convention(a, convention("mambo", "test"), SignLaw::state_minus_set_point);
  EXPECT_EQ(diff(a, b).max_relative, 0);
  EXPECT_EQ(diff(b, a).max_relative, 0);
}

TEST(Diff, NamesTheLargestDifferenceFirst) {
  const Gains a = gains_by_weight();
  Gains b = in_convention(a, ned_convention());
  b.K(1, 1) *= 1.5;       // py of w2, which is -y there
  b.K_int(0, 2) += 1e-3;  // pz of w1
  const GainsDiff difference = diff(a, b);
  ASSERT_EQ(difference.entries.size(), 2U);
  const DiffEntry& first = difference.entries[0];
  EXPECT_EQ(first.matrix + " " + first.input + " " + first.state, "K w2 y");
  EXPECT_DOUBLE_EQ(first.a, a.K(1, 1));
  EXPECT_DOUBLE_EQ(first.b, 1.5 * a.K(1, 1));
  const DiffEntry& second = difference.entries[1];
  EXPECT_EQ(second.matrix + " " + second.input + " " + second.state, "K_int w1 z");
  EXPECT_NEAR(second.difference, -1e-3, 1e-15);
  EXPECT_EQ(difference.max_relative, first.relative);
}

// y has no gain on w1: 1e-16 there is rounding, not a difference of 100 %.
TEST(Diff, MeasuresRoundingAgainstTheRowAndColumn) {
  Gains a = gains_by_weight();
  a.K(0, 1) = 0;
  Gains b = a;
  b.K(0, 1) = 1e-16;
  EXPECT_LT(diff(a, b).max_relative, 1e-16);
  b = a;
  b.K(0, 0) *= 1.01;
  EXPECT_NEAR(diff(a, b).max_relative, 0.01 / 1.01, 1e-6);  // against its own column
}

// A gain whose rows have other names is another gain; rows in another order are the same gain.
TEST(Diff, MatchesRowsByTheNamesOfInputs) {
  const Gains a = gains_by_weight();
  Gains b = a;
  std::swap(b.inputs[0], b.inputs[1]);
  EXPECT_GT(diff(a, b).max_relative, 0.1);
  b.K.row(0).swap(b.K.row(1));
  b.K_int.row(0).swap(b.K_int.row(1));
  EXPECT_TRUE(diff(a, b).entries.empty());
  // A wrench is turned into other axes by its names, too.
  const Gains mambo =
      testing::hover_gains(testing::sampled_mambo(), "mambo", InputKind::wrench, 1, {"pz", "psi"});
  Gains swapped = mambo;
  std::swap(swapped.inputs[1], swapped.inputs[2]);
  EXPECT_GT(diff(in_convention(mambo, ned_convention()), swapped).max_relative, 0.01);
  swapped.inputs[1].name = "M";
  EXPECT_THAT([&] { (void)in_convention(swapped, ned_convention()); },
              ThrowsMessage<InvalidInput>(HasSubstr("the inputs are ")));
}

// Two laws with equal matrices can differ in their memory, axes and limits.
TEST(Diff, ComparesMemoryAxesAndLimits) {
  Gains a =
      testing::hover_gains(testing::sampled_mambo(), "mambo", InputKind::wrench, 1, {"pz", "psi"});
  a.memory = CommandMemory{Eigen::Vector4d::Constant(0.05), Eigen::MatrixXd::Identity(4, 4), 1,
                           Eigen::MatrixXd::Ones(4, 4)};
  EXPECT_TRUE(diff(a, a).entries.empty());
  EXPECT_TRUE(diff(a, in_convention(a, ned_convention())).entries.empty());
  const auto only = [&](auto&& change) {
    Gains b = a;
    change(b);
    const GainsDiff difference = diff(a, b);
    return difference.entries.size() == 1 ? name_of(difference.entries[0]) : "several";
  };
  EXPECT_EQ(only([](Gains& b) { b.axes = PositionAxes::heading; }), "heading_axes");
  EXPECT_EQ(only([](Gains& b) { b.limits.position_error = 1; }), "position_error_m");
  EXPECT_EQ(only([](Gains& b) { b.limits.conditional_integration = true; }),
            "conditional_integration");
  EXPECT_EQ(only([](Gains& b) { b.memory->lag(1) = 0.06; }), "lag_s(tau_x)");
  EXPECT_EQ(only([](Gains& b) { b.memory->K_lag(0, 2) = 0.1; }), "K_lag(T, tau_y)");
  EXPECT_EQ(only([](Gains& b) { b.memory->K_past(3, 1) = 2; }), "K_past(tau_z, tau_x[-1])");
  Gains without = a;
  without.memory.reset();
  EXPECT_GT(diff(a, without).entries.size(), 20U);
  EXPECT_GT(diff(without, a).entries.size(), 20U);
}

TEST(Diff, ComparesCascades) {
  CascadeDesign a;
  a.gains.dt = 0.005;
  for (const CascadeAxis axis : kAllCascadeAxes) {
    a.gains.loops.push_back(cascade_loop(axis));
    a.gains.loops.back().Kp = 2;
  }
  CascadeDesign b = a;
  std::swap(b.gains.loops[0], b.gains.loops[5]);  // the order has no meaning
  EXPECT_TRUE(diff(a, b).entries.empty());
  b = a;
  b.gains.loops[3].Kp = 2.5;
  b.attitude_limit = 0.5;
  b.method = PidMethod::tustin;
  const GainsDiff difference = diff(a, b);
  ASSERT_EQ(difference.entries.size(), 3U);
  EXPECT_EQ(name_of(difference.entries[0]), "integrator");
  EXPECT_EQ(name_of(difference.entries[1]), "attitude_limit_rad");
  EXPECT_EQ(name_of(difference.entries[2]), "Kp(roll)");
  EXPECT_DOUBLE_EQ(difference.entries[2].relative, 0.2);
  b = a;
  b.gains.loops[3].rate_lead = 0.02;
  EXPECT_EQ(name_of(diff(a, b).entries.at(0)), "rate_lead_s(roll)");
  b = a;
  b.velocity_feed_forward = true;
  EXPECT_EQ(name_of(diff(a, b).entries.at(0)), "velocity_feed_forward");
  b = a;
  b.conditional_integration = true;
  EXPECT_EQ(name_of(diff(a, b).entries.at(0)), "conditional_integration");
}

TEST(Diff, RefusesWhatCannotBeCompared) {
  const auto refusal = [](const Gains& a, const Gains& b, const std::string& message) {
    EXPECT_THAT([&] { (void)diff(a, b); }, ThrowsMessage<InvalidInput>(HasSubstr(message)));
  };
  const Gains a = gains_by_weight();
  const Gains fewer = hover_gains(without_horizontal_position(sampled_uquad()), "uquad",
                                  InputKind::rotor_speed, 0.01, {"z", "theta"});
  refusal(a, fewer, "different states (only in the first: x y vqx vqy; only in the second: )");
  Gains other = a;
  other.input_kind = InputKind::rotor_thrust;
  refusal(a, other, "the gain of A commands rotor-speed, that of B rotor-thrust");
  other = a;
  other.inputs[1].unit = "rpm";
  refusal(a, other, "w2 is in 'rad/s' in the first and in 'rpm' in the second");
  other = a;
  other.integrals.clear();
  other.K_int.resize(4, 0);
  refusal(a, other, "different integrals (only in the first: x y z theta");
}

// The published recursion stopped early: docs/uquad-gains.md.
TEST(Diff, MeasuresThePublishedGainsAgainstConvergedOnes) {
  QUADTUNE_REQUIRE_DATA(path);
  const GainsDiff difference =
      diff(read_uquad_gains(path / "uquad" / "K_full.txt"),
           hover_gains(sampled_uquad(), "uquad", InputKind::rotor_speed, 0.01));
  EXPECT_GT(difference.max_relative, 1e-5);
  EXPECT_LT(difference.max_relative, 1e-3);
}

}  // namespace
}  // namespace quadtune
