// SPDX-License-Identifier: Apache-2.0
#include "quadtune/estimation/uquad_filter.hpp"

#include <ceres/jet.h>
#include <gmock/gmock.h>

#include <Eigen/Eigenvalues>
#include <Eigen/LU>
#include <array>
#include <cmath>
#include <limits>
#include <numbers>
#include <random>

#include "integrate.hpp"
#include "matrix_near.hpp"
#include "numbers.hpp"
#include "pack_functions.hpp"
#include "plants/sample_vehicles.hpp"
#include "quadtune/errors.hpp"
#include "quadtune/model/atmosphere.hpp"
#include "quadtune/model/mixer.hpp"

namespace quadtune {
namespace {

using Eigen::Vector3d;
using testing::lane_of;
using testing::MatrixNear;
using testing::plus_quadrotor;
using testing::random_state;
using testing::random_vehicle;
using ::testing::StrEq;
using ::testing::ThrowsMessage;
using UquadSettings = UquadFilterSettings<double>;
using UquadState = UquadFilterState<double>;
using Frame = SensorFrame<double>;
using Speeds = RotorSpeeds<double>;
using Vector12 = StateVector<double>;
using Vector15 = UquadVector<double>;
using Matrix15 = Eigen::Matrix<double, 15, 15>;
using testing::kNaN;
constexpr double kFilterGravity = 9.81;
constexpr double kHoverSpeed = 316.103650939028;
const Vector3d kEarthField(20, 0, 43);  // µT, north and down
constexpr double kSeaLevel = 101325;

Speeds hover() { return Speeds::Constant(4, kHoverSpeed); }

Matrix15 random_covariance_15(std::mt19937_64& random) {
  std::normal_distribution<double> normal;
  Matrix15 root;
  for (int i = 0; i < 225; ++i) root(i) = normal(random);
  return root * root.transpose();
}

/// What perfect sensors say in the state x of a body that feels the specific force f; all fresh.
Frame perfect_sensors(const Vector12& x, const Vector3d& f) {
  const Eigen::Matrix3d R = rotation_of_euler(x(3), x(4), x(5));
  Frame frame;
  frame.specific_force = {f, true, 0};
  frame.rates = {x.tail<3>(), true, 0};
  frame.magnetic_field = {R.transpose() * kEarthField, true, 0};
  frame.pressure = {barometric_pressure(-x(2), kSeaLevel), true, 0};
  frame.gps_position = {x.head<3>(), true, 0};
  frame.gps_velocity = {R * x.segment<3>(6), true, 0};
  return frame;
}

/// … at rest.
Frame resting_sensors(const Vector12& x) {
  const Eigen::Matrix3d R = rotation_of_euler(x(3), x(4), x(5));
  return perfect_sensors(x, R.transpose() * Vector3d(0, 0, -kFilterGravity));
}

void forget_gps(Frame& frame) {
  frame.gps_position.fresh = false;
  frame.gps_velocity.fresh = false;
}

Eigen::Matrix<double, 12, 12> dense_jacobian(const StateJacobian<double>& A) {
  Eigen::Matrix<double, 12, 12> M = Eigen::Matrix<double, 12, 12>::Zero();
  M.block<3, 3>(0, 3) = A.position_attitude;
  M.block<3, 3>(0, 6) = A.position_velocity;
  M.block<3, 3>(3, 3) = A.attitude_attitude;
  M.block<3, 3>(3, 9) = A.attitude_rates;
  M.block<3, 3>(6, 3) = A.velocity_attitude;
  M.block<3, 3>(6, 6) = A.velocity_velocity;
  M.block<3, 3>(6, 9) = A.velocity_rates;
  M.block<3, 3>(9, 9) = A.rates_rates;
  return M;
}

TEST(StateJacobian, EqualsThatOfJets) {
  using Jet = ceres::Jet<double, 12>;
  std::mt19937_64 random(1);
  for (int trial = 0; trial < 50; ++trial) {
    const Vehicle vehicle = random_vehicle(random, 6);
    const RigidBody body(vehicle, 0.9);
    const Vector12 x = random_state(random);
    Speeds speeds(6);
    for (int i = 0; i < 6; ++i) speeds(i) = std::uniform_real_distribution<>(50, 1000)(random);
    const RotorLoads<double> loads = rotor_loads(body, speeds);
    StateVector<Jet> xj;
    for (int i = 0; i < 12; ++i) xj(i) = Jet(x(i), i);
    RotorLoads<Jet> lj;
    lj.force = loads.force.cast<Jet>();
    lj.torque = loads.torque.cast<Jet>();
    lj.angular_momentum = loads.angular_momentum.cast<Jet>();
    const StateVector<Jet> fj = state_derivative(body, xj, lj);
    Eigen::Matrix<double, 12, 12> expected;
    for (int i = 0; i < 12; ++i) expected.row(i) = fj(i).v.transpose();
    EXPECT_THAT(dense_jacobian(state_jacobian(body, x, loads)), MatrixNear(expected, 1e-12));
  }
}

TEST(UquadFilter, PredictsByThePhysicsAndItsJacobian) {
  std::mt19937_64 random(2);
  const RigidBody body(random_vehicle(random, 4));
  const UquadSettings settings = uquad_filter_in_si<double>();
  for (int trial = 0; trial < 20; ++trial) {
    const RotorLoads<double> loads = rotor_loads<double>(body, Speeds::Constant(4, 400));
    KalmanState<double, 15> kalman;
    const Vector12 x = random_state(random);
    kalman.x << x, 0.1, 0.2, 0.3;
    const Matrix15 P = kalman.P = random_covariance_15(random);
    Matrix15 F = Matrix15::Identity();
    F.topLeftCorner<12, 12>() += 0.01 * dense_jacobian(state_jacobian(body, x, loads));
    predict(settings, kalman, body, loads, false);
    Vector15 expected;
    expected << x + 0.01 * state_derivative(body, x, loads), 0.1, 0.2, 0.3;
    EXPECT_THAT(kalman.x, MatrixNear(expected, 1e-13));
    EXPECT_THAT(
        kalman.P,
        MatrixNear(Matrix15(F * P * F.transpose() + Matrix15(settings.Q.asDiagonal())), 1e-11));
    KalmanState<double, 15> standing;
    standing.x << x, 0.1, 0.2, 0.3;
    standing.P = P;
    predict(settings, standing, body, loads, true);
    EXPECT_THAT(standing.x, MatrixNear(Vector15(standing.x), 0));
    EXPECT_EQ(standing.x.head<12>(), x);
    EXPECT_THAT(standing.P, MatrixNear(Matrix15(P + Matrix15(settings.Q.asDiagonal())), 1e-13));
  }
}

/// The measurement that the state implies, by the physics.
template <class T>
Eigen::Matrix<T, 16, 1> expected_measurement(const RigidBody& body, const UquadVector<T>& x,
                                             const RotorLoads<T>& loads) {
  const Vector3<T> v = x.template segment<3>(6);
  const Matrix3<T> R = rotation_of_euler<T>(x(3), x(4), x(5));
  const Vector3<T> force = (loads.force + drag_force(body, v)) * T(1 / body.mass);
  Eigen::Matrix<T, 16, 1> h;
  h << x(3), x(4), x(5), force + x.template tail<3>(), x.template segment<3>(9), -x(2),
      x.template head<3>(), R * v;
  return h;
}

// Each group of scalars, one after the other, is the textbook's correction by all of it at once.
TEST(UquadFilter, CorrectsAsAllAtOnce) {
  using Jet = ceres::Jet<double, 15>;
  std::mt19937_64 random(3);
  const RigidBody body(random_vehicle(random, 4));
  const RotorLoads<double> loads = rotor_loads<double>(body, Speeds::Constant(4, 400));
  UquadSettings settings = uquad_filter_in_si<double>();
  const double R_of[] = {0.25, 0.25, 0.05, 0.1, 0.1, 0.1, 4e-4, 4e-4,
                         4e-4, 0.25, 1,    1,   1,   0.1, 0.1,  0.1};
  for (int group = 0; group < 3; ++group) {
    KalmanState<double, 15> kalman;
    kalman.x << random_state(random), 0.1, -0.2, 0.3;
    const Vector15 x = kalman.x;
    const Matrix15 P = kalman.P = random_covariance_15(random);
    UquadVector<Jet> xj;
    for (int i = 0; i < 15; ++i) xj(i) = Jet(x(i), i);
    RotorLoads<Jet> lj;
    lj.force = loads.force.cast<Jet>();
    const Eigen::Matrix<Jet, 16, 1> hj = expected_measurement<Jet>(body, xj, lj);

    std::vector<int> rows;  // linear ones together, specific force, velocity
    if (group == 0) rows = {0, 1, 2, 6, 7, 8, 9, 10, 11, 12};
    if (group == 1) rows = {3, 4, 5};
    if (group == 2) rows = {13, 14, 15};
    const auto n = static_cast<Eigen::Index>(rows.size());
    Eigen::MatrixXd C(n, 15);
    Eigen::VectorXd e(n);
    Eigen::MatrixXd R = Eigen::MatrixXd::Zero(n, n);
    Eigen::Matrix<double, 16, 1> y;
    for (int i = 0; i < 16; ++i) y(i) = hj(i).a + std::uniform_real_distribution<>(-1, 1)(random);
    for (Eigen::Index i = 0; i < n; ++i) {
      C.row(i) = hj(rows[i]).v.transpose();
      e(i) = y(rows[i]) - hj(rows[i]).a;
      R(i, i) = R_of[rows[i]];
    }
    const Eigen::MatrixXd S = C * P * C.transpose() + R;
    const Eigen::MatrixXd K = P * C.transpose() * S.inverse();

    UquadMeasurement<double> m;
    m.tilt = {y(0), y(1)};
    m.yaw = y(2) + 4 * std::numbers::pi;  // in another turn
    m.force = y.segment<3>(3);
    m.rates = y.segment<3>(6);
    m.height = y(9);
    m.gps_position = y.segment<3>(10);
    m.gps_velocity = y.tail<3>();
    m.tilt_fresh = m.yaw_fresh = m.rates_fresh = m.height_fresh = m.gps_position_fresh = group == 0;
    m.force_fresh = group == 1;
    m.gps_velocity_fresh = group == 2;
    Estimate<double> seen;
    EXPECT_EQ(correct(settings, kalman, body, loads, m, seen), group != 1);
    EXPECT_THAT(kalman.x, MatrixNear(Vector15(x + K * e), 1e-9));
    EXPECT_THAT(kalman.P, MatrixNear(Matrix15(P - K * C * P), 1e-9));
    EXPECT_NEAR(seen.innovation_square, e.dot(S.inverse() * e), 1e-8);
    EXPECT_EQ(seen.innovation_freedom, static_cast<double>(n));
    EXPECT_EQ(seen.height_used, group == 0);
  }
}

// On flights of its own model with its own noises, the errors are as large as the filter says: the
// normalized squares of the errors of 15 states over 60 flights, and of all innovations, lie within
// four standard deviations of what chi-square promises.
TEST(UquadFilter, KnowsHowWrongItIs) {
  const RigidBody body(plus_quadrotor());
  UquadSettings settings = uquad_filter_in_si<double>();
  settings.Q = uquad_variances<double>(1e-6, 1e-8, 1e-4, 1e-4, 1e-5);
  settings.R_tilt = 0.01;
  settings.dynamic_covariance = false;
  std::mt19937_64 random(4);
  std::normal_distribution<double> normal;
  const auto noise = [&](double variance) { return std::sqrt(variance) * normal(random); };
  const auto noises = [&](double variance) {
    return Vector3d(noise(variance), noise(variance), noise(variance));
  };
  constexpr int kFlights = 60;
  double squares = 0;
  double innovations = 0;
  double freedom = 0;
  for (int flight = 0; flight < kFlights; ++flight) {
    Vector12 start = Vector12::Zero();
    start(2) = -10;
    start(5) = 0.1 * flight;
    UquadState state = uquad_filter_start(settings, start);
    Vector15 truth = state.kalman.x;
    for (int i = 0; i < 15; ++i) truth(i) += noise(settings.P0(i));
    for (int k = 1; k <= 150; ++k) {
      Speeds speeds = hover();
      for (int i = 0; i < 4; ++i) speeds(i) += 3 * std::sin(0.05 * k + i);
      const RotorLoads<double> loads = rotor_loads(body, speeds);
      truth.head<12>() += 0.01 * state_derivative(body, Vector12(truth.head<12>()), loads);
      for (int i = 0; i < 15; ++i) truth(i) += noise(settings.Q(i));

      const Eigen::Matrix<double, 16, 1> y = expected_measurement(body, truth, loads);
      UquadMeasurement<double> m;
      m.tilt = {y(0) + noise(settings.R_tilt), y(1) + noise(settings.R_tilt)};
      m.yaw = wrap_angle(y(2) + noise(settings.R_yaw));
      m.force = y.segment<3>(3) + noises(settings.R_force);
      m.rates = y.segment<3>(6) + noises(settings.R_rates);
      m.height = y(9) + noise(settings.R_height);
      m.gps_position = y.segment<3>(10) + noises(settings.R_gps_position);
      m.gps_velocity = y.tail<3>() + noises(settings.R_gps_velocity);
      m.tilt_fresh = m.yaw_fresh = m.force_fresh = m.rates_fresh = true;
      m.height_fresh = k % 4 == 0;
      m.gps_position_fresh = m.gps_velocity_fresh = k % 100 == 50;
      Estimate<double> seen;
      predict(settings, state.kalman, body, loads, false);
      correct(settings, state.kalman, body, loads, m, seen);
      innovations += seen.innovation_square;
      freedom += seen.innovation_freedom;
    }
    const Vector15 error = state.kalman.x - truth;
    squares += error.dot(state.kalman.P.ldlt().solve(error));
  }
  EXPECT_NEAR(squares, 15 * kFlights, 4 * std::sqrt(2.0 * 15 * kFlights));
  EXPECT_NEAR(innovations, freedom, 4 * std::sqrt(2 * freedom));
}

TEST(UquadFilter, HoversWhereItWasPut) {
  const RigidBody body(plus_quadrotor());
  Vector12 x = Vector12::Zero();
  x(0) = 5;
  x(2) = -20;
  x(5) = 7;
  for (const UquadSettings& settings : {UquadSettings(), uquad_filter_in_si<double>()}) {
    UquadState state = uquad_filter_start(settings, x);
    for (int k = 0; k < 500; ++k) {
      const Estimate<double> estimate =
          step(settings, state, resting_sensors(x), body, hover(), false);
      ASSERT_THAT(estimate.x, MatrixNear(x, 1e-9));
      ASSERT_TRUE(estimate.finite && estimate.height_used);
      ASSERT_EQ(estimate.innovation_freedom, 16);
    }
  }
}

TEST(UquadFilter, FindsTheAccelerometersBias) {
  const RigidBody body(plus_quadrotor());
  Vector12 x = Vector12::Zero();
  x(2) = -3;
  const Vector3d bias(0.2, -0.1, 0.3);
  for (const UquadSettings& settings : {UquadSettings(), uquad_filter_in_si<double>()}) {
    UquadState state = uquad_filter_start(settings, x);
    Estimate<double> estimate;
    for (int k = 0; k < 6000; ++k) {
      Frame frame = resting_sensors(x);
      frame.specific_force.value += bias;
      estimate = step(settings, state, frame, body, hover(), false);
    }
    EXPECT_THAT(state.kalman.x.tail<3>(), MatrixNear(bias, 1e-3));
    EXPECT_THAT(estimate.x, MatrixNear(x, 1e-3));
    // Without them, and without GPS to say that it does not slide, the tilt is wrong by bias/g.
    UquadSettings without = settings;
    without.biases = false;
    without.position = false;
    UquadState plain = uquad_filter_start(without, x);
    for (int k = 0; k < 6000; ++k) {
      Frame frame = resting_sensors(x);
      frame.specific_force.value += bias;
      estimate = step(without, plain, frame, body, hover(), false);
    }
    EXPECT_EQ(plain.kalman.x.tail<3>(), Vector3d::Zero());
    EXPECT_EQ(plain.kalman.P.bottomRows<3>().norm(), 0);
    const Tilt<double> wrong = tilt_from_force<double>(Vector3d(0, 0, -kFilterGravity) + bias);
    EXPECT_NEAR(estimate.x(3), wrong.roll, 1e-3);
    EXPECT_NEAR(estimate.x(4), wrong.pitch, 1e-3);
  }
}

/// Root mean squares of the errors over a simulated flight in circles of 2 m, turning, with noisy
/// sensors and biases, held by a law that knows the truth.
struct FlightErrors {
  double tilt = 0;      ///< [rad]
  double yaw = 0;       ///< [rad]
  double position = 0;  ///< horizontal [m]
};

FlightErrors fly_circles(const UquadSettings& settings) {
  const Vehicle vehicle = plus_quadrotor();
  const RigidBody body(vehicle);
  std::mt19937_64 random(5);
  std::normal_distribution<double> normal;
  const auto noise = [&](double sigma) {
    return Vector3d(sigma * normal(random), sigma * normal(random), sigma * normal(random));
  };
  Vector12 x = Vector12::Zero();
  x(2) = -5;
  UquadState state = uquad_filter_start(settings, x);
  FlightErrors sum;
  constexpr int kPeriods = 4000;
  constexpr int kSkipped = 1000;
  for (int k = 0; k < kPeriods; ++k) {
    const double t = 0.01 * k;
    Eigen::Matrix3d R = rotation_of_euler(x(3), x(4), x(5));
    const Vector3d to_go = Vector3d(2 * std::sin(t), 2 - 2 * std::cos(t), -5) - x.head<3>();
    const Vector3d too_slow = Vector3d(2 * std::cos(t), 2 * std::sin(t), 0) - R * x.segment<3>(6);
    const Vector3d thrust = 1.5 * to_go + 2.2 * too_slow - Vector3d(0, 0, kFilterGravity);
    const Vector3d level = Eigen::AngleAxisd(-x(5), Vector3d::UnitZ()) * thrust;
    const double pitch = std::atan2(-level.x(), -level.z());
    const double roll = std::atan2(level.y() * std::cos(pitch), -level.z());
    const Vector3d turn(64 * (roll - x(3)) - 14 * x(9), 64 * (pitch - x(4)) - 14 * x(10),
                        16 * (0.3 * t - x(5)) - 6 * (x(11) - 0.3));
    Eigen::Vector4d wrench;
    wrench << vehicle.mass * thrust.norm(), vehicle.inertia * turn;
    const Speeds speeds = speeds_for_wrench(vehicle, wrench).w;
    const RotorLoads<double> loads = rotor_loads(body, speeds);
    x = testing::integrate(
        [&](const Vector12& y) { return Vector12(state_derivative(body, y, loads)); }, x, 0.005, 2);

    Frame frame =
        perfect_sensors(x, loads.force / body.mass + Vector3d(0.2, -0.1, 0.3) + noise(0.2));
    frame.rates.value += noise(0.01);
    frame.magnetic_field.value += noise(1);
    frame.pressure.value += 4 * normal(random);
    frame.pressure.fresh = k % 4 == 0;
    frame.gps_position.value += noise(1);
    frame.gps_velocity.value += noise(0.2);
    frame.gps_position.fresh = frame.gps_velocity.fresh = k % 100 == 0;
    const Vector12 error = step(settings, state, frame, body, speeds, false).x - x;
    if (k < kSkipped) continue;
    sum.tilt += error.segment<2>(3).squaredNorm() / (kPeriods - kSkipped);
    sum.yaw += error(5) * error(5) / (kPeriods - kSkipped);
    sum.position += error.head<2>().squaredNorm() / (kPeriods - kSkipped);
  }
  return {std::sqrt(sum.tilt), std::sqrt(sum.yaw), std::sqrt(sum.position)};
}

// The tilt flown is 0.26 rad. Measured when this was written: 0.004 rad, 0.007 rad, 0.7 m.
TEST(UquadFilter, FollowsAFlightInCircles) {
  const FlightErrors errors = fly_circles(uquad_filter_in_si<double>());
  EXPECT_LT(errors.tilt, 0.01);
  EXPECT_LT(errors.yaw, 0.02);
  EXPECT_LT(errors.position, 1.5);
}

// The published variances take for the tilt what the accelerometer says, and a body that is carried
// by its thrust alone feels none: the error is the tilt.
TEST(UquadFilter, PublishedVariancesAreBlindToTheTiltOfAFlight) {
  EXPECT_NEAR(fly_circles(UquadSettings()).tilt, 0.26, 0.05);
}

TEST(UquadFilter, TurnsTheFieldLevelByTheTiltAskedFor) {
  UquadSettings settings;
  Vector12 x = Vector12::Zero();
  x.segment<3>(3) << 0.3, -0.2, 1;
  UquadState state = uquad_filter_start(settings, x);
  const Frame flying = perfect_sensors(x, Vector3d(0, 0, -kFilterGravity));  // as if it were level
  EXPECT_GT(std::abs(uquad_measurement(settings, state, flying, kFilterGravity).yaw - 1), 0.1);
  EXPECT_NEAR(uquad_measurement(settings, state, resting_sensors(x), kFilterGravity).yaw, 1, 1e-12);
  settings.yaw_by_estimated_tilt = true;
  EXPECT_NEAR(uquad_measurement(settings, state, flying, kFilterGravity).yaw, 1, 1e-12);
}

TEST(UquadFilter, CountsTurnsOfYaw) {
  const RigidBody body(plus_quadrotor());
  for (const UquadSettings& settings : {UquadSettings(), uquad_filter_in_si<double>()})
    for (const double rate : {1.5, -1.5}) {
      Vector12 x = Vector12::Zero();
      x(2) = -3;
      x(11) = rate;
      UquadState state = uquad_filter_start(settings, x);
      Estimate<double> estimate;
      for (int k = 1; k <= 2000; ++k) {
        x(5) = rate * 0.01 * k;  // nearly five turns
        estimate = step(settings, state, resting_sensors(x), body, hover(), false);
      }
      EXPECT_NEAR(estimate.x(5), rate * 20, 1e-6);
    }
}

TEST(UquadFilter, DoubtsForcesAndFieldsOfTheWrongLength) {
  UquadSettings settings;
  settings.field_norm = kEarthField.norm();
  Vector12 x = Vector12::Zero();
  UquadState state = uquad_filter_start(settings, x);
  Frame frame = resting_sensors(x);
  frame.specific_force.value *= 1.2;
  frame.magnetic_field.value *= 0.7;
  UquadMeasurement<double> m = uquad_measurement(settings, state, frame, kFilterGravity);
  EXPECT_EQ(m.tilt_variance_factor, 1);
  EXPECT_EQ(m.yaw_variance_factor, 1);
  settings.dynamic_covariance = true;
  m = uquad_measurement(settings, state, frame, kFilterGravity);
  EXPECT_NEAR(m.tilt_variance_factor, 5, 1e-12);  // 1 + (0.2/0.1)²
  EXPECT_NEAR(m.yaw_variance_factor, 14, 1e-12);  // + (0.3/0.1)²
  // And the filter hears it: a doubted tilt moves the state less.
  const RigidBody body(plus_quadrotor());
  m.tilt = {0.1, 0};
  double moved[2];
  for (const bool doubted : {false, true}) {
    UquadState s = uquad_filter_start(settings, x);
    m.tilt_variance_factor = doubted ? 5 : 1;
    m.force_fresh = m.rates_fresh = m.height_fresh = m.yaw_fresh = m.gps_position_fresh =
        m.gps_velocity_fresh = false;
    Estimate<double> seen;
    correct(settings, s.kalman, body, RotorLoads<double>(), m, seen);
    moved[doubted] = s.kalman.x(3);
  }
  EXPECT_NEAR(moved[0], 0.1 / 11, 1e-12);  // P0 = 1, R = 10
  EXPECT_NEAR(moved[1], 0.1 / 51, 1e-12);
}

TEST(UquadFilter, IsEightStatesWithoutPosition) {
  const RigidBody body(plus_quadrotor());
  UquadSettings settings;
  settings.position = false;
  settings.biases = false;  // a tilt that stands still would be taken for one
  Vector12 x = Vector12::Zero();
  x(0) = 4;
  x(2) = -3;
  x(3) = 0.05;
  UquadState state = uquad_filter_start(settings, x);
  Estimate<double> estimate;
  Matrix15 early;
  for (int k = 0; k < 10000; ++k) {
    Frame frame = resting_sensors(x);
    frame.gps_position.value.setConstant(100);  // fresh, but nobody asked
    estimate = step(settings, state, frame, body, hover(), false);
    if (k == 1000) early = state.kalman.P;
  }
  EXPECT_EQ(estimate.x(0), 4);
  EXPECT_EQ(estimate.x(1), 0);
  EXPECT_EQ(estimate.x(6), 0);
  EXPECT_EQ(estimate.x(7), 0);
  for (const int i : {0, 1, 6, 7}) EXPECT_EQ(state.kalman.P.row(i).norm(), 0);
  EXPECT_THAT(state.kalman.P, MatrixNear(early, 1e-6 * early.norm()));  // steady
  EXPECT_NEAR(estimate.x(2), -3, 0.05);
  EXPECT_NEAR(estimate.x(3), 0.05, 1e-6);
}

TEST(UquadFilter, OutlastsALossOfGps) {
  const RigidBody body(plus_quadrotor());
  for (const UquadSettings& settings : {UquadSettings(), uquad_filter_in_si<double>()}) {
    Vector12 x = Vector12::Zero();
    x(2) = -3;
    UquadState state = uquad_filter_start(settings, x);
    Estimate<double> estimate;
    std::mt19937_64 random(8);
    std::normal_distribution<double> normal;
    for (int k = 0; k < 30000; ++k) {
      Frame frame = resting_sensors(x);
      for (int i = 0; i < 3; ++i) frame.specific_force.value(i) += 0.2 * normal(random);
      forget_gps(frame);
      estimate = step(settings, state, frame, body, hover(), false);
      ASSERT_TRUE(estimate.finite);
    }
    EXPECT_LT(estimate.x.segment<3>(6).norm(), 0.5);
    EXPECT_LT(estimate.x.segment<2>(3).norm(), 0.05);
    EXPECT_LT(state.kalman.P(6, 6), 101);  // at most what one period adds
    const Eigen::SelfAdjointEigenSolver<Matrix15> eigen(state.kalman.P);
    EXPECT_GT(eigen.eigenvalues()(0), 0);
    // It comes back, and is believed at once.
    x.head<2>() << 7, -4;
    for (int k = 0; k < 300; ++k) {
      Frame frame = resting_sensors(x);
      if (k % 100 != 0) forget_gps(frame);
      estimate = step(settings, state, frame, body, hover(), false);
    }
    EXPECT_THAT(estimate.x.head<2>(), MatrixNear(Eigen::Vector2d(7, -4), 0.3));
  }
}

// Images at 5 Hz that take 0.2 s to be read, of a vehicle that flies on at half a metre a second.
TEST(UquadFilter, BelievesImages) {
  const RigidBody body(plus_quadrotor());
  const UquadSettings settings = uquad_filter_in_si<double>();
  Vector12 x = Vector12::Zero();
  x(2) = -3;
  x(5) = 2;  // the heading: body and world differ
  const Vector3d velocity(0.5, -0.3, 0);
  x.segment<3>(6) = rotation_of_euler(0.0, 0.0, 2.0).transpose() * velocity;
  UquadState state = uquad_filter_start(settings, x);
  Estimate<double> estimate;
  Vector12 truth = x;
  for (int k = 0; k < 3000; ++k) {
    truth.head<3>() = x.head<3>() + k * 0.01 * velocity + Vector3d(4, -5, 0);
    Frame frame = resting_sensors(truth);
    forget_gps(frame);
    frame.vision = {truth.head<3>() - 0.2 * velocity, k % 20 == 0, 0.2};
    estimate = step(settings, state, frame, body, hover(), false);
  }
  EXPECT_THAT(estimate.x.head<3>(), MatrixNear(Vector3d(truth.head<3>()), 0.02));
  EXPECT_THAT(estimate.x.segment<3>(6), MatrixNear(Vector3d(truth.segment<3>(6)), 0.02));
  EXPECT_LT(state.gps_age, 0.3);
  Frame bad = resting_sensors(truth);
  bad.vision = {Vector3d(0, kNaN, 0), true, 0};
  EXPECT_TRUE(step(settings, state, bad, body, hover(), false).finite);
  // An image of an age that no image has changes nothing.
  for (const double age : {kNaN, -0.1, 1.1, 1e30}) {
    UquadState with_image = state;
    UquadState without = state;
    Frame frame;
    frame.vision = {Vector3d(1, 2, 3), true, age};
    step(settings, with_image, frame, body, hover(), false);
    step(settings, without, Frame(), body, hover(), false);
    EXPECT_THAT(with_image.kalman.x, MatrixNear(without.kalman.x, 0)) << age;
  }
}

TEST(UquadFilter, FindsOffsetsWhileItStands) {
  const RigidBody body(plus_quadrotor());
  UquadSettings settings;
  settings.calibration_time = 1;
  settings.declination = -0.15;
  Vector12 x = Vector12::Zero();
  x(2) = -2;
  UquadState state = uquad_filter_start(settings, x);
  Vector12 truth = x;
  truth.segment<3>(3) << 0.03, -0.02, 1.2;
  const Vector3d offset(0.02, -0.01, 0.005);
  const Eigen::Matrix3d R = rotation_of_euler(0.03, -0.02, 1.2);
  Frame frame = resting_sensors(truth);
  frame.rates.value += offset;
  frame.pressure.value = 99000;
  frame.magnetic_field.value = R.transpose() * rotation_of_euler(0.0, 0.0, -0.15) * kEarthField;
  for (int k = 0; k < 100; ++k) {
    Frame flickering = frame;
    const double flicker = k % 2 ? 1 : -1;
    flickering.rates.value.array() += 0.01 * flicker;
    flickering.pressure.value += 10 * flicker;
    const Estimate<double> estimate =
        step(settings, state, flickering, body, Speeds(Speeds::Zero(4)), true);
    ASSERT_THAT(estimate.x, MatrixNear(k < 99 ? x : truth, 1e-12));
  }
  EXPECT_THAT(state.gyro_offset, MatrixNear(offset, 1e-14));
  EXPECT_NEAR(state.pressure_zero, 99000, 1e-9);
  EXPECT_NEAR(state.field_norm, kEarthField.norm(), 1e-12);
  EXPECT_THAT(state.kalman.x.head<12>(), MatrixNear(truth, 1e-12));
  // Then it stays at rest, neither falling nor drifting.
  Estimate<double> estimate;
  for (int k = 0; k < 1000; ++k)
    estimate = step(settings, state, frame, body, Speeds(Speeds::Zero(4)), true);
  Vector12 expected = truth;
  expected.head<2>() << frame.gps_position.value.head<2>();
  EXPECT_THAT(estimate.x, MatrixNear(expected, 1e-9));
  // What the ground carries is no bias.
  EXPECT_THAT(state.kalman.x.tail<3>(), MatrixNear(Vector3d(Vector3d::Zero()), 1e-9));
}

TEST(UquadFilter, KeepsTheOffsetsThatItStartedWithWhileItStands) {
  const RigidBody body(plus_quadrotor());
  UquadSettings settings;
  settings.calibration_time = 1;
  Vector12 truth = Vector12::Zero();
  truth.segment<3>(3) << 0.03, -0.02, 0;
  const Vector3d force_offset(0.4, -0.3, 0.2);
  const Vector3d rate_offset(0.02, -0.01, 0.005);
  Frame frame = resting_sensors(truth);
  frame.specific_force.value += force_offset;
  frame.rates.value += rate_offset;
  frame.rates.fresh = false;
  UquadState state = uquad_filter_start(settings, Vector12(Vector12::Zero()));
  state.kalman.x.tail<3>() = force_offset;
  state.gyro_offset = rate_offset;
  for (int k = 0; k < 100; ++k) step(settings, state, frame, body, Speeds(Speeds::Zero(4)), true);
  // Without subtraction the roll would be wrong by 0.03 rad, without samples the offset would be 0.
  EXPECT_NEAR(state.kalman.x(3), 0.03, 1e-12);
  EXPECT_NEAR(state.kalman.x(4), -0.02, 1e-12);
  EXPECT_THAT(state.gyro_offset, MatrixNear(rate_offset, 0));
}

TEST(UquadFilter, TellsHeightFromPressure) {
  EXPECT_EQ(barometric_height(kSeaLevel, kSeaLevel), 0);
  for (const double height : {-100.0, 3.0, 1000.0}) {
    EXPECT_NEAR(barometric_height(barometric_pressure(height, kSeaLevel), kSeaLevel), height, 1e-8);
    EXPECT_NEAR(barometric_height(standard_atmosphere(height).pressure, kSeaLevel), height,
                1e-3 * std::abs(height));
  }
}

TEST(UquadFilter, IsNotPoisonedBySensors) {
  const RigidBody body(plus_quadrotor());
  const UquadSettings settings = uquad_filter_in_si<double>();
  Vector12 x = Vector12::Zero();
  x(2) = -3;
  UquadState state = uquad_filter_start(settings, x);
  for (const double bad : {kNaN, std::numeric_limits<double>::infinity()})
    for (int which = 0; which < 6; ++which) {
      Frame frame = resting_sensors(x);
      if (which == 0) frame.rates.value.y() = bad;
      if (which == 1) frame.specific_force.value.z() = bad;
      if (which == 2) frame.magnetic_field.value.x() = bad;
      if (which == 3) frame.pressure.value = bad;
      if (which == 4) frame.gps_position.value.x() = bad;
      if (which == 5) frame.gps_velocity.value.x() = bad;
      const Estimate<double> estimate = step(settings, state, frame, body, hover(), false);
      EXPECT_TRUE(estimate.finite);
      EXPECT_THAT(estimate.x, MatrixNear(x, 1e-9));
    }
  Frame frame = resting_sensors(x);
  frame.pressure.value = 0;
  EXPECT_FALSE(step(settings, state, frame, body, hover(), false).height_used);
  state.kalman.x(7) = kNaN;
  EXPECT_FALSE(step(settings, state, resting_sensors(x), body, hover(), false).finite);
}

TEST(UquadFilter, ItsGateShutsOutliersOut) {
  const RigidBody body(plus_quadrotor());
  UquadSettings settings = uquad_filter_in_si<double>();
  settings.gate = 16;
  Vector12 x = Vector12::Zero();
  x(2) = -3;
  UquadState state = uquad_filter_start(settings, x);
  for (int k = 0; k < 200; ++k) step(settings, state, resting_sensors(x), body, hover(), false);
  Frame frame = resting_sensors(x);
  frame.gps_position.value.x() += 100;
  const Estimate<double> estimate = step(settings, state, frame, body, hover(), false);
  EXPECT_EQ(estimate.innovation_freedom, 15);
  EXPECT_NEAR(estimate.x(0), 0, 1e-6);
}

// A minute of published settings in single precision: no loss of symmetry or sign.
TEST(UquadFilter, StaysPositiveInSinglePrecision) {
  const RigidBody body(plus_quadrotor());
  const UquadFilterSettings<float> settings;
  StateVector<float> x = StateVector<float>::Zero();
  x(2) = -3;
  UquadFilterState<float> state = uquad_filter_start(settings, x);
  std::mt19937_64 random(9);
  std::normal_distribution<float> normal;
  Estimate<float> estimate;
  for (int k = 0; k < 6000; ++k) {
    SensorFrame<float> frame;
    frame.specific_force = {Vector3<float>(0, 0, -9.81F), true, 0};
    for (int i = 0; i < 3; ++i) frame.specific_force.value(i) += 0.2F * normal(random);
    frame.rates = {Vector3<float>(Vector3<float>::Zero()), true, 0};
    frame.magnetic_field = {kEarthField.cast<float>(), true, 0};
    frame.pressure = {101289.0F, true, 0};
    frame.gps_position = {Vector3<float>(0, 0, -3), k % 100 == 0, 0};
    estimate = step(settings, state, frame, body,
                    RotorSpeeds<float>(RotorSpeeds<float>::Constant(4, 316.1F)), false);
    ASSERT_TRUE(estimate.finite);
  }
  EXPECT_EQ((state.kalman.P - state.kalman.P.transpose()).norm(), 0);
  const Eigen::SelfAdjointEigenSolver<Matrix15> eigen(state.kalman.P.cast<double>());
  EXPECT_GT(eigen.eigenvalues()(0), 0);
  EXPECT_LT(estimate.x.segment<3>(3).norm(), 0.1F);
}

TEST(UquadFilter, LanesDoNotDependOnEachOtherAndFloatFollows) {
  const RigidBody body(plus_quadrotor());
  const auto packed = uquad_filter_in_si<Pack<4>>();
  const auto one = uquad_filter_in_si<Pack<1>>();
  const auto plain = uquad_filter_in_si<double>();
  const auto single = uquad_filter_in_si<float>();
  Vector12 x = Vector12::Zero();
  x(2) = -3;
  auto together = uquad_filter_start<Pack<4>>(packed, x.cast<Pack<4>>());
  std::array<UquadFilterState<Pack<1>>, 4> alone;
  for (auto& state : alone) state = uquad_filter_start<Pack<1>>(one, x.cast<Pack<1>>());
  UquadState exact = uquad_filter_start(plain, x);
  auto rough = uquad_filter_start<float>(single, x.cast<float>());
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
  for (int k = 0; k < 300; ++k) {
    SensorFrame<Pack<4>> frames;
    std::array<Frame, 4> frame;
    RotorSpeeds<Pack<4>> speeds(4);
    std::array<Speeds, 4> speed;
    Mask<4> standing;
    for (int l = 0; l < 4; ++l) {
      Frame& f = frame[l] = resting_sensors(x);
      for (int i = 0; i < 3; ++i) f.rates.value(i) += 0.1 * noise(random);
      for (int i = 0; i < 3; ++i) f.specific_force.value(i) += noise(random);
      for (int i = 0; i < 3; ++i) f.magnetic_field.value(i) += 10 * noise(random);
      f.pressure.value += 50 * noise(random);
      f.pressure.fresh = (k + l) % 4 == 0;
      f.magnetic_field.fresh = (k + l) % 3 != 0;
      f.gps_position.fresh = (k + 25 * l) % 100 == 10;
      f.gps_velocity.fresh = (k + 25 * l) % 100 == 11;
      f.vision = {x.head<3>(), (k + 10 * l) % 20 == 5, 0};
      speed[l] = hover() * (1 + 0.01 * noise(random));
      set_lane(standing, l, k < 20 * l);
      put(frames.rates, l, f.rates);
      put(frames.specific_force, l, f.specific_force);
      put(frames.magnetic_field, l, f.magnetic_field);
      put(frames.gps_position, l, f.gps_position);
      put(frames.gps_velocity, l, f.gps_velocity);
      put(frames.vision, l, f.vision);
      set_lane(frames.pressure.value, l, f.pressure.value);
      set_lane(frames.pressure.fresh, l, f.pressure.fresh);
      for (int i = 0; i < 4; ++i) set_lane(speeds(i), l, speed[l](i));
    }
    const Estimate<Pack<4>> estimate = step(packed, together, frames, body, speeds, standing);
    for (int l = 0; l < 4; ++l) {
      SensorFrame<Pack<1>> f;
      put(f.rates, 0, frame[l].rates);
      put(f.specific_force, 0, frame[l].specific_force);
      put(f.magnetic_field, 0, frame[l].magnetic_field);
      put(f.gps_position, 0, frame[l].gps_position);
      put(f.gps_velocity, 0, frame[l].gps_velocity);
      put(f.vision, 0, frame[l].vision);
      f.pressure = {frame[l].pressure.value, frame[l].pressure.fresh, 0};
      RotorSpeeds<Pack<1>> s = speed[l].cast<Pack<1>>();
      const Estimate<Pack<1>> lonely = step(one, alone[l], f, body, s, Mask<1>(lane(standing, l)));
      ASSERT_EQ(lane_of(estimate.x, l), lane_of(lonely.x, 0)) << "period " << k;
      ASSERT_EQ(lane_of(together.kalman.P, l), lane_of(alone[l].kalman.P, 0));
      ASSERT_EQ(lane(estimate.innovation_square, l), lane(lonely.innovation_square, 0));
    }
    SensorFrame<float> f;
    copy(f.rates, frame[0].rates);
    copy(f.specific_force, frame[0].specific_force);
    copy(f.magnetic_field, frame[0].magnetic_field);
    copy(f.gps_position, frame[0].gps_position);
    copy(f.gps_velocity, frame[0].gps_velocity);
    copy(f.vision, frame[0].vision);
    f.pressure = {static_cast<float>(frame[0].pressure.value), frame[0].pressure.fresh, 0};
    const Estimate<float> coarse =
        step(single, rough, f, body, RotorSpeeds<float>(speed[0].cast<float>()), false);
    const Estimate<double> fine = step(plain, exact, frame[0], body, speed[0], false);
    ASSERT_THAT(coarse.x.cast<double>(), MatrixNear(fine.x, 2e-3)) << "period " << k;
  }
}

// Every setting another than its default, so that one that is forgotten shows.
TEST(UquadFilter, CastKeepsEverySetting) {
  UquadSettings settings;
  settings.dt = 0.02;
  settings.calibration_time = 2;
  settings.Q *= 2;
  settings.P0 *= 3;
  settings.R_tilt = 4;
  settings.R_yaw = 5;
  settings.R_force = 6;
  settings.R_rates = 7;
  settings.R_height = 8;
  settings.R_gps_position = 9;
  settings.R_gps_velocity = 11;
  settings.R_vision = 21;
  settings.gate = 12;
  settings.position = false;
  settings.biases = false;
  settings.yaw_by_estimated_tilt = true;
  settings.dynamic_covariance = true;
  settings.force_band = 13;
  settings.field_band = 14;
  settings.field_norm = 15;
  settings.declination = 16;
  settings.reference_pressure = 17;
  settings.gps_timeout = 18;
  settings.zero_velocity_variance = 19;
  settings.standing_variance = 20;
  EXPECT_EQ(uquad_filter_cast<double>(settings), settings);
  EXPECT_EQ(uquad_filter_cast<double>(uquad_filter_cast<float>(settings)).gate, 12);
}

TEST(UquadFilter, RefusesWhatCannotRun) {
  EXPECT_NO_THROW(validate(UquadSettings(), "filter"));
  EXPECT_NO_THROW(validate(uquad_filter_in_si<double>(), "filter"));
  EXPECT_NO_THROW(validate(UquadFilterSettings<float>(), "filter"));
  const auto refused = [](auto change, const std::string& message) {
    UquadSettings settings;
    change(settings);
    EXPECT_THAT([&] { validate(settings, "filter"); },
                ThrowsMessage<InvalidInput>(StrEq("filter: " + message)));
  };
  refused([](UquadSettings& s) { s.dt = 0; }, "dt is 0 s, expected a positive number");
  refused([](UquadSettings& s) { s.Q(4) = -1; },
          "Q(5) is -1, expected 0 or more and finite because it is a variance");
  refused([](UquadSettings& s) { s.P0(0) = kNaN; },
          "P0(1) is nan, expected 0 or more and finite because it is a variance");
  refused([](UquadSettings& s) { s.R_tilt = 0; }, "R_tilt is 0 rad2, expected a positive number");
  refused([](UquadSettings& s) { s.gate = 0; },
          "gate is 0, expected more than 0 because otherwise no measurement is accepted");
  refused([](UquadSettings& s) { s.field_band = 0; },
          "field_band is 0, expected a positive number");
  refused([](UquadSettings& s) { s.reference_pressure = 0; },
          "reference_pressure is 0 Pa, expected a positive number");
  refused([](UquadSettings& s) { s.declination = kNaN; },
          "declination is nan rad, expected a finite number");
}

}  // namespace
}  // namespace quadtune
