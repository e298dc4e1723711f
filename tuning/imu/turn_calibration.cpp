// SPDX-License-Identifier: Apache-2.0
#include "imu/turn_calibration.hpp"

#include <ceres/ceres.h>
#include <fmt/format.h>

#include <Eigen/Cholesky>
#include <Eigen/Eigenvalues>
#include <Eigen/LU>
#include <algorithm>
#include <array>
#include <cmath>
#include <memory>

#include "imu/turn_residuals.hpp"
#include "quadtune/internal/counted.hpp"
#include "quadtune/internal/joined.hpp"
#include "quadtune/internal/tails.hpp"

namespace quadtune {
namespace {

using Eigen::Vector3d;
using Index = Eigen::Index;
using Matrix = Eigen::MatrixXd;
using Vector = Eigen::VectorXd;

constexpr std::size_t kMinTurns = 6;
constexpr double kTurnOutlier = 5;  // robust standard deviations
constexpr double kMedianOfRayleigh = 1.17741;
constexpr double kMaxMismatch = 0.3;  // [rad] rms, above which the turns do not match

/// All fitted parameters, scaled to order 1.
struct Unknowns {
  std::array<double, 9> gyro = {1, 0, 0, 0, 1, 0, 0, 0, 1};  ///< M / scale, row by row
  std::array<double, 3> bias{};                              ///< relative to the noise
  std::array<double, 3> drift{};
  Vector acc;
  std::vector<std::array<double, 3>> up;  ///< one per pose
};

class Fitter {
 public:
  explicit Fitter(const TurnProblem& problem);
  [[nodiscard]] SensorCalibration run();

 private:
  void scale_rest();
  bool guess_scale();
  void solve();
  void leave_out_outliers();
  void weigh_turns();
  [[nodiscard]] Vector3d mismatch(std::size_t turn,
                                  const std::vector<std::array<double, 3>>& up) const;
  [[nodiscard]] double rms_angle() const;
  [[nodiscard]] double turn_sigma(std::size_t turn) const;
  void build(ceres::Problem& problem);
  [[nodiscard]] Matrix jacobian(Vector& residuals);
  void finish(SensorCalibration& result);
  [[nodiscard]] double degrees_of(const Matrix& J, const Matrix& covariance) const;
  void name_open(const Matrix& covariance, SensorCalibration& result) const;

