// SPDX-License-Identifier: Apache-2.0
#include "quadtune/estimation/inertial_filter.hpp"

#include <fmt/format.h>

#include <Eigen/Geometry>
#include <cmath>
#include <limits>
#include <numbers>

#include "estimation/extended_run.hpp"
#include "quadtune/errors.hpp"
#include "quadtune/model/rigid_body_jacobian.hpp"

namespace quadtune {
namespace {

using Eigen::Index;
using Eigen::Matrix3d;
using Eigen::MatrixXd;
using Eigen::Vector3d;
using Eigen::VectorXd;
using internal::ExtendedMatrix;
using internal::ExtendedVector;

/// Time before the first measurement over which the accelerometer is averaged to compute the tilt
/// [s].
constexpr double kLevelling = 1;
/// Maximum step of the inertial sensors; longer ones are divided [s].
constexpr double kMaxStep = 0.02;
/// Number of candidate headings at the start, and the time over which they are compared [s].
constexpr int kHeadings = 12;
constexpr double kComparison = 30;

/// Initial variances: tilt, velocity, position, gyroscope and accelerometer biases, for a vehicle
/// that is stationary or hovers, with any sensors; kHeading covers the spacing of kHeadings
/// headings.
constexpr double kTilt = 0.01, kHeading = 0.1, kSpeed = 1, kPlace = 1e6, kGyro = 0.01, kForce = 0.1;

Matrix3d rotation(const Vector3d& turn) {
  const double angle = turn.norm();
  if (angle == 0) return Matrix3d::Identity();
  return Eigen::AngleAxisd(angle, turn / angle).toRotationMatrix();
}

/// An attitude in which a body at rest measures this force; the heading is arbitrary.
Matrix3d level(const Vector3d& force, const Vector3d& gravity) {
  return Eigen::Quaterniond::FromTwoVectors(force, -gravity).toRotationMatrix();
}

/// Errors relative to an attitude that is stored outside the state vector.
class InertialMotion {
 public:
  InertialMotion(const FilterModel& model, const Matrix3d& attitude)
      : gravity_(*model.gravity), C_(model.outputs(), kInertialStates), attitude_(attitude) {
    Index first = 0;
    for (const FilterSensor& sensor : model.sensors) {
      C_.middleRows(first, sensor.C.rows()) = sensor.C;
      first += sensor.C.rows();
    }
  }

  void move(double h, const Eigen::Ref<const VectorXd>& u, ExtendedVector& x) {
    h_ = h;
    const Vector3d turn = (u.head<3>() - x.segment<3>(kGyroOffset)) * h;
    R_ = attitude_ * rotation(0.5 * turn);  // in the middle of the step
    felt_ = R_ * (u.tail<3>() - x.segment<3>(kForceOffset));
    const Vector3d acceleration = felt_ + gravity_;
    x.segment<3>(kInertialPosition) +=
        h * (x.segment<3>(kInertialVelocity) + 0.5 * h * acceleration);
    x.segment<3>(kInertialVelocity) += h * acceleration;
    attitude_ = attitude_ * rotation(turn);
  }

  void advance(ExtendedMatrix& M) const {
    M.middleRows<3>(kInertialPosition) += h_ * M.middleRows<3>(kInertialVelocity);
    M.middleRows<3>(kInertialVelocity) -=
        h_ * (cross_matrix(felt_) * M.middleRows<3>(kInertialAttitude) +
              R_ * M.middleRows<3>(kForceOffset));
    M.middleRows<3>(kInertialAttitude) -= h_ * R_ * M.middleRows<3>(kGyroOffset);
  }

  void add_noise(const MatrixXd& shape, ExtendedMatrix& N) const {
    Eigen::Matrix<double, kInertialStates, 12> G =
        Eigen::Matrix<double, kInertialStates, 12>::Zero();
    G.block<3, 3>(kInertialAttitude, 0) = -R_;
    G.block<3, 3>(kInertialVelocity, 3) = -R_;
    G.block<6, 6>(kGyroOffset, 6).setIdentity();
    for (Index j = 0; j < 12; ++j)
      for (Index i = 0; i < 12; ++i)
        if (shape(i, j) != 0) N += (h_ * shape(i, j)) * G.col(i) * G.col(j).transpose();
  }

  void observe(const ExtendedVector& x, MatrixXd& C, VectorXd& expected) const {
    C = C_;
    expected = C_ * x;
  }
  static double difference(Index, double y, double expected) { return y - expected; }

  /// Converts the rotation vector of the true attitude to the rotation from the stored attitude to
  /// it.
  void relate(const FilterRecord& record, Index k, const ExtendedVector&,
              FilterRecord& into) const {
    const Vector3d truth = record.truth.col(k).segment<3>(kInertialAttitude);
    if (!truth.allFinite()) return;
    const Eigen::AngleAxisd turn(Matrix3d(rotation(truth) * attitude_.transpose()));
    into.truth.col(k).segment<3>(kInertialAttitude) = turn.angle() * turn.axis();
  }

  /// Moves the rotation from the state vector into the stored attitude.
  void absorb(ExtendedVector& x) {
    attitude_ = rotation(x.head<3>()) * attitude_;
    x.head<3>().setZero();
  }

