// SPDX-License-Identifier: Apache-2.0
#include "quadtune/synthesis/flown_axis.hpp"

#include <gmock/gmock.h>

#include <algorithm>
#include <cmath>
#include <complex>
#include <functional>
#include <random>
#include <tuple>
#include <utility>
#include <vector>

#include "matrix_near.hpp"
#include "quadtune/errors.hpp"
#include "quadtune/model/vehicle.hpp"

namespace quadtune {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;
using ::testing::HasSubstr;
using testing::MatrixNear;
using ::testing::ThrowsMessage;

FlownPlant plant_of(const Vehicle& vehicle, EstimatorKind estimator, double dt,
                    bool separate_axes = false) {
  FlightSetup setup;
  setup.vehicle = vehicle;
  setup.estimator = estimator;
  if (estimator == EstimatorKind::uquad) setup.uquad_filter = uquad_filter_in_si<double>();
  CascadeController law;
  law.gains.dt = dt;
  setup.controller = law;
  calibrate_flow(setup);
  FlownPlantOptions options;
  options.dt = dt;
  options.separate_axes = separate_axes;
  return flown_plant(setup, options);
}
FlownPlant plant_of(const std::string& name, EstimatorKind estimator, double dt = 0.005) {
  return plant_of(load_vehicle(name), estimator, dt);
}

/// Moderate gains from each state to the wrench component of its group.
MatrixXd gains_of(const Vehicle& vehicle) {
  const Eigen::Vector3d J = vehicle.inertia.diagonal();
  MatrixXd F = MatrixXd::Zero(4, 12);
  const auto set = [&](FlownAxis axis, const std::vector<double>& gains) {
    for (std::size_t j = 0; j < gains.size(); ++j)
      F(wrench_of(axis), states_of(axis)[j]) = gains[j];
  };
  set(FlownAxis::north, {-J.y(), -2 * J.y(), 16 * J.y(), 6 * J.y()});
  set(FlownAxis::east, {J.x(), 2 * J.x(), 16 * J.x(), 6 * J.x()});
  set(FlownAxis::altitude, {-4 * vehicle.mass, -4 * vehicle.mass});
  set(FlownAxis::yaw, {4 * J.z(), 4 * J.z()});
  return F;
}

std::vector<double> sizes(const PeriodicLti& plant, const MatrixXd& F) {
  PeriodicLti loop = plant;
  loop.C = F * plant.C;
  std::vector<double> result;
  for (const std::complex<double>& z : periodic_poles(closed(loop))) result.push_back(std::abs(z));
  return result;
}

/// The groups are independent: their poles are those of the whole loop.
TEST(FlownAxis, GroupsHaveThePolesOfTheWholeLoop) {
  struct Case {
    const char* vehicle;
    EstimatorKind estimator;
    double dt;
  };
  for (const Case& one :
       {Case{"mambo", EstimatorKind::mambo, 0.005}, Case{"crazyflie", EstimatorKind::mambo, 0.005},
        Case{"crazyflie", EstimatorKind::truth, 0.005},
        Case{"uquad", EstimatorKind::uquad, 0.01}}) {
    const FlownPlant plant = plant_of(one.vehicle, one.estimator, one.dt);
    const MatrixXd F = gains_of(load_vehicle(one.vehicle));
    std::vector<double> parts;
    Index states = 0;
    for (const FlownAxis axis : kFlownAxes) {
      const PeriodicLti part = axis_part(plant, axis);
      states += part.A.front().rows();
      const MatrixXd row = F(std::vector<Index>{wrench_of(axis)}, states_of(axis));
      for (const double size : sizes(part, row)) parts.push_back(size);
    }
    std::vector<double> whole = sizes(plant.plant, F);
    std::sort(parts.begin(), parts.end(), std::greater<>());
    // Only the largest poles are compared, because the poles at 0 are multiple and sensitive to
    // rounding. A state that two groups share, such as the speed of a rotor, occurs once in the
    // whole loop.
    for (std::size_t i = 0; i < 12; ++i) {
      double nearest = 1;
      for (const double size : parts) nearest = std::min(nearest, std::abs(size - whole[i]));
      EXPECT_LT(nearest, 1e-6) << one.vehicle << " " << i << ": " << whole[i];
    }
    EXPECT_NEAR(parts.front(), whole.front(), 1e-6) << one.vehicle;
    EXPECT_LT(parts.size(), 2 * whole.size());
  }
}

/// Measured vehicles are never exactly symmetric. With separate axes, each part has the states and,
/// for a small asymmetry, the poles of the symmetric vehicle; otherwise the parts contain the
/// unstable modes of other axes, which the law of one axis cannot stabilize.
TEST(FlownAxis, SeparateAxesOfAsymmetricVehicles) {
  using Change = std::function<void(Vehicle&)>;
  const auto product = [](Index i, Index j, double share) {
    return [=](Vehicle& vehicle) {
      vehicle.inertia(i, j) = vehicle.inertia(j, i) = share * vehicle.inertia(0, 0);
    };
  };
  const std::vector<std::pair<double, Change>> changes = {
      {1e-8, [](Vehicle&) {}},
      {1e-8, product(0, 2, 1e-12)},
      {1e-3, product(0, 1, 1e-4)},
      {0, product(1, 2, 0.03)},
      {2e-2, [](Vehicle& vehicle) { vehicle.rotors[0].position.x() *= 1.004; }},
      {2e-2, [](Vehicle& vehicle) { vehicle.rotors[1].thrust_a2 *= 1.004; }},
      {2e-2, [](Vehicle& vehicle) { vehicle.rotors[2].torque_d2 *= 1.004; }},
      {2e-2, [](Vehicle& vehicle) { vehicle.rotors[3].drag *= 1.1; }}};
  const Vehicle symmetric = load_vehicle("crazyflie");
  const MatrixXd F = gains_of(symmetric);
  for (const EstimatorKind estimator : {EstimatorKind::truth, EstimatorKind::general}) {
    const FlownPlant plain = plant_of(symmetric, estimator, 0.005);
    for (std::size_t i = 0; i < changes.size(); ++i) {
      Vehicle vehicle = symmetric;
      changes[i].second(vehicle);
      const FlownPlant plant = plant_of(vehicle, estimator, 0.005, true);
      for (const FlownAxis axis : kFlownAxes) {
        const PeriodicLti part = axis_part(plant, axis), expected = axis_part(plain, axis);
        ASSERT_EQ(part.A.front().rows(), expected.A.front().rows()) << i << to_string(axis);
        const MatrixXd row = F(std::vector<Index>{wrench_of(axis)}, states_of(axis));
        std::vector<double> of_part = sizes(part, row), of_expected = sizes(expected, row);
        EXPECT_LT(*std::max_element(of_part.begin(), of_part.end()), 1) << i << to_string(axis);
        std::sort(of_part.begin(), of_part.end(), std::greater<>());
        std::sort(of_expected.begin(), of_expected.end(), std::greater<>());
        for (std::size_t k = 0; changes[i].first > 0 && k < 4; ++k)
          EXPECT_NEAR(of_part[k], of_expected[k], changes[i].first) << i << to_string(axis);
      }
    }
  }
  // The complete model keeps the coupling: roll moves the yaw.
  Vehicle coupled = symmetric;
  product(0, 2, 0.03)(coupled);
  EXPECT_GT(
      axis_part(plant_of(coupled, EstimatorKind::truth, 0.005), FlownAxis::east).A.front().rows(),
      axis_part(plant_of(symmetric, EstimatorKind::truth, 0.005), FlownAxis::east)
          .A.front()
          .rows());
}

/// A magnetometer observes the heading: the plant has a steady state at any heading. The steady
/// state is periodic with the sample clocks, and the outputs are constant in every period, also if
/// samples are delayed in some periods only.
TEST(FlownAxis, RestAtIsASteadyState) {
  for (const FlownPlant& plant :
       {plant_of("uquad", EstimatorKind::uquad, 0.01), plant_of("uquad", EstimatorKind::general),
        plant_of("mambo", EstimatorKind::general)})
    for (const FlownAxis axis : {FlownAxis::altitude, FlownAxis::yaw}) {
      const PeriodicLti part = axis_part(plant, axis);
      const VectorXd start = rest_at(part, 0);
      VectorXd expected = VectorXd::Zero(part.C.rows());
      expected(0) = -1;
      VectorXd x = start;
      for (const MatrixXd& A : part.A) {
        EXPECT_THAT(part.C * x, MatrixNear(expected, 1e-9)) << to_string(axis);
        x = (A * x).eval();
      }
      EXPECT_LT((x - start).cwiseAbs().maxCoeff(), 1e-9) << to_string(axis);
    }
}

/// The cost of u = -F y after a step of the set point equals the sum over a simulated step.
TEST(FlownAxis, CostEqualsThatOfASimulatedStep) {
  const FlownPlant plant = plant_of("crazyflie", EstimatorKind::truth);
  const PeriodicLti part = axis_part(plant, FlownAxis::altitude);
  AxisWeights weights;
  weights.q = Eigen::Vector2d(16, 4);
  weights.q_integral = 2;
  weights.r = 100;
  weights.step = 0.5;
  const OutputFeedbackProblem problem = axis_problem(part, FlownAxis::altitude, weights, 1);
  const Eigen::RowVector3d F(-0.15, -0.13, -0.05);
  const OutputFeedbackCost cost = output_feedback_cost(problem, F);
  ASSERT_TRUE(cost.stable);
  VectorXd x = VectorXd::Zero(part.A[0].rows());
  double integral = 0, sum = 0;
  for (int k = 0; k < 20000; ++k) {
    const VectorXd y = part.C * x;
    const double error = y(0) - 0.5, before = integral;
    integral += part.dt * error;
    const double u = -(F(0) * error + F(1) * y(1) + F(2) * integral);
    sum += part.dt * (16 * error * error + 4 * y(1) * y(1) + 2 * before * before + 100 * u * u);
    x = (part.A[0] * x + part.B[0] * u).eval();
  }
  EXPECT_NEAR(cost.cost, sum, 1e-8 * sum);
}

MatrixXd random_matrix(std::mt19937_64& random, Index rows, Index cols) {
  std::uniform_real_distribution<double> between(-0.3, 0.3);
  return MatrixXd::NullaryExpr(rows, cols, [&] { return between(random); });
}

/// A plant of two periods with five states, an input and four outputs.
PeriodicLti random_plant(std::mt19937_64& random) {
  PeriodicLti plant;
  plant.A = {random_matrix(random, 5, 5), random_matrix(random, 5, 5)};
  plant.B = {random_matrix(random, 5, 1), random_matrix(random, 5, 1)};
  plant.C = random_matrix(random, 4, 5);
  plant.dt = 0.01;
  return plant;
}

/// A matrix law on the extended plant commands what the law with the integral and the filter does:
/// u = v + rate s on the plant, with s the sum of v, and the rate seen through its filter.
TEST(FlownAxis, TiltIntegralIsItsRecursion) {
  std::mt19937_64 random(4);
  std::uniform_real_distribution<double> between(-1, 1);
  const PeriodicLti plant = random_plant(random);
  const double rate = 20;
  const PeriodicLti extended = with_tilt_integral(plant, rate);
  ASSERT_EQ(extended.A[0].rows(), 7);
  VectorXd x = random_matrix(random, 5, 1), z = VectorXd::Zero(7);
  z.head(5) = x;
  double sum = 0, filtered = 0;
  for (std::size_t k = 0; k < 60; ++k) {
    VectorXd y = plant.C * x;
    y(3) -= rate * filtered;
    EXPECT_THAT(VectorXd(extended.C * z), MatrixNear(y, 1e-12)) << k;
    const double v = between(random), u = v + rate * sum;
    sum += plant.dt * v;
    filtered += plant.dt * y(3);
    x = (plant.A[k % 2] * x + plant.B[k % 2] * u).eval();
    z = (extended.A[k % 2] * z + extended.B[k % 2] * v).eval();
  }
}

/// The output `rate` of the extended plant is the rate with its lead.
TEST(FlownAxis, RateLeadIsItsRecursion) {
  std::mt19937_64 random(5);
  std::uniform_real_distribution<double> between(-1, 1);
  const PeriodicLti plant = random_plant(random);
  const PeriodicLti extended = with_rate_lead(plant, 3, 2.5, 0.3);
  ASSERT_EQ(extended.A[0].rows(), 6);
  VectorXd x = random_matrix(random, 5, 1), z = VectorXd::Zero(6);
  z.head(5) = x;
  double low_pass = 0;
  for (std::size_t k = 0; k < 60; ++k) {
    VectorXd y = plant.C * x;
    const double rate = y(3);
    y(3) += 2.5 * (rate - low_pass);
    EXPECT_THAT(VectorXd(extended.C * z), MatrixNear(y, 1e-12)) << k;
    low_pass += 0.3 * (rate - low_pass);
    const double u = between(random);
    x = (plant.A[k % 2] * x + plant.B[k % 2] * u).eval();
    z = (extended.A[k % 2] * z + extended.B[k % 2] * u).eval();
  }
  for (const auto& [index, gain, share] :
       {std::tuple(4, 1.0, 0.5), std::tuple(3, -1.0, 0.5), std::tuple(3, std::nan(""), 0.5),
        std::tuple(3, 1.0, 0.0), std::tuple(3, 1.0, 1.1)})
    EXPECT_THROW((void)with_rate_lead(plant, index, gain, share), InvalidInput);
}

TEST(FlownAxis, RefusesWhatDoesNotFit) {
  FlownPlant plant = plant_of("crazyflie", EstimatorKind::truth);
  const PeriodicLti part = axis_part(plant, FlownAxis::yaw);
  AxisWeights weights;
  weights.q = Eigen::Vector3d::Ones();
  EXPECT_THAT(
      [&] { (void)axis_problem(part, FlownAxis::yaw, weights, 0); },
      ThrowsMessage<InvalidInput>(HasSubstr("flown axis: there are 3 weights and 2 outputs")));
  plant.plant.inputs[0].name = "w1";
  EXPECT_THAT([&] { (void)axis_part(plant, FlownAxis::yaw); },
              ThrowsMessage<InvalidInput>(
                  HasSubstr("flown axis: the inputs or outputs of the plant are wrong")));
}

}  // namespace
}  // namespace quadtune
