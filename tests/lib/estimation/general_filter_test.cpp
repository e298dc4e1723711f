// SPDX-License-Identifier: Apache-2.0
#include "quadtune/estimation/general_filter.hpp"

#include <gmock/gmock.h>

#include <Eigen/Eigenvalues>
#include <array>
#include <cmath>
#include <functional>
#include <limits>
#include <random>

#include "matrix_near.hpp"
#include "numbers.hpp"
#include "pack_functions.hpp"
#include "quadtune/errors.hpp"
#include "quadtune/model/vehicle.hpp"

namespace quadtune {
namespace {

using Eigen::Matrix3d;
using Eigen::Vector3d;
using ::testing::HasSubstr;
using testing::lane_of;
using testing::MatrixNear;
using ::testing::StrEq;
using ::testing::ThrowsMessage;
namespace filter_internal = general_filter_internal;
using FilterState = GeneralFilterState<double>;
using Frame = SensorFrame<double>;
using Vector12 = StateVector<double>;
using Matrix16 = Eigen::Matrix<double, kErrorStates, kErrorStates>;
using Vector16 = Eigen::Matrix<double, kErrorStates, 1>;
using testing::kNaN;
constexpr double kG = 9.81;
const Vector3d kField(20, 3, 43);  // µT

Matrix16 dense(const SymmetricMatrix<double, kErrorStates>& P) {
  Matrix16 result;
  for (int i = 0; i < kErrorStates; ++i)
    for (int j = 0; j < kErrorStates; ++j) result(i, j) = P(i, j);
  return result;
}

template <class Random>
Vector3d random_vector(Random& random, double size) {
  std::normal_distribution<double> normal;
  return Vector3d(normal(random), normal(random), normal(random)) * size;
}

template <class Random>
SymmetricMatrix<double, kErrorStates> random_covariance(Random& random) {
  std::normal_distribution<double> normal;
  Matrix16 root;
  for (Eigen::Index i = 0; i < root.size(); ++i) root(i) = normal(random);
  const Matrix16 P = root * root.transpose();
  SymmetricMatrix<double, kErrorStates> result;
  for (int i = 0; i < kErrorStates; ++i)
    for (int j = 0; j <= i; ++j) result(i, j) = P(i, j);
  return result;
}

/// All sensors, without lags.
Sensors all_sensors() {
  Sensors sensors = typical_sensors();
  SensorFaults images;
  images.rate = 20;
  images.noise.setConstant(0.02);
  sensors.vision = images;
  return sensors;
}

GeneralFilterSettings settings_of(const Sensors& sensors) {
  return general_filter_settings(sensors, 0.005, kG, kField);
}

/// What perfect sensors say in a motion; nothing is fresh but gyroscope and accelerometer.
Frame perfect(const Vector12& x, const Vector3d& force) {
  const Matrix3d R = rotation_of_euler(x(3), x(4), x(5));
  const Vector3d v = x.segment<3>(6), w = x.tail<3>(), d = R.row(2);
  const double h = -x(2), a = std::pow(std::tan(0.4), 2) / 3, b = std::pow(std::tan(0.3), 2) / 3;
  Frame frame;
  frame.specific_force = {force, true, 0};
  frame.rates = {w, true, 0};
  frame.magnetic_field = {R.transpose() * kField, false, 0};
  frame.pressure = {barometric_pressure(h, 101325.0), false, 0};
  frame.sonar = {h / d.z(), false, 0};
  frame.flow = {{(v.z() * d.x() * a - v.x() * d.z()) / h - w.y() * (1 + a),
                 (v.z() * d.y() * b - v.y() * d.z()) / h + w.x() * (1 + b)},
                false,
                0};
  frame.gps_position = {x.head<3>(), false, 0};
  frame.gps_velocity = {R * v, false, 0};
  frame.vision = {x.head<3>(), false, 0};
  return frame;
}

Frame resting(const Vector12& x) {
  return perfect(x, rotation_of_euler(x(3), x(4), x(5)).transpose() * Vector3d(0, 0, -kG));
}

void set_fresh(Frame& frame, bool fresh) {
  frame.magnetic_field.fresh = frame.pressure.fresh = frame.sonar.fresh = frame.flow.fresh = fresh;
  frame.gps_position.fresh = frame.gps_velocity.fresh = frame.vision.fresh = fresh;
}

Vector12 hovering() {
  Vector12 x = Vector12::Zero();
  x(2) = -2;
  return x;
}

/// A state with errors in every part.
FilterState moved(const FilterState& from, const Vector16& dx) {
  FilterState state = from;
  filter_internal::Correction<double> correction;
  for (int i = 0; i < kErrorStates; ++i) correction.errors[static_cast<std::size_t>(i)] = dx(i);
  correction.any_used = true;
  filter_internal::apply(correction, state);
  return state;
}

/// The error of b relative to a, in the filter's coordinates.
Vector16 difference(const FilterState& a, const FilterState& b) {
  const auto q = [](const FilterState& s) {
    const auto& v = s.motion.attitude;
    return Eigen::Quaterniond(v(0), v(1), v(2), v(3));
  };
  Vector16 d;
  d << b.motion.position - a.motion.position, b.motion.velocity - a.motion.velocity,
      2 * (q(b) * q(a).conjugate()).vec(), b.gyro_bias - a.gyro_bias, b.force_bias - a.force_bias,
      b.pressure_height - a.pressure_height;
  return d;
}

/// A state that moves in all directions, and readings in its history.
FilterState lively(const GeneralFilterSettings& settings, std::mt19937_64& random) {
  Vector12 x;
  x << random_vector(random, 1), 0.3, -0.2, 2.5, random_vector(random, 1), random_vector(random, 1);
  x(2) = -2;
  FilterState state = general_filter_start(settings, x);
  state.gyro_bias = random_vector(random, 0.02);
  state.force_bias = random_vector(random, 0.2);
  for (auto& reading : state.readings.values) {
    reading.rates = random_vector(random, 1);
    reading.force = Vector3d(0, 0, -kG) + random_vector(random, 2);
  }
  return state;
}

// F from differences of the motion itself: the errors before and after one period.
TEST(GeneralFilter, SpreadsTheCovarianceByTheMotionsOwnDerivative) {
  std::mt19937_64 random(3);
  GeneralFilterSettings settings = settings_of(all_sensors());
  const FilterState start = lively(settings, random);
  const filter_internal::ReadingPlace place;
  const auto after = [&](const Vector16& dx) {
    FilterState state = moved(start, dx);
    const filter_internal::Inputs<double> in = filter_internal::inputs_at(state, place, place, 0);
    filter_internal::move<double>(state.motion, in.rates * settings.dt, in.force, kG, settings.dt);
    return state;
  };
  Matrix16 F;
  const double step = 1e-6;
  for (int i = 0; i < kErrorStates; ++i)
    F.col(i) =
        difference(after(-step * Vector16::Unit(i)), after(step * Vector16::Unit(i))) / (2 * step);
  FilterState state = start;
  state.P = random_covariance(random);
  const Matrix16 expected = F * dense(state.P) * F.transpose();
  const filter_internal::Inputs<double> in = filter_internal::inputs_at(state, place, place, 0);
  const Eigen::Vector4d middle = filter_internal::product<double>(
      state.motion.attitude, filter_internal::small_rotation<double>(in.rates * settings.dt / 2));
  const Matrix3d R = filter_internal::rotation(middle);
  filter_internal::spread<double>(state.P, R, R * in.force * settings.dt, settings.dt);
  // The filter's F leaves out terms of dt²/2, 1e-4 of force times its turn.
  EXPECT_THAT(dense(state.P), MatrixNear(expected, 3e-3));
  Matrix16 blocks = Matrix16::Identity();
  blocks.block<3, 3>(0, 3).diagonal().setConstant(settings.dt);
  const Vector3d a = R * in.force * settings.dt;
  blocks.block<3, 3>(3, 6) << 0, a.z(), -a.y(), -a.z(), 0, a.x(), a.y(), -a.x(), 0;
  blocks.block<3, 3>(3, 12) = -R * settings.dt;
  blocks.block<3, 3>(6, 9) = -R * settings.dt;
  EXPECT_THAT(blocks, MatrixNear(F, 3e-4));
  state.P = random_covariance(random);
  const Matrix16 exact = blocks * dense(state.P) * blocks.transpose();
  filter_internal::spread<double>(state.P, R, a, settings.dt);
  EXPECT_THAT(dense(state.P), MatrixNear(exact, 1e-12));
}

// Forward through the readings and back again.
TEST(GeneralFilter, RunsBackwardToWhereItWas) {
  std::mt19937_64 random(4);
  GeneralFilterSettings settings = settings_of(all_sensors());
  settings.gyroscope.lag = 0.007;
  settings.accelerometer.lag = 0.0135;  // each with its own place among the readings
  FilterState state = lively(settings, random);
  const int horizon = horizon_periods(settings);
  EXPECT_EQ(horizon, 3);
  const filter_internal::ReadingPlace gyro = filter_internal::reading_place(0.007, 0.005, horizon),
                                      force =
                                          filter_internal::reading_place(0.0135, 0.005, horizon);
  EXPECT_EQ(gyro.whole, 1);
  EXPECT_NEAR(gyro.part, 0.6, 1e-12);
  EXPECT_EQ(force.whole, 0);
  EXPECT_NEAR(force.part, 0.3, 1e-12);
  std::vector<Motion9<double>> motions;
  const Frame none;
  for (int k = 0; k < 45; ++k) {
    Frame frame;
    frame.rates = {random_vector(random, 1), true, 0};
    frame.specific_force = {Vector3d(0, 0, -kG) + random_vector(random, 2), true, 0};
    (void)step(settings, state, frame, false);
    motions.insert(motions.begin(), state.motion);
  }
  for (const int periods : {1, 7, 40}) {
    const auto past =
        filter_internal::past_motion<double>(settings, state, gyro, force, periods * settings.dt);
    const auto& was = motions[static_cast<std::size_t>(periods)];
    EXPECT_THAT(past.motion.position, MatrixNear(was.position, 1e-12)) << periods;
    EXPECT_THAT(past.motion.velocity, MatrixNear(was.velocity, 1e-12)) << periods;
    EXPECT_THAT(past.motion.attitude, MatrixNear(was.attitude, 1e-9)) << periods;
  }
  // A fraction lies between.
  const auto half =
      filter_internal::past_motion<double>(settings, state, gyro, force, 2.5 * settings.dt);
  EXPECT_THAT(half.motion.position,
              MatrixNear(Vector3d((motions[2].position + motions[3].position) / 2), 1e-3));
}

TEST(GeneralFilter, CarriesRowsBackAsDifferencesDo) {
  std::mt19937_64 random(5);
  const GeneralFilterSettings settings = settings_of(all_sensors());
  const FilterState state = lively(settings, random);
  const filter_internal::ReadingPlace place;
  for (const double ago : {0.0013, 0.02, 0.1372}) {
    const auto values = [&](const Vector16& dx) {
      const FilterState other = moved(state, dx);
      const auto past = filter_internal::past_motion<double>(settings, other, place, place, ago);
      FilterState then = other;
      then.motion = past.motion;
      return then;
    };
    Matrix16 slopes;
    const double step = 1e-5;
    for (int i = 0; i < kErrorStates; ++i)
      slopes.col(i) =
          difference(values(-step * Vector16::Unit(i)), values(step * Vector16::Unit(i))) /
          (2 * step);
    const auto past = filter_internal::past_motion<double>(settings, state, place, place, ago);
    for (int part = 0; part < 9; ++part) {
      filter_internal::Row<double> row;
      (part < 3 ? row.position : part < 6 ? row.velocity : row.turn)(part % 3) = 1;
      filter_internal::carry(past, row);
      Vector16 c;
      c << row.position, row.velocity, row.turn, row.gyro, row.force, row.pressure;
      EXPECT_THAT(c, MatrixNear(Vector16(slopes.row(part)), 3e-2 * ago + 1e-6))
          << "error " << part << ", " << ago << " s ago";
    }
  }
}

TEST(GeneralFilter, CorrectsAsTheTextbook) {
  std::mt19937_64 random(6);
  const GeneralFilterSettings settings = settings_of(all_sensors());
  for (int round = 0; round < 20; ++round) {
    FilterState state = lively(settings, random);
    state.P = random_covariance(random);
    filter_internal::Row<double> row;
    row.velocity = random_vector(random, 1);
    row.turn = random_vector(random, 1);
    Vector16 c = Vector16::Zero();
    c.segment<3>(3) = row.velocity;
    c.segment<3>(6) = row.turn;
    const Matrix16 P = dense(state.P);
    const double R = 0.3, e = 0.7, S = c.dot(P * c) + R;
    const Vector16 K = P * c / S;
    const Matrix16 I = Matrix16::Identity();
    const Matrix16 expected =
        (I - K * c.transpose()) * P * (I - K * c.transpose()).transpose() + K * R * K.transpose();
    filter_internal::Correction<double> correction;
    Estimate<double> seen;
    bool used = false;
    filter_internal::correct<filter_internal::kV | filter_internal::kTurn>(
        settings, state, row, e, R, true, 0, 3, correction, seen, used);
    EXPECT_TRUE(used);
    EXPECT_NEAR(seen.innovation_square, e * e / S, 1e-14);
    EXPECT_EQ(seen.innovation_freedom, 1);
    EXPECT_THAT(dense(state.P), MatrixNear(expected, 1e-12 * P.norm()));
    EXPECT_THAT(Vector16(Eigen::Map<Vector16>(correction.errors.data())),
                MatrixNear(Vector16(K * e), 1e-12));
  }
}

// Each sensor's row: what it says of a state with an error, less what it says of the state.
TEST(GeneralFilter, LinearizesEverySensor) {
  std::mt19937_64 random(7);
  GeneralFilterSettings all = settings_of(all_sensors());
  all.gate = 1e12;
  const auto only = [&](int which) {
    GeneralFilterSettings settings = all;
    if (which != 0) settings.flow.reset();
    if (which != 1) settings.range.reset();
    if (which != 2) settings.pressure.reset();
    if (which != 3) settings.heading.reset();
    if (which != 4) settings.gps_position.reset();
    if (which != 5) settings.gps_velocity.reset();
    if (which != 6) settings.vision.reset();
    return settings;
  };
  for (int which = 0; which < 7; ++which)
    for (const double ago : {0.0, 0.012}) {
      GeneralFilterSettings settings = only(which);
      for (Aid* aid : {settings.range ? &settings.range->aid : nullptr,
                       settings.pressure ? &settings.pressure->aid : nullptr,
                       settings.heading ? &settings.heading->aid : nullptr,
                       settings.gps_position ? &*settings.gps_position : nullptr,
                       settings.gps_velocity ? &*settings.gps_velocity : nullptr,
                       settings.vision ? &*settings.vision : nullptr})
        if (aid) aid->variance = 1e-12;
      if (settings.flow) settings.flow->variance = 1e-12;
      settings.gyroscope.variance.setConstant(1e-14);
      FilterState believed = general_filter_start(settings, hovering());
      believed = lively(settings, random);
      believed.P = random_covariance(random);
      // A true state within a tiny error that a perfect measurement must take out of its row.
      std::normal_distribution<double> normal;
      Vector16 dx;
      for (int i = 0; i < kErrorStates; ++i) dx(i) = 1e-4 * normal(random);
      const FilterState true_state = moved(believed, dx);
      const filter_internal::ReadingPlace place;
      const auto past =
          filter_internal::past_motion<double>(settings, true_state, place, place, ago);
      Vector12 x;
      const Matrix3d R = filter_internal::rotation(past.motion.attitude);
      x << past.motion.position, euler_of_rotation<double>(R), R.transpose() * past.motion.velocity,
          past.rates;
      Frame frame = perfect(x, Vector3d::Zero());
      frame.pressure.value = barometric_pressure(-x(2) + true_state.pressure_height, 101325.0);
      set_fresh(frame, true);
      for (double* age :
           {&frame.flow.age, &frame.sonar.age, &frame.pressure.age, &frame.magnetic_field.age,
            &frame.gps_position.age, &frame.gps_velocity.age, &frame.vision.age})
        *age = ago;
      // The innovation after the correction is of second order.
      const auto innovation = [&](FilterState state) {
        Estimate<double> seen;
        state.P.entries.fill(0);
        const filter_internal::Period<double> period = {settings, state, place, place, 0, seen};
        if (settings.flow) filter_internal::use_flow<double>(period, {frame.flow.value, ago, true});
        if (settings.range)
          filter_internal::use_range<double>(period, {frame.sonar.value, ago, true});
        if (settings.pressure)
          filter_internal::use_pressure<double>(period, {frame.pressure.value, ago, true});
        if (settings.heading)
          filter_internal::use_heading<double>(period, {frame.magnetic_field.value, ago, true});
        if (settings.gps_position)
          filter_internal::use_vector<filter_internal::kP, double>(
              period, *settings.gps_position, {frame.gps_position.value, ago, true},
              Scalar::gps_position);
        if (settings.gps_velocity)
          filter_internal::use_vector<filter_internal::kV, double>(
              period, *settings.gps_velocity, {frame.gps_velocity.value, ago, true},
              Scalar::gps_velocity);
        if (settings.vision)
          filter_internal::use_vector<filter_internal::kP, double>(
              period, *settings.vision, {frame.vision.value, ago, true}, Scalar::vision);
        return std::sqrt(seen.innovation_square * 1e-12);  // of P = 0: |e|
      };
      FilterState corrected = believed;
      Estimate<double> seen;
      const filter_internal::Period<double> period = {settings, corrected, place, place, 0, seen};
      if (settings.flow) filter_internal::use_flow<double>(period, {frame.flow.value, ago, true});
      if (settings.range)
        filter_internal::use_range<double>(period, {frame.sonar.value, ago, true});
      if (settings.pressure)
        filter_internal::use_pressure<double>(period, {frame.pressure.value, ago, true});
      if (settings.heading)
        filter_internal::use_heading<double>(period, {frame.magnetic_field.value, ago, true});
      if (settings.gps_position)
        filter_internal::use_vector<filter_internal::kP, double>(
            period, *settings.gps_position, {frame.gps_position.value, ago, true},
            Scalar::gps_position);
      if (settings.gps_velocity)
        filter_internal::use_vector<filter_internal::kV, double>(
            period, *settings.gps_velocity, {frame.gps_velocity.value, ago, true},
            Scalar::gps_velocity);
      if (settings.vision)
        filter_internal::use_vector<filter_internal::kP, double>(
            period, *settings.vision, {frame.vision.value, ago, true}, Scalar::vision);
      const double before = innovation(believed), after = innovation(corrected);
      EXPECT_GT(before, 1e-5) << which;
      EXPECT_LT(after, 2e-3 * before) << "sensor " << which << ", " << ago << " s ago";
    }
}

// A random walk that is measured in every period: the steady variance m before a measurement solves
// m² - q m - q R = 0.
TEST(GeneralFilter, SettlesAtTheRiccatiEquationsSolution) {
  Sensors sensors = typical_sensors();
  sensors.flow.reset();
  sensors.sonar.reset();
  sensors.magnetometer.reset();
  sensors.gps.reset();
  GeneralFilterSettings settings = settings_of(sensors);
  // The position is known: what is left is the barometer's offset.
  settings.start = {};
  settings.start.position = settings.start.velocity = settings.start.tilt = settings.start.yaw = 0;
  settings.start.gyro_bias = settings.start.force_bias = 0;
  settings.gyroscope.density.setZero();
  settings.accelerometer.density.setZero();
  settings.gyroscope.walk = settings.accelerometer.walk = 0;
  settings.pressure->walk = 0.05;
  FilterState state = general_filter_start(settings, hovering());
  Frame frame = resting(hovering());
  frame.pressure.fresh = true;
  for (int k = 0; k < 20000; ++k) (void)step(settings, state, frame, false);
  const double q = 0.05 * 0.05 * 0.005, R = settings.pressure->aid.variance;
  const double m = q / 2 + std::sqrt(q * q / 4 + q * R);
  EXPECT_NEAR(state.P(kErrorPressureHeight, kErrorPressureHeight), m * R / (m + R), 1e-12);
}

// One axis with acceleration noise and a position in every period: the two by two Riccati equation,
// iterated by itself.
TEST(GeneralFilter, IsTheFilterOfADoubleIntegratorAlongAnAxis) {
  Sensors sensors = typical_sensors();
  sensors.flow.reset();
  sensors.sonar.reset();
  sensors.magnetometer.reset();
  sensors.barometer.reset();
  sensors.gps.reset();
  SensorFaults images;
  images.rate = 200;
  images.noise.setConstant(0.02);
  sensors.vision = images;
  GeneralFilterSettings settings = settings_of(sensors);
  settings.start.tilt = settings.start.yaw = settings.start.gyro_bias = 0;
  settings.start.force_bias = 0;
  settings.gyroscope.density.setZero();
  settings.gyroscope.walk = settings.accelerometer.walk = 0;
  FilterState state = general_filter_start(settings, hovering());
  Frame frame = resting(hovering());
  frame.vision.fresh = true;
  Eigen::Matrix2d P = Eigen::Vector2d(1e-4, 1e-4).asDiagonal(), F;
  F << 1, 0.005, 0, 1;
  const Eigen::Matrix2d Q =
      Eigen::Vector2d(0, std::pow(settings.accelerometer.density.x(), 2) * 0.005).asDiagonal();
  const double R = settings.vision->variance;
  for (int k = 0; k < 5000; ++k) {
    (void)step(settings, state, frame, false);
    P = (F * P * F.transpose() + Q).eval();
    P -= (P.col(0) * P.row(0) / (P(0, 0) + R)).eval();
  }
  for (int axis = 0; axis < 3; ++axis) {
    EXPECT_NEAR(state.P(axis, axis), P(0, 0), 1e-9 * P(0, 0));
    EXPECT_NEAR(state.P(3 + axis, axis), P(1, 0), 1e-9 * P(1, 0));
    EXPECT_NEAR(state.P(3 + axis, 3 + axis), P(1, 1), 1e-9 * P(1, 1));
  }
}

// A fix that comes late, against the same fix in time.
TEST(GeneralFilter, UsesALateFixAsIfItHadComeInTime) {
  Sensors sensors = typical_sensors();
  sensors.flow.reset();
  sensors.sonar.reset();
  sensors.magnetometer.reset();
  sensors.barometer.reset();
  GeneralFilterSettings settings = settings_of(sensors);
  // Without noise in between the order of the corrections does not matter.
  settings.gyroscope.density.setZero();
  settings.accelerometer.density.setZero();
  settings.gyroscope.walk = settings.accelerometer.walk = 0;
  settings.start.position = 0.5;
  const auto end = [&](int late, double offset) {
    std::mt19937_64 random(8);
    FilterState state = general_filter_start(settings, hovering());
    for (int k = 0; k <= 120; ++k) {
      Frame frame = resting(hovering());
      frame.rates.value = random_vector(random, 0.3);
      frame.specific_force.value += random_vector(random, 1);
      frame.gps_position.value = Vector3d(0.1, -0.2, -2) + Vector3d(1, 2, -1) * offset;
      frame.gps_velocity.value = Vector3d(0.1, 0, 0.2) + Vector3d(1, -1, 2) * offset;
      frame.gps_position.fresh = frame.gps_velocity.fresh = k == 60 + late;
      frame.gps_position.age = frame.gps_velocity.age = late * settings.dt;
      (void)step(settings, state, frame, false);
    }
    return state;
  };
  const FilterState prompt = end(0, 0.01), base = end(0, 0);
  const Vector16 effect = difference(base, prompt);
  EXPECT_GT(effect.norm(), 1e-3);
  for (const int late : {1, 13, 40}) {
    const FilterState tardy = end(late, 0.01);
    // Equal up to the curvature over the attitude's correction.
    EXPECT_LT(difference(prompt, tardy).norm(), 2e-3) << late;
    const Matrix16 P = dense(prompt.P);
    EXPECT_LT((dense(tardy.P) - P).norm(), 5e-3 * P.norm()) << late;
    const Vector16 late_effect = difference(end(late, 0), tardy);
    EXPECT_LT((late_effect - effect).norm(), 5e-3 * effect.norm()) << late;
  }
}

// Gyroscope and accelerometer that come three periods late, everything else at once: the filter of
// the horizon is the filter of sensors in time, three periods before.
TEST(GeneralFilter, WaitsForTheInertialSensors) {
  const GeneralFilterSettings prompt = settings_of(all_sensors());
  GeneralFilterSettings late = prompt;
  late.gyroscope.lag = late.accelerometer.lag = 3 * late.dt;
  Vector12 x = hovering();
  FilterState now = general_filter_start(prompt, x), horizon = general_filter_start(late, x);
  std::mt19937_64 random(9);
  std::vector<Frame> frames;
  for (int k = 0; k < 400; ++k) {
    Frame frame = resting(x);
    frame.rates.value += random_vector(random, 0.3);
    frame.specific_force.value += random_vector(random, 1);
    set_fresh(frame, k % 7 == 0);
    frame.flow.fresh = k % 3 == 0;
    frame.flow.age = k % 2 == 0 ? 0.002 : 0;
    frame.gps_position.age = frame.gps_velocity.age = 0.1;
    frame.gps_position.value += random_vector(random, 1);
    frame.flow.value.x() += 0.1;
    frames.push_back(frame);
  }
  for (std::size_t k = 0; k < frames.size(); ++k) {
    Frame mixed = frames[k];
    if (k >= 3) {
      mixed.rates = frames[k - 3].rates;
      mixed.specific_force = frames[k - 3].specific_force;
      // What is older than the horizon is used when it comes, which is later by three periods.
      mixed.gps_position = frames[k - 3].gps_position;
      mixed.gps_velocity = frames[k - 3].gps_velocity;
      mixed.gps_position.age = mixed.gps_velocity.age = 0.1 + 3 * prompt.dt;
    } else {
      mixed.rates = {Vector3d::Zero(), true, 0};
      mixed.specific_force = {Vector3d(0, 0, -kG), true, 0};
      mixed.gps_position.fresh = mixed.gps_velocity.fresh = false;
    }
    (void)step(late, horizon, mixed, false);
    // Both begin with three periods of rest.
    Frame at_once = k >= 3 ? frames[k - 3] : mixed;
    if (k < 3) set_fresh(at_once, false);
    (void)step(prompt, now, at_once, false);
  }
  EXPECT_LT(difference(now, horizon).norm(), 1e-12);
  EXPECT_LT((dense(now.P) - dense(horizon.P)).norm(), 1e-12 * dense(now.P).norm());
}

TEST(GeneralFilter, GatesAndRecovers) {
  Sensors sensors = typical_sensors();
  sensors.flow.reset();
  sensors.barometer.reset();
  sensors.magnetometer.reset();
  GeneralFilterSettings settings = settings_of(sensors);
  FilterState state = general_filter_start(settings, hovering());
  Frame frame = resting(hovering());
  int rejected = 0, time = 0;
  for (int k = 0; k < 2000; ++k) {
    frame.sonar.fresh = k % 10 == 0;
    frame.gps_position.fresh = frame.gps_velocity.fresh = k % 200 == 0;
    // From 4 s on a table half a metre high stands below.
    frame.sonar.value = k < 800 ? 2 : 1.5;
    const Estimate<double> estimate = step(settings, state, frame, false);
    if (k >= 800 && frame.sonar.fresh && !estimate.height_used && time == 0) ++rejected;
    if (k >= 800 && estimate.height_used && time == 0) time = k;
    ASSERT_TRUE(estimate.finite);
  }
  EXPECT_GE(rejected, 3);
  // A second after the last echo that was believed.
  EXPECT_EQ(time, 790 + 200);
  EXPECT_NEAR(state.motion.position.z(), -1.5, 0.05);
  EXPECT_LT(state.motion.velocity.norm(), 0.05);
  // One wild echo changes nothing, not even a bit of the covariance.
  const FilterState before = state;
  frame.gps_position.fresh = frame.gps_velocity.fresh = false;
  frame.sonar.fresh = true;
  frame.sonar.value = 4;
  (void)step(settings, state, frame, false);
  FilterState without = before;
  frame.sonar.fresh = false;
  (void)step(settings, without, frame, false);
  EXPECT_EQ(state.P.entries, without.P.entries);
  EXPECT_EQ(state.motion.position, without.motion.position);
}

TEST(GeneralFilter, FindsItsBiasesWhileItStands) {
  Sensors sensors = load_vehicle("mambo").sensors;
  const GeneralFilterSettings settings = settings_of(sensors);
  Vector12 x = Vector12::Zero();
  x(2) = -0.03;
  FilterState state = general_filter_start(settings, x);
  std::mt19937_64 random(10);
  const Vector3d gyro(-0.0095, -0.0075, 0.0015), force(0.09, -0.06, 0.337);
  for (int k = 0; k < 100; ++k) {
    Frame frame = resting(x);
    for (int i = 0; i < 3; ++i) {
      frame.rates.value(i) = (gyro + random_vector(random, 1.5e-3))(i)*settings.gyroscope.scale(i);
      frame.specific_force.value(i) =
          (frame.specific_force.value + force +
           random_vector(random, 0.2))(i)*settings.accelerometer.scale(i);
    }
    const Estimate<double> estimate = step(settings, state, frame, true);
    EXPECT_EQ(estimate.x.tail<3>().norm(), 0);
    EXPECT_NEAR(estimate.x(2), -0.03, 1e-9);
  }
  // 1.5e-3/√100 and 0.2/√100, and what of the accelerometer's bias is taken for tilt: 0.003 g.
  EXPECT_THAT(state.gyro_bias, MatrixNear(gyro, 6e-4));
  EXPECT_THAT(state.force_bias, MatrixNear(force, 0.08));
  EXPECT_LT(state.motion.velocity.norm(), 1e-2);
  const Deviations<double> d = deviations(settings, state);
  EXPECT_LT(d.attitude(0), 0.0035);
  EXPECT_NEAR(std::sqrt(state.P(kErrorGyroBias, kErrorGyroBias)), 1.5e-4, 4e-5);
}

// Data sheets of cheap gyroscopes allow 20°/s of zero rate, far beyond what the filter starts with.
// That the vehicle stands is known, so such a reading is a bias and no outlier.
TEST(GeneralFilter, FindsALargeBiasWhileItStands) {
  const GeneralFilterSettings settings = settings_of(load_vehicle("mambo").sensors);
  const Vector12 x = Vector12::Zero();
  FilterState state = general_filter_start(settings, x);
  const Vector3d gyro(0.35, -0.2, 0.3), force(0, 0, 3);
  for (int k = 0; k < 400; ++k) {
    Frame frame = resting(x);
    frame.rates.value += gyro.cwiseProduct(settings.gyroscope.scale);
    frame.specific_force.value =
        (frame.specific_force.value + force).cwiseProduct(settings.accelerometer.scale);
    (void)step(settings, state, frame, true);
  }
  EXPECT_THAT(state.gyro_bias, MatrixNear(gyro, 2e-3));
  EXPECT_NEAR(state.force_bias(2), 3, 0.05);
}

// Samples at 300 Hz, 4 ms late, in periods of 5 ms: two are due in one period of three, and then
// the newer one counts.
TEST(GeneralFilter, UsesTheNewerOfTwoSamplesThatAreDueAtOnce) {
  using Value = double;
  struct Queue {
    std::array<Waiting<Value, double>, 8> items{};
    int newest = 0;
    Waiting<Value, double>& advance() {
      newest = (newest + 7) % 8;
      return items[static_cast<std::size_t>(newest)];
    }
    Waiting<Value, double>& operator[](int j) {
      return items[static_cast<std::size_t>((newest + j) % 8)];
    }
  } queue;
  // The first was taken 4 ms before the period that it came in, the second 6 ms before the next.
  const double dt = 0.005;
  const auto come = [&](double value, double age) {
    return general_filter_internal::pass<Value, double>(
        queue, Sample<Value, double>{value, true, age}, true, 0, dt, 1);
  };
  (void)come(1, 0.004);
  const general_filter_internal::Due<Value, double> due = come(2, 0.006);
  ASSERT_TRUE(due.due);
  EXPECT_EQ(due.value, 2);
}

/// The springs of the landing gear push upwards at lift-off: the vertical velocity is uncertain,
/// the horizontal one is known from standing still.
TEST(GeneralFilter, ExpectsAPushAtLiftOff) {
  GeneralFilterSettings settings = settings_of(load_vehicle("mambo").sensors);
  const Vector12 x = Vector12::Zero();
  const auto stood = [&] {
    FilterState state = general_filter_start(settings, x);
    for (int k = 0; k < 200; ++k) (void)step(settings, state, resting(x), true);
    return state;
  };
  const FilterState pushed = stood();
  const auto deviation = [](const FilterState& state, int axis) {
    return std::sqrt(state.P(kErrorVelocity + axis, kErrorVelocity + axis));
  };
  EXPECT_EQ(deviation(pushed, 2), settings.lift_off_velocity);
  EXPECT_LT(deviation(pushed, 0), 0.005);
  settings.lift_off_velocity = 0;
  const FilterState soft = stood();
  EXPECT_LT(deviation(soft, 2), 0.005);
  EXPECT_EQ(deviation(soft, 0), deviation(pushed, 0));
}

TEST(GeneralFilter, IsNotPoisonedBySensors) {
  const GeneralFilterSettings settings = settings_of(all_sensors());
  FilterState state = general_filter_start(settings, hovering());
  FilterState without = state;
  Frame bad;
  const Vector3d nothing = Vector3d::Constant(kNaN);
  const double infinity = std::numeric_limits<double>::infinity();
  bad.specific_force = {nothing, true, 0};
  bad.rates = {{0, infinity, 0}, true, 0};
  bad.magnetic_field = {Vector3d::Zero(), true, 0};
  bad.pressure = {-1, true, 0};
  bad.sonar = {kNaN, true, 0};
  bad.flow = {{kNaN, 0}, true, 0};
  bad.gps_position = {nothing, true, 0};
  bad.gps_velocity = {{0, 0, infinity}, true, 0};
  bad.vision = {nothing, true, 0};
  for (int k = 0; k < 1000; ++k) {
    const Estimate<double> estimate = step(settings, state, bad, false);
    ASSERT_TRUE(estimate.finite) << k;
    EXPECT_EQ(estimate.innovation_freedom, 0);
    (void)step(settings, without, Frame(), false);
  }
  EXPECT_EQ(state.P.entries, without.P.entries);
  EXPECT_EQ(state.motion.attitude, without.motion.attitude);
}

// Without a sensor of the heading nothing may be learned of it, however noisy the sensors and
// however the estimated velocity jumps.
TEST(GeneralFilter, LearnsNoHeadingFromNoise) {
  Sensors sensors = typical_sensors();
  sensors.gps.reset();
  sensors.magnetometer.reset();
  GeneralFilterSettings settings = settings_of(sensors);
  settings.start.yaw = 0.1;
  settings.start.gyro_bias = 0;
  settings.gyroscope.walk = 0;
  const double density = 1e-4;  // the same about every axis: it has no direction
  settings.gyroscope.density.setConstant(density);
  FilterState state = general_filter_start(settings, hovering());
  const Frame rest = resting(hovering());
  std::mt19937_64 random(21);
  std::normal_distribution<double> normal;
  constexpr int kPeriods = 20000;
  for (int k = 0; k < kPeriods; ++k) {
    Frame frame = rest;
    frame.specific_force.value += random_vector(random, 0.5);
    frame.rates.value += random_vector(random, density / std::sqrt(settings.dt));
    frame.flow.fresh = k % 2 == 0;
    frame.flow.value += random_vector(random, 0.1).head<2>();
    frame.sonar.fresh = frame.pressure.fresh = k % 4 == 0;
    frame.sonar.value += 0.01 * normal(random);
    (void)step(settings, state, frame, false);
  }
  const double time = kPeriods * settings.dt;
  // A tilt that is not quite known turns a little of the vertical noise into what flow can see.
  EXPECT_NEAR(state.P(kErrorTurn + 2, kErrorTurn + 2), 0.1 * 0.1 + density * density * time,
              1e-3 * density * density * time);
}

TEST(GeneralFilter, LastsAnHourWithoutPosition) {
  Sensors sensors = typical_sensors();
  sensors.gps.reset();
  sensors.magnetometer.reset();
  sensors.sonar.reset();
  sensors.barometer.reset();
  sensors.flow.reset();
  const GeneralFilterSettings settings = settings_of(sensors);
  auto state = general_filter_start<float>(settings, hovering().cast<float>());
  SensorFrame<float> frame;
  frame.specific_force = {{0, 0, -9.81F}, true, 0};
  frame.rates = {{0, 0, 0.5F}, true, 0};
  Estimate<float> estimate;
  for (int k = 0; k < 720000; ++k) estimate = step(settings, state, frame, false);
  EXPECT_TRUE(estimate.finite);
  for (int i = 0; i < kErrorStates; ++i) EXPECT_TRUE(std::isfinite(state.P(i, i)));
  EXPECT_NEAR(estimate.x(5), 1800, 1);  // the yaw is counted through its turns
  const Deviations<float> d = deviations(settings, state);
  EXPECT_TRUE(d.position.allFinite());
  EXPECT_GT(d.position.x(), 10);
}

TEST(GeneralFilter, StaysPositiveInSinglePrecision) {
  GeneralFilterSettings settings = settings_of(all_sensors());
  settings.start.position = 100;
  settings.start.velocity = 10;
  settings.start.yaw = 1;
  auto state = general_filter_start<float>(settings, hovering().cast<float>());
  std::mt19937_64 random(11);
  for (int k = 0; k < 20000; ++k) {
    const Frame perfect = resting(hovering());
    SensorFrame<float> frame;
    frame.specific_force = {perfect.specific_force.value.cast<float>(), true, 0};
    frame.rates = {(random_vector(random, 0.01)).cast<float>(), true, 0};
    frame.magnetic_field = {perfect.magnetic_field.value.cast<float>(), k % 2 == 0, 0};
    frame.pressure = {static_cast<float>(perfect.pressure.value), k % 4 == 0, 0};
    frame.sonar = {2, k % 10 == 0, 0};
    frame.flow = {perfect.flow.value.cast<float>(), k % 3 == 0, 0.001F};
    frame.gps_position = {perfect.gps_position.value.cast<float>(), k % 200 == 0, 0.2F};
    frame.gps_velocity = {Eigen::Vector3f::Zero(), k % 200 == 0, 0.2F};
    frame.vision = {perfect.vision.value.cast<float>(), k % 10 == 0, 0.06F};
    ASSERT_TRUE(step(settings, state, frame, false).finite) << k;
    if (k % 1000 == 0) {
      Matrix16 P;
      for (int i = 0; i < kErrorStates; ++i)
        for (int j = 0; j < kErrorStates; ++j) P(i, j) = state.P(i, j);
      const Vector16 scale = P.diagonal().cwiseSqrt().cwiseInverse();
      ASSERT_TRUE(scale.allFinite()) << k;
      const Matrix16 correlation = scale.asDiagonal() * P * scale.asDiagonal();
      const Eigen::SelfAdjointEigenSolver<Matrix16> eigen(correlation);
      EXPECT_GT(eigen.eigenvalues()(0), -1e-5) << k;
    }
  }
}

TEST(GeneralFilter, LanesDoNotDependOnEachOtherAndFloatFollows) {
  using P4 = Pack<4>;
  using P1 = Pack<1>;
  Sensors sensors = all_sensors();
  sensors.gyroscope->delay = 0.005;
  sensors.gyroscope->natural_frequency = 190;
  const GeneralFilterSettings settings = settings_of(sensors);
  const Vector12 x = hovering();
  auto together = general_filter_start<P4>(settings, x.cast<P4>());
  std::array<GeneralFilterState<P1>, 4> alone;
  alone.fill(general_filter_start<P1>(settings, x.cast<P1>()));
  FilterState exact = general_filter_start<double>(settings, x);
  auto rough = general_filter_start<float>(settings, x.cast<float>());
  std::mt19937_64 random(12);
  const auto put = [](auto& sample, int l, const auto& from) {
    for (int i = 0; i < from.value.size(); ++i) set_lane(sample.value(i), l, from.value(i));
    set_lane(sample.fresh, l, from.fresh);
    set_lane(sample.age, l, from.age);
  };
  const auto put_scalar = [](auto& sample, int l, const auto& from) {
    set_lane(sample.value, l, from.value);
    set_lane(sample.fresh, l, from.fresh);
    set_lane(sample.age, l, from.age);
  };
  const auto put_all = [&](auto& frame, int l, const Frame& from) {
    put(frame.specific_force, l, from.specific_force);
    put(frame.rates, l, from.rates);
    put(frame.magnetic_field, l, from.magnetic_field);
    put_scalar(frame.pressure, l, from.pressure);
    put_scalar(frame.sonar, l, from.sonar);
    put(frame.flow, l, from.flow);
    put(frame.gps_position, l, from.gps_position);
    put(frame.gps_velocity, l, from.gps_velocity);
    put(frame.vision, l, from.vision);
  };
  for (int k = 0; k < 500; ++k) {
    SensorFrame<P4> frames;
    Mask<4> standing;
    std::array<Frame, 4> frame;
    for (int l = 0; l < 4; ++l) {
      Frame& f = frame[static_cast<std::size_t>(l)] = resting(x);
      f.rates.value += random_vector(random, 0.02);
      f.specific_force.value += random_vector(random, 0.2);
      f.magnetic_field.value += random_vector(random, 1);
      f.flow.value += random_vector(random, 0.02).head<2>();
      f.sonar.value += random_vector(random, k % 50 == l ? 3 : 0.01).x();
      f.gps_position.value += random_vector(random, 0.5);
      f.vision.value += random_vector(random, 0.02);
      f.magnetic_field.fresh = (k + l) % 3 == 0;
      f.pressure.fresh = (k + l) % 4 == 0;
      f.sonar.fresh = (k + l) % 5 == 0;
      f.flow.fresh = (k + l) % 3 == 1;
      f.flow.age = 0.001 * ((k + l) % 7);
      f.gps_position.fresh = f.gps_velocity.fresh = (k + 20 * l) % 100 == 10;
      f.gps_position.age = f.gps_velocity.age = 0.1;
      f.vision.fresh = (k + l) % 10 == 0;
      f.vision.age = 0.033;
      f.rates.fresh = (k + l) % 11 != 0;
      set_lane(standing, l, k < 15 * l);
      put_all(frames, l, f);
    }
    const Estimate<P4> estimate = step(settings, together, frames, standing);
    for (int l = 0; l < 4; ++l) {
      const auto i = static_cast<std::size_t>(l);
      SensorFrame<P1> one;
      put_all(one, 0, frame[i]);
      const Estimate<P1> lonely = step(settings, alone[i], one, Mask<1>(lane(standing, l)));
      ASSERT_EQ(lane_of(estimate.x, l), lane_of(lonely.x, 0)) << "period " << k << " lane " << l;
      for (std::size_t e = 0; e < together.P.entries.size(); ++e)
        ASSERT_EQ(lane(together.P.entries[e], l), lane(alone[i].P.entries[e], 0)) << e;
      ASSERT_EQ(lane(estimate.innovation_square, l), lane(lonely.innovation_square, 0));
    }
    SensorFrame<float> coarse;
    const auto copy = [](auto& sample, const auto& from) {
      sample.value = from.value.template cast<float>();
      sample.fresh = from.fresh;
      sample.age = static_cast<float>(from.age);
    };
    const Frame& f = frame[0];
    copy(coarse.specific_force, f.specific_force);
    copy(coarse.rates, f.rates);
    copy(coarse.magnetic_field, f.magnetic_field);
    copy(coarse.flow, f.flow);
    copy(coarse.gps_position, f.gps_position);
    copy(coarse.gps_velocity, f.gps_velocity);
    copy(coarse.vision, f.vision);
    coarse.pressure = {static_cast<float>(f.pressure.value), f.pressure.fresh,
                       static_cast<float>(f.pressure.age)};
    coarse.sonar = {static_cast<float>(f.sonar.value), f.sonar.fresh,
                    static_cast<float>(f.sonar.age)};
    const Estimate<float> single = step(settings, rough, coarse, false);
    const Estimate<double> plain = step(settings, exact, f, false);
    ASSERT_THAT(single.x.cast<double>(), MatrixNear(plain.x, 5e-3)) << "period " << k;
    ASSERT_THAT(lane_of(estimate.x, 0), MatrixNear(plain.x, 1e-9)) << "period " << k;
  }
}

TEST(GeneralFilter, TakesItsNumbersFromTheSensors) {
  const GeneralFilterSettings mambo =
      general_filter_settings(load_vehicle("mambo").sensors, 0.005, kG, kField);
  EXPECT_NEAR(mambo.gyroscope.lag, 0.005 + 2 * 0.707 / 190, 1e-12);
  EXPECT_EQ(horizon_periods(mambo), 3);
  EXPECT_NEAR(mambo.range->aid.variance, 1e-4, 1e-12);
  EXPECT_NEAR(mambo.flow->variance, 1e-4, 1e-12);  // the floor: the file states none
  EXPECT_NEAR(mambo.pressure->aid.variance, std::pow(1 / 12.01725, 2), 1e-9);
  EXPECT_FALSE(mambo.gps_position || mambo.heading || mambo.vision);
  Sensors rough = load_vehicle("mambo").sensors;
  rough.sonar->faults.quantum = 0.12;
  EXPECT_NEAR(settings_of(rough).range->aid.variance, 1e-4 + 0.0144 / 12, 1e-12);
}

TEST(GeneralFilter, NamesWhatASuiteLacks) {
  Sensors sensors = typical_sensors();
  EXPECT_EQ(general_filter_lacks(sensors), "");
  sensors.gps.reset();
  sensors.barometer.reset();
  EXPECT_EQ(general_filter_lacks(sensors), "");
  sensors.sonar.reset();
  EXPECT_THAT(general_filter_lacks(sensors), HasSubstr("the height is not observed"));
  sensors.flow.reset();
  EXPECT_THAT(general_filter_lacks(sensors), HasSubstr("horizontal velocity is not observed"));
  sensors.gyroscope.reset();
  EXPECT_EQ(general_filter_lacks(sensors), "no gyroscope");
  sensors.accelerometer.reset();
  EXPECT_EQ(general_filter_lacks(sensors), "no accelerometer");
}

TEST(GeneralFilter, RefusesWhatCannotRun) {
  const auto refusal = [](const std::function<void(GeneralFilterSettings&)>& change,
                          const std::string& message) {
    GeneralFilterSettings settings = settings_of(all_sensors());
    change(settings);
    EXPECT_THAT([&] { validate(settings, "filter"); },
                ThrowsMessage<InvalidInput>(StrEq("filter: " + message)));
  };
  EXPECT_NO_THROW(validate(settings_of(all_sensors()), "filter"));
  refusal([](auto& s) { s.dt = 0; }, "dt is 0 s, expected a positive number");
  refusal([](auto& s) { s.flow->variance = kNaN; },
          "flow.variance is nan rad2/s2, expected a positive number");
  refusal([](auto& s) { s.gyroscope.lag = 0.1; },
          "gyroscope.lag is 0.1 s, expected 0 to 16 control periods of 0.005 s");
  refusal([](auto& s) { s.range->max = 0; },
          "range.least is 0.03 m and range.greatest is 0 m, expected 0 <= range.least < "
          "range.greatest");
  refusal(
      [](auto& s) { s.pressure->fall = 12; },
      "pressure.fall is 12 Pa/m, expected a negative number because pressure falls with height");
  refusal([](auto& s) { s.gate = 0; }, "gate is 0, expected a positive number");
  refusal([](auto& s) { s.start.tilt = -1; },
          "start.tilt is -1 rad, expected 0 or more and finite");
  refusal([](auto& s) { s.vision->lag = -0.1; },
          "vision.lag is -0.1 s, expected 0 to 40 control periods of 0.005 s");
}

}  // namespace
}  // namespace quadtune