 private:
  Vector3d gravity_;
  MatrixXd C_;
  Matrix3d attitude_;
  double h_ = 0;
  Matrix3d R_ = Matrix3d::Identity();
  Vector3d felt_ = Vector3d::Zero();
};

using InertialRun = internal::ExtendedRun<InertialMotion>;

}  // namespace

FilterModel inertial_model(const Vector3d& gravity) {
  FilterModel model;
  model.gravity = gravity;
  const auto triple = [](std::vector<Signal>& signals, const char* name, const char* unit) {
    for (const char axis : {'x', 'y', 'z'})
      signals.push_back({fmt::format("{}_{}", name, axis), unit});
  };
  triple(model.states, "turn", "rad");
  triple(model.states, "velocity", "m/s");
  triple(model.states, "position", "m");
  triple(model.states, "gyro_offset", "rad/s");
  triple(model.states, "force_offset", "m/s2");
  triple(model.inputs, "gyro", "rad/s");
  triple(model.inputs, "force", "m/s2");
  triple(model.noises, "gyro", "rad/s");
  triple(model.noises, "force", "m/s2");
  triple(model.noises, "gyro_offset", "rad/s2");
  triple(model.noises, "force_offset", "m/s3");
  model.A = MatrixXd::Zero(kInertialStates, kInertialStates);
  model.A.block<3, 3>(kInertialPosition, kInertialVelocity).setIdentity();
  model.B = MatrixXd::Zero(kInertialStates, 6);
  model.G = MatrixXd::Zero(kInertialStates, 12);
  model.G.block<6, 6>(0, 0).diagonal().setConstant(-1);
  model.G.block<6, 6>(kGyroOffset, 6).setIdentity();
  model.Q.fixed = MatrixXd::Zero(12, 12);
  model.x0 = VectorXd::Zero(kInertialStates);
  ExtendedVector variances;
  variances << Vector3d::Zero(), Vector3d::Constant(kSpeed), Vector3d::Constant(kPlace),
      Vector3d::Constant(kGyro), Vector3d::Constant(kForce);
  model.P0 = variances.asDiagonal();
  model.diffuse.assign(kInertialStates, false);
  return model;
}

namespace {

void check_inertial(const FilterModel& model) {
  for (const FilterSensor& sensor : model.sensors)
    if (!sensor.C.leftCols<3>().isZero(0))
      throw InvalidInput(
          "filter model",
          fmt::format("C of sensor '{}' depends on the rotation, expected zeros in its first "
                      "three columns because the attitude is not a vector",
                      sensor.name));
}

/// Mean specific force in the time before the first measurement.
Vector3d mean_force(const FilterRecord& record, Index first) {
  Vector3d sum = Vector3d::Zero();
  Index count = 0;
  for (Index k = 0; k <= first; ++k) {
    if (record.time[static_cast<std::size_t>(first)] - record.time[static_cast<std::size_t>(k)] >
        kLevelling)
      continue;
    sum += record.u.col(k).tail<3>();
    ++count;
  }
  return sum / static_cast<double>(count);
}

/// Adds the initial uncertainty of the tilt and, about gravity, of the heading.
void doubt_heading(const FilterModel& model, InertialRun& run) {
  const Vector3d up = model.gravity->normalized();
  run.P.block<3, 3>(0, 0) += kTilt * Matrix3d::Identity() + kHeading * up * up.transpose();
}

/// The candidate heading with the largest likelihood of the measurements.
Matrix3d attitude_at_start(const FilterModel& model, const internal::DrivenRecord& driven,
                           const Matrix3d& tilt, const std::function<bool()>& stop) {
  Matrix3d result = tilt;
  double best = -std::numeric_limits<double>::infinity();
  for (int h = 0; h < kHeadings; ++h) {
    const Matrix3d attitude =
        rotation(2 * std::numbers::pi * h / kHeadings * model.gravity->normalized()) * tilt;
    InertialRun run(model, driven, start_of(model), InertialMotion(model, attitude), stop);
    doubt_heading(model, run);
    if (!run.run(driven.measured.time.front() + kComparison, nullptr) ||
        !(run.log_likelihood > best))
      continue;
    best = run.log_likelihood;
    result = attitude;
  }
  return result;
}

class InertialFilter final : public internal::ExtendedFilter {
 public:
  InertialFilter(FilterModel model, const std::vector<FilterRecord>& records,
                 const std::function<bool()>& stop)
      : ExtendedFilter(std::move(model), records, true, kMaxStep) {
    for (const internal::DrivenRecord& driven : driven_)
      attitude_.push_back(attitude_at_start(
          model_, driven, level(mean_force(records[driven.of], driven.first), *model_.gravity),
          stop));
  }

 private:
  bool run(std::size_t record, const Eigen::Ref<const VectorXd>& theta,
           const std::function<bool()>& stop, FilterRecord& into,
           double& failed_at) const override {
    InertialRun run(model_, driven_[record], theta, InertialMotion(model_, attitude_[record]),
                    stop);
    doubt_heading(model_, run);
    const bool done = run.run(std::numeric_limits<double>::infinity(), &into);
    failed_at = run.failed_at;
    return done;
  }

  std::vector<Matrix3d> attitude_;  ///< body to world at the first measurement of each record
};

}  // namespace

std::unique_ptr<NonlinearFilter> internal::inertial_filter(FilterModel model,
                                                           const std::vector<FilterRecord>& records,
                                                           const std::function<bool()>& stop) {
  check_inertial(model);
  return std::make_unique<InertialFilter>(std::move(model), records, stop);
}

}  // namespace quadtune
