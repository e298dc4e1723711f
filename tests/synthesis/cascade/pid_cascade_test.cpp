// SPDX-License-Identifier: Apache-2.0
#include "quadtune/synthesis/pid/pid_cascade.hpp"

#include <gmock/gmock.h>

#include <Eigen/Eigenvalues>
#include <cmath>

#include "quadtune/control/cascade_law.hpp"
#include "quadtune/errors.hpp"

namespace quadtune {
namespace {

using ::testing::HasSubstr;
using ::testing::IsEmpty;

/// The Mambo at hover, derived by hand: order of ned_convention(), inputs T, tau_x, tau_y, tau_z.
ContinuousLti mambo_hover() {
  ContinuousLti plant;
  plant.A = Eigen::MatrixXd::Zero(12, 12);
  plant.A.block(0, 6, 3, 3).setIdentity();
  plant.A.block(3, 9, 3, 3).setIdentity();
  plant.A(6, 4) = -9.81;
  plant.A(7, 3) = 9.81;
  plant.B = Eigen::MatrixXd::Zero(12, 4);
  plant.B(8, 0) = -1 / 0.063;
  plant.B(9, 1) = 1 / 5.82857e-5;
  plant.B(10, 2) = 1 / 7.16914e-5;
  plant.B(11, 3) = 1 / 1.0e-4;
  return plant;
}

/// Table 3.3 of the Mambo thesis.
CascadeGains thesis() {
  CascadeGains gains;
  gains.dt = 0.005;
  const double K[6][3] = {{-0.24, 0, 0.1},      {0.24, 0, -0.1},     {0.013, 0.01, -0.002},
                          {0.01, 0.01, -0.003}, {0.004, 0, -0.0012}, {0.8, 0.1, -0.5}};
  for (const CascadeAxis axis : kAllCascadeAxes) {
    PidLoop loop = cascade_loop(axis);
    loop.Kp = K[index_of(axis)][0];
    loop.Ki = K[index_of(axis)][1];
    loop.Kd = K[index_of(axis)][2];
    gains.loops.push_back(loop);
  }
  return gains;
}

CascadeVehicle mambo() {
  CascadeVehicle vehicle;
  vehicle.hover = mambo_hover();
  vehicle.authority << 0.58, 0.0273, 0.0273, 1.49e-3;
  return vehicle;
}

CascadeSpecification every(double dt) {
  CascadeSpecification specification;
  specification.dt = dt;
  return specification;
}

double radius(const PidCascade& cascade) { return cascade.poles.cwiseAbs().maxCoeff(); }

TEST(PidCascade, ImprovesAllMetricsOfTheThesis) {
  CascadeVehicle vehicle = mambo();
  vehicle.published = thesis();
  const PidCascade cascade = pid_cascade(vehicle, every(0.005));
  ASSERT_TRUE(cascade.solved()) << cascade.failed().design;
  ASSERT_EQ(cascade.loops.size(), kCascadeAxes);
  EXPECT_LT(radius(cascade), 1);
  EXPECT_THAT(cascade.notes, IsEmpty());
  for (const CascadeAxisDesign& loop : cascade.loops) {
    const CascadeLoopEvidence& here = loop.design.evidence;
    const CascadeLoopEvidence& there = loop.published_evidence;
    EXPECT_LT(here.margins.Ms, there.margins.Ms) << to_string(loop.axis);
    EXPECT_LT(here.load_integral, there.load_integral) << to_string(loop.axis);
    EXPECT_LE(here.load_peak, there.load_peak * (1 + 1e-6)) << to_string(loop.axis);
    EXPECT_LE(here.load_steady_state, there.load_steady_state) << to_string(loop.axis);
    EXPECT_LE(here.value_noise, there.value_noise * (1 + 1e-6)) << to_string(loop.axis);
    EXPECT_LE(here.rate_noise, there.rate_noise * (1 + 1e-6)) << to_string(loop.axis);
  }
}

TEST(PidCascade, WritesTheSignsOfTheThesis) {
  const PidCascade cascade = pid_cascade(mambo(), every(0.005));
  ASSERT_TRUE(cascade.solved());
  const CascadeGains published = thesis();
  for (std::size_t i = 0; i < kCascadeAxes; ++i) {
    const PidLoop& here = cascade.gains.loops[i];
    const PidLoop& there = published.loops[i];
    EXPECT_EQ(here.name, there.name);
    EXPECT_GT(here.Kp * there.Kp, 0) << here.name;
    EXPECT_GT(here.Ki * there.Kp, 0) << here.name;
    EXPECT_GT(here.Kd * there.Kd, 0) << here.name;
  }
}

/// The published evidence of an axis equals that of the complete vehicle with all axes closed.
TEST(PidCascade, LoopsMatchTheCompleteVehicle) {
  CascadeVehicle vehicle = mambo();
  vehicle.published = thesis();
  const PidCascade cascade = pid_cascade(vehicle, every(0.005));
  const OpenLoop whole(
      cut_at_inputs(cascade.plant, cascade_law(thesis(), PidMethod::forward_euler)));
  for (const CascadeAxisDesign& loop : cascade.loops) {
    if (loop.axis == CascadeAxis::yaw) {
      const LoopMargins margins = loop_margins(whole.channel(3));
      EXPECT_NEAR(margins.Ms, loop.published_evidence.margins.Ms, 1e-6);
    }
    if (loop.axis == CascadeAxis::altitude) {
      const LoopMargins margins = loop_margins(whole.channel(0));
      EXPECT_NEAR(margins.phase_margin, loop.published_evidence.margins.phase_margin, 1e-6);
      EXPECT_NEAR(margins.crossover, loop.published_evidence.margins.crossover, 1e-6);
    }
  }
}

TEST(PidCascade, StabilizesVehiclesWithLagDelayAndOtherPeriods) {
  for (const double dt : {0.002, 0.02})
    for (const double lag : {0.0, 0.05})
      for (const double delay : {0.0, 1.4}) {
        CascadeVehicle vehicle = mambo();
        vehicle.lag = lag;
        CascadeSpecification specification = every(dt);
        specification.delay.fill(delay * dt);
        specification.delay[index_of(CascadeAxis::x)] = 4 * delay * dt;
        specification.method = delay > 1 ? PidMethod::tustin : PidMethod::backward_euler;
        const PidCascade cascade = pid_cascade(vehicle, specification);
        ASSERT_TRUE(cascade.solved())
            << dt << " " << lag << " " << delay << " " << to_string(cascade.failed().axis) << " "
            << cascade.failed().design;
        EXPECT_LT(radius(cascade), 1) << dt << " " << lag << " " << delay;
        for (const CascadeAxisDesign& loop : cascade.loops)
          EXPECT_LE(loop.design.evidence.margins.Ms, 1.4 + 1e-6);
      }
}

/// The vehicle becomes unstable at the delay margin, according to a second method for delays.
TEST(PidCascade, BecomesUnstableAtTheDelayMargin) {
  const PidCascade cascade = pid_cascade(mambo(), every(0.005));
  ASSERT_TRUE(cascade.solved());
  const DiscreteLti law = cascade_law(cascade.gains, PidMethod::forward_euler);
  for (const CascadeAxisDesign& loop : cascade.loops) {
    if (loop.axis != CascadeAxis::yaw && loop.axis != CascadeAxis::altitude) continue;
    for (const double share : {0.99, 1.01}) {
      CascadeSpecification late = every(0.005);
      late.delay[index_of(loop.axis)] = share * loop.design.evidence.margins.delay_margin;
      const DiscreteLti closed = closed_loop(sampled_hover(mambo(), late), law);
      const double r = closed.A.eigenvalues().cwiseAbs().maxCoeff();
      EXPECT_EQ(r < 1, share < 1) << to_string(loop.axis) << " " << share << " " << r;
    }
  }
}

/// Trimmed rotor speeds are equal up to rounding: roll and pitch rates are coupled by 1e-16.
TEST(PidCascade, IsInsensitiveToRounding) {
  CascadeVehicle vehicle = mambo();
  CascadeSpecification late = every(0.005);
  late.delay.fill(0.0135);
  late.delay[index_of(CascadeAxis::x)] = 0.05;
  const DiscreteLti law = cascade_law(thesis(), PidMethod::forward_euler);
  const OpenLoop clean(cut_at_inputs(sampled_hover(vehicle, late), law));
  vehicle.hover.A(9, 10) = 4.65e-16;
  vehicle.hover.A(10, 9) = -3.78e-16;
  const OpenLoop rounded(cut_at_inputs(sampled_hover(vehicle, late), law));
  for (Eigen::Index i = 0; i < 4; ++i) {
    const LoopMargins here = loop_margins(rounded.channel(i));
    const LoopMargins there = loop_margins(clean.channel(i));
    EXPECT_NEAR(here.crossover, there.crossover, 1e-6 * there.crossover) << i;
    EXPECT_NEAR(here.phase_margin, there.phase_margin, 1e-6) << i;
    EXPECT_NEAR(here.gain_margin, there.gain_margin, 1e-6 * there.gain_margin) << i;
  }
}

TEST(PidCascade, AssessesWrittenGains) {
  CascadeVehicle vehicle = mambo();
  vehicle.published = thesis();
  const PidCascade designed = pid_cascade(vehicle, every(0.005));
  const PidCascade written = assess_cascade(mambo(), every(0.005), thesis());
  ASSERT_EQ(written.loops.size(), kCascadeAxes);
  for (std::size_t i = 0; i < kCascadeAxes; ++i) {
    const CascadeLoopEvidence& here = written.loops[i].design.evidence;
    const CascadeLoopEvidence& there = designed.loops[i].published_evidence;
    EXPECT_EQ(here.margins.Ms, there.margins.Ms);
    EXPECT_EQ(here.load_peak, there.load_peak);
  }
  EXPECT_LT(radius(written), 1);
  CascadeGains incomplete = thesis();
  incomplete.loops.pop_back();
  EXPECT_THROW((void)assess_cascade(mambo(), every(0.005), incomplete), InvalidInput);
}

TEST(PidCascade, OmitsIntegrals) {
  CascadeSpecification specification = every(0.005);
  for (CascadeRequirement& requirement : specification.requirements) requirement.integral = false;
  specification.requirements[index_of(CascadeAxis::altitude)].integral = true;
  const PidCascade cascade = pid_cascade(mambo(), specification);
  ASSERT_TRUE(cascade.solved());
  for (const PidLoop& loop : cascade.gains.loops)
    EXPECT_EQ(loop.Ki != 0, loop.name == "altitude") << loop.name;
}

TEST(PidCascade, NamesTheInfeasibleLoop) {
  CascadeSpecification specification = every(0.005);
  specification.requirements[index_of(CascadeAxis::y)].bandwidth = 40;
  const PidCascade cascade = pid_cascade(mambo(), specification);
  EXPECT_FALSE(cascade.solved());
  EXPECT_EQ(cascade.failed().axis, CascadeAxis::y);
  EXPECT_EQ(cascade.failed().design.status, CascadeLoopStatus::crossover_infeasible);
  EXPECT_GT(cascade.failed().design.highest_rate_crossover, 1);
  EXPECT_LT(cascade.failed().design.highest_rate_crossover, 40);
}

TEST(PidCascade, NotesCoupledAxes) {
  CascadeVehicle vehicle = mambo();
  vehicle.hover.B(9, 2) = 0.1 * vehicle.hover.B(9, 1);
  const PidCascade cascade = pid_cascade(vehicle, every(0.005));
  ASSERT_TRUE(cascade.solved());
  ASSERT_EQ(cascade.notes.size(), 1U);
  EXPECT_THAT(cascade.notes[0], HasSubstr("coupled"));
}

TEST(PidCascade, Refuses) {
  CascadeVehicle vehicle = mambo();
  vehicle.hover.B(11, 3) = 0;
  EXPECT_THROW((void)pid_cascade(vehicle, every(0.005)), InvalidInput);
  vehicle = mambo();
  vehicle.lag = -1;
  EXPECT_THROW((void)pid_cascade(vehicle, every(0.005)), InvalidInput);
  EXPECT_THROW((void)pid_cascade(mambo(), every(0)), InvalidInput);
  vehicle = mambo();
  vehicle.hover.B = Eigen::MatrixXd(vehicle.hover.B.leftCols(3));
  EXPECT_THROW((void)pid_cascade(vehicle, every(0.005)), InvalidInput);
}

}  // namespace
}  // namespace quadtune