  const TurnProblem& problem_;
  std::vector<TurnSamples> samples_;  ///< of the turns in use
  std::vector<std::size_t> first_;    ///< their first poses
  std::vector<std::size_t> index_;    ///< their indices in the problem
  std::vector<std::size_t> refused_;
  Vector3d bias_ = Vector3d::Zero();
  double bias_unit_ = 1;  ///< standard deviation of the means of stationary poses [raw]
  double sigma_up_ = 1e-9;
  double factor_ = 1;  ///< noise of a turn relative to that from the noise of the gyroscope
  double redundancy_ = 0;
  Unknowns x_;
  std::vector<std::array<double, 3>> seen_up_;  ///< from the accelerometer alone
};

Fitter::Fitter(const TurnProblem& problem) : problem_(problem) {
  sigma_up_ = std::max(problem.accelerometer.noise, 1e-9);
  x_.acc = problem.accelerometer.parameters;
  for (const StationaryPose& pose : problem.poses) {
    const Vector3d direction =
        norm_direction(x_.acc.data(), problem.accelerometer.scaling.scaled(pose.accelerometer),
                       (pose.temperature - problem.accelerometer.scaling.t0) /
                           problem.accelerometer.scaling.span)
            .normalized();
    x_.up.push_back({direction(0), direction(1), direction(2)});
  }
  seen_up_ = x_.up;
  scale_rest();
  const NormScaling& scaling = problem.accelerometer.scaling;
  for (std::size_t i = 0; i < problem.turns.size(); ++i) {
    const Turn& turn = problem.turns[i];
    if (!problem.accelerometer.used[turn.first] || !problem.accelerometer.used[turn.first + 1]) {
      refused_.push_back(i);
      continue;
    }
    TurnSamples samples;
    const auto begin = static_cast<Index>(turn.begin);
    const auto count = static_cast<Index>(turn.end - turn.begin);
    samples.t = turn.log->t.segment(begin, count);
    samples.raw = turn.log->gyroscope.middleCols(begin, count).colwise() - bias_;
    samples.unit = bias_unit_;
    samples.warmth = Vector::Zero(count);
    if (problem.with_temperature)
      samples.warmth =
          (turn.log->temperature.segment(begin, count).array() - scaling.t0) / scaling.span;
    samples_.push_back(std::move(samples));
    first_.push_back(turn.first);
    index_.push_back(i);
  }
}

/// Computes the bias, its drift with temperature and the standard deviation of the residuals from
/// the stationary poses.
void Fitter::scale_rest() {
  const NormScaling& scaling = problem_.accelerometer.scaling;
  const auto n = static_cast<Index>(problem_.poses.size());
  Matrix A = Matrix::Ones(n, problem_.with_temperature ? 2 : 1);
  Matrix y(n, 3);
  for (Index i = 0; i < n; ++i) {
    const StationaryPose& pose = problem_.poses[static_cast<std::size_t>(i)];
    y.row(i) = pose.gyroscope.transpose();
    if (problem_.with_temperature) A(i, 1) = -(pose.temperature - scaling.t0) / scaling.span;
  }
  const Matrix AtA = A.transpose() * A;
  const Matrix Aty = A.transpose() * y;
  const Matrix fit = AtA.ldlt().solve(Aty);
  bias_ = fit.row(0).transpose();
  const double degrees = std::max(1.0, double(3 * (n - A.cols())));
  bias_unit_ =
      std::max(std::sqrt((y - A * fit).squaredNorm() / degrees), 1e-9 * (1 + bias_.norm()));
  if (problem_.with_temperature)
    for (Index i = 0; i < 3; ++i) x_.drift[static_cast<std::size_t>(i)] = fit(1, i) / bias_unit_;
}

/// Gravity before a turn, rotated by the integrated gyroscope, minus gravity after it.
Vector3d Fitter::mismatch(std::size_t turn, const std::vector<std::array<double, 3>>& up) const {
  const Eigen::Map<const Vector3d> u(up[first_[turn]].data()), next(up[first_[turn] + 1].data());
  return turned<double>(samples_[turn], x_.gyro.data(), x_.bias.data(), x_.drift.data(), u) - next;
}

double Fitter::rms_angle() const {
  double sum = 0;
  for (std::size_t i = 0; i < samples_.size(); ++i)
    sum += std::pow(2 * std::asin(std::min(1.0, mismatch(i, seen_up_).norm() / 2)), 2);
  return std::sqrt(sum / double(samples_.size()));
}

/// Estimates one scale for all axes from the angles by which gravity turns. A turn about the axis
/// of gravity itself does not move gravity and contains no information; the angle of a turn is
/// never smaller than that of gravity.
bool Fitter::guess_scale() {
  constexpr Index kMaxSamples = 20000;
  constexpr int kSteps = 80;
  double most_turned = 0, least_scale = 0;
  std::vector<double> integrals, angles;
  std::vector<std::size_t> looked_at;
  Index samples = 0;
  for (std::size_t i = 0; i < samples_.size() && samples < kMaxSamples; ++i) {
    const TurnSamples& turn = samples_[i];
    Vector3d sum = Vector3d::Zero();
    for (Index k = 1; k < turn.t.size(); ++k)
      sum += 0.5 * (turn.raw.col(k) + turn.raw.col(k - 1)) * (turn.t(k) - turn.t(k - 1));
    const Eigen::Map<const Vector3d> u(x_.up[first_[i]].data()), next(x_.up[first_[i] + 1].data());
    integrals.push_back(sum.norm());
    angles.push_back(std::acos(std::clamp(u.dot(next), -1.0, 1.0)));
    most_turned = std::max(most_turned, sum.norm());
    looked_at.push_back(i);
    samples += turn.t.size();
  }
  for (std::size_t i = 0; i < integrals.size(); ++i)
    if (integrals[i] > 0.3 * most_turned)
      least_scale = std::max(least_scale, angles[i] / integrals[i]);
  if (!(least_scale > 0)) return false;
  double min = std::numeric_limits<double>::infinity(), best = 0;
  for (const double sign : {1.0, -1.0})
    for (int k = 0; k < kSteps; ++k) {
      const double scale = sign * least_scale * 0.5 * std::pow(8.0, double(k) / kSteps);
      double sum = 0;
      for (const std::size_t i : looked_at) {
        samples_[i].scale = scale;
        sum += mismatch(i, seen_up_).squaredNorm();
      }
      if (sum < min) {
        min = sum;
        best = scale;
      }
    }
  for (TurnSamples& turn : samples_) turn.scale = best;
  return true;
}

double Fitter::turn_sigma(std::size_t turn) const {
  const TurnSamples& samples = samples_[turn];
  const double length = samples.t(samples.t.size() - 1) - samples.t(0);
  const double dt = length / double(samples.t.size() - 1);
  // The integral of white noise over n samples of dt is √n dt σ.
  return std::max(factor_ * std::abs(samples.scale) * problem_.noise * std::sqrt(length * dt),
                  1e-9);
}

void Fitter::build(ceres::Problem& problem) {
  const NormScaling& scaling = problem_.accelerometer.scaling;
  for (std::size_t i = 0; i < problem_.poses.size(); ++i) {
    if (!problem_.accelerometer.used[i]) continue;
    const StationaryPose& pose = problem_.poses[i];
    const double warmth =
        problem_.with_temperature ? (pose.temperature - scaling.t0) / scaling.span : 0;
    problem.AddResidualBlock(
        new ceres::AutoDiffCostFunction<PoseResidual, 3, kNormParameters, 3>(
            new PoseResidual{scaling.scaled(pose.accelerometer), warmth, 1 / sigma_up_}),
        nullptr, x_.acc.data(), x_.up[i].data());
    problem.AddResidualBlock(
        new ceres::AutoDiffCostFunction<RestResidual, 3, 3, 3>(
            new RestResidual{(pose.gyroscope - bias_) / bias_unit_, warmth, 1}),
        nullptr, x_.bias.data(), x_.drift.data());
    problem.SetManifold(x_.up[i].data(), new ceres::SphereManifold<3>);
  }
  for (std::size_t i = 0; i < samples_.size(); ++i)
    problem.AddResidualBlock(new TurnResidual(&samples_[i], 1 / turn_sigma(i)), nullptr,
                             x_.gyro.data(), x_.bias.data(), x_.drift.data(),
                             x_.up[first_[i]].data(), x_.up[first_[i] + 1].data());
  if (!problem_.accelerometer.calibration.with_temperature)
    problem.SetManifold(x_.acc.data(),
                        new ceres::SubsetManifold(kNormParameters, {kNormParameters - 1}));
  if (!problem_.with_temperature) problem.SetParameterBlockConstant(x_.drift.data());
}

void Fitter::solve() {
  ceres::Problem problem;
  build(problem);
  ceres::Solver::Options options;
  options.linear_solver_type = ceres::DENSE_NORMAL_CHOLESKY;
  options.max_num_iterations = 50;
  options.function_tolerance = 1e-8;  // relative to a sum of squares of about the number of poses
  options.logging_type = ceres::SILENT;
  ceres::Solver::Summary summary;
  ceres::Solve(options, &problem, &summary);
}

/// Computes the weighted Jacobian (columns of the gyroscope first, rows of the turns last) and the
/// residuals.
Matrix Fitter::jacobian(Vector& residuals) {
  ceres::Problem problem;
  build(problem);
  ceres::Problem::EvaluateOptions options;
  options.parameter_blocks = {x_.gyro.data(), x_.bias.data()};
  if (problem_.with_temperature) options.parameter_blocks.push_back(x_.drift.data());
  options.parameter_blocks.push_back(x_.acc.data());
  for (std::size_t i = 0; i < x_.up.size(); ++i)
    if (problem_.accelerometer.used[i]) options.parameter_blocks.push_back(x_.up[i].data());
  problem.GetResidualBlocks(&options.residual_blocks);
  ceres::CRSMatrix sparse;
  std::vector<double> values;
  problem.Evaluate(options, nullptr, &values, nullptr, &sparse);
  Matrix J = Matrix::Zero(sparse.num_rows, sparse.num_cols);
  for (int row = 0; row < sparse.num_rows; ++row)
    for (int k = sparse.rows[static_cast<std::size_t>(row)];
         k < sparse.rows[static_cast<std::size_t>(row) + 1]; ++k)
      J(row, sparse.cols[static_cast<std::size_t>(k)]) = sparse.values[static_cast<std::size_t>(k)];
  residuals = Eigen::Map<Vector>(values.data(), std::ssize(values));
  return J;
}

/// Weight of a prior of each of the nine parameters, so weak that it matters only where there is no
/// other information.
constexpr double kHint = 0.01;

Matrix covariance_of(const Matrix& J) {
  Matrix H = J.transpose() * J;
  H.diagonal().head(9).array() += kHint * kHint;
  return H.ldlt().solve(Matrix(Matrix::Identity(H.rows(), H.cols())));
}

/// Estimates the noise of turns from their residuals, corrected for the degrees of freedom of the
/// fit.
void Fitter::weigh_turns() {
  Vector residuals;
  const Matrix J = jacobian(residuals);
  const Index rows = 3 * std::ssize(samples_);
  const Matrix turns = J.bottomRows(rows);
  const Matrix covariance = covariance_of(J);
  const double taken = (turns * covariance).cwiseProduct(turns).sum();
  // The third residual of each turn, along gravity, carries no information: both ends have norm 1.
  redundancy_ = std::max(1.0, 2.0 * double(samples_.size()) - taken);
  factor_ *= std::sqrt(residuals.tail(rows).squaredNorm() / redundancy_);
}

void Fitter::leave_out_outliers() {
  if (samples_.size() < kMinTurns + 4) return;
  std::vector<double> sizes;
  for (std::size_t i = 0; i < samples_.size(); ++i)
    sizes.push_back(mismatch(i, seen_up_).norm() / std::hypot(turn_sigma(i), sigma_up_));
  std::vector<double> sorted = sizes;
  const auto middle = sorted.begin() + std::ssize(sorted) / 2;
  std::nth_element(sorted.begin(), middle, sorted.end());
  const double max = kTurnOutlier * *middle / kMedianOfRayleigh;
  for (std::size_t i = samples_.size(); i-- > 0;)
    if (sizes[i] > max && samples_.size() > kMinTurns) {
      const auto at = static_cast<std::ptrdiff_t>(i);
      refused_.push_back(index_[i]);
      samples_.erase(samples_.begin() + at);
      first_.erase(first_.begin() + at);
      index_.erase(index_.begin() + at);
    }
  std::sort(refused_.begin(), refused_.end());
}

/// Degrees of freedom of the errors of the nine parameters, by Welch and Satterthwaite: one part of
/// each variance comes from the poses, whose noise is known from the fit of the accelerometer, and
/// the other from the turns.
double Fitter::degrees_of(const Matrix& J, const Matrix& covariance) const {
  const Index turns = 3 * std::ssize(samples_);
  const Matrix gains = J * covariance.leftCols(9);  // sensitivity to the errors of the rows
  const Eigen::ArrayXd of_turns = gains.bottomRows(turns).colwise().squaredNorm().transpose();
  const Eigen::ArrayXd of_poses =
      gains.topRows(J.rows() - turns).colwise().squaredNorm().transpose();
  const double poses = std::max(
      1.0, double(problem_.accelerometer.calibration.used) - (problem_.with_temperature ? 10 : 9));
  const Eigen::ArrayXd degrees = (of_turns + of_poses).square() /
                                 (of_turns.square() / redundancy_ + of_poses.square() / poses);
  return std::max(1.0, degrees.mean());
}

void Fitter::name_open(const Matrix& covariance, SensorCalibration& result) const {
  const Eigen::SelfAdjointEigenSolver<Matrix> eigen(Matrix(covariance.topLeftCorner(9, 9)));
  std::array<bool, 3> axis{};
  for (Index k = 0; k < 9; ++k) {
    if (result.quantile * std::sqrt(eigen.eigenvalues()(k)) <= problem_.max_error) continue;
    const Vector v = eigen.eigenvectors().col(k);
    for (int i = 0; i < 9; ++i) {
      if (std::abs(v(i)) < 0.4 * v.cwiseAbs().maxCoeff()) continue;
      const std::string name = i % 4 == 0
                                   ? fmt::format("scale {}", "xyz"[i / 3])
                                   : fmt::format("cross-axis {}{}", "xyz"[i / 3], "xyz"[i % 3]);
      if (std::find(result.unseen.begin(), result.unseen.end(), name) == result.unseen.end())
        result.unseen.push_back(name);
      // a column is determined by turns about its axis
      axis[static_cast<std::size_t>(i % 3)] = true;
    }
  }
  for (std::size_t i = 0; i < 3; ++i)
    if (axis[i]) result.missing.push_back(fmt::format("a turn about {0} with {0} level", "xyz"[i]));
  if (result.unseen.empty()) return;
  result.status = CalibrationStatus::not_observable;
  result.culprit =
      fmt::format("{} turns do not determine {}; missing: {}", samples_.size(),
                  internal::joined(result.unseen, ", "), internal::joined(result.missing, ", "));
}

/// Describes the first axis whose rotation is measured by the channel of another axis; empty if there
/// is none.
/// @param M  from raw samples to rates in the axes of the accelerometer
std::string swapped_channels(const Eigen::Matrix3d& M) {
  for (Eigen::Index axis = 0; axis < 3; ++axis) {
    Eigen::Index channel = 0;
    M.row(axis).cwiseAbs().maxCoeff(&channel);
    if (channel != axis)
      return fmt::format(
          "channel {} of the gyroscope measures the rotation about the {} axis of the "
          "accelerometer, expected "
          "channel {}; are the channels of both sensors listed in the order x,y,z of the same "
          "axes?",
          channel + 1, "xyz"[axis], axis + 1);
  }
  return "";
}

void Fitter::finish(SensorCalibration& result) {
  Vector residuals;
  const Matrix J = jacobian(residuals);
  const Matrix covariance = covariance_of(J);
  result.quantile = internal::student_quantile(0.975, degrees_of(J, covariance));
  name_open(covariance, result);
  if (!result.unseen.empty()) return;
  const double scale = samples_.front().scale;
  const Vector errors = covariance.diagonal().cwiseSqrt();
  for (int i = 0; i < 9; ++i) {
    result.M(i / 3, i % 3) = scale * x_.gyro[static_cast<std::size_t>(i)];
    result.M_error(i / 3, i % 3) = std::abs(scale) * errors(i);
  }
  result.culprit = swapped_channels(result.M);
  if (!result.culprit.empty()) {
    result.status = CalibrationStatus::no_match;
    return;
  }
  const NormScaling& scaling = problem_.accelerometer.scaling;
  for (int i = 0; i < 3; ++i) {
    result.b(i) = bias_(i) + bias_unit_ * x_.bias[static_cast<std::size_t>(i)];
    result.b_error(i) = bias_unit_ * errors(9 + i);
    if (!problem_.with_temperature) continue;
    result.d(i) = bias_unit_ * x_.drift[static_cast<std::size_t>(i)] / scaling.span;
    result.d_error(i) = bias_unit_ * errors(12 + i) / scaling.span;
  }
  result.with_temperature = problem_.with_temperature;
  result.t0 = scaling.t0;
  split(result);
  result.status = CalibrationStatus::solved;
}

SensorCalibration Fitter::run() {
  SensorCalibration result;
  const auto too_few = [&] {
    result.status = CalibrationStatus::not_observable;
    result.culprit = fmt::format(
        "the log has {} between poses, expected at least {}, because each "
        "determines 2 of 9 parameters",
        internal::counted(samples_.size(), "turn"), kMinTurns);
    result.missing = {"turns about x, y and z, each with that axis level"};
    return result;
  };
  if (samples_.size() < kMinTurns) return too_few();
  if (!guess_scale()) {
    result.status = CalibrationStatus::not_observable;
    result.culprit = "no turn moves gravity; expected turns about level axes";
    result.missing = {"turns about x, y and z, each with that axis level"};
    return result;
  }
  result.residual_before = rms_angle();
  solve();
  leave_out_outliers();
  for (int round = 0; round < 3; ++round) {
    const double factor = factor_;
    weigh_turns();
    if (std::abs(factor_ / factor - 1) < 0.02) break;
    solve();
  }
  result.residual_after = rms_angle();
  result.used = samples_.size();
  result.refused = refused_;
  if (!(result.residual_after < kMaxMismatch)) {
    result.status = CalibrationStatus::no_match;
    result.culprit = fmt::format(
        "gravity rotated by the gyroscope deviates by {:.2g} rad (rms); "
        "expected less than {}; are its axes those of the accelerometer?",
        result.residual_after, kMaxMismatch);
    return result;
  }
  finish(result);
  return result;
}

}  // namespace

SensorCalibration turn_calibration(const TurnProblem& problem) { return Fitter(problem).run(); }

}  // namespace quadtune
