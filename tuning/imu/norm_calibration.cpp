// SPDX-License-Identifier: Apache-2.0
#include "imu/norm_calibration.hpp"

#include <ceres/ceres.h>
#include <fmt/format.h>

#include <Eigen/Eigenvalues>
#include <Eigen/QR>
#include <Eigen/SVD>
#include <algorithm>
#include <array>
#include <cmath>
#include <numeric>

#include "quadtune/internal/counted.hpp"
#include "quadtune/internal/joined.hpp"
#include "quadtune/internal/tails.hpp"

namespace quadtune {
namespace {

using Eigen::Vector3d;
using Index = Eigen::Index;
using Matrix = Eigen::MatrixXd;
using Vector = Eigen::VectorXd;

constexpr double kOutlier = 5;       // robust standard deviations
constexpr double kMaxScatter = 0.2;  // maximum, of the radii before calibration, relative
constexpr double kNormalByMad = 1.4826;
// number of poses in excess of the parameters before any is rejected
constexpr Index kSpareForOutliers = 5;
constexpr std::array<const char*, kNormParameters> kNames = {
    "scale x", "cross-axis xy", "cross-axis xz", "scale y", "cross-axis yz",
    "scale z", "bias x",        "bias y",        "bias z",  "temperature coefficient z"};

/// Residual |direction| - 1 of one pose.
struct NormResidual {
  Vector3d scaled;
  double warmth;
  template <class Scalar>
  bool operator()(const Scalar* p, Scalar* residual) const {
    residual[0] = norm_direction(p, scaled, warmth).norm() - 1.0;
    return true;
  }
};

/// Centre and size of the sphere through the poses: |a|² = 2 c a + k, with the smallest c if the
/// poses do not determine it.
NormScaling sphere(const NormProblem& problem) {
  NormScaling scaling;
  const Vector3d mean = problem.raw.rowwise().mean();
  const Eigen::Matrix3Xd a = problem.raw.colwise() - mean;
  const double spread = std::sqrt(a.colwise().squaredNorm().mean());
  if (spread > 0) {
    Matrix A(problem.raw.cols(), 4);
    A.leftCols(3) = 2 / spread * a.transpose();
    A.col(3).setOnes();
    const Vector rhs = a.colwise().squaredNorm().transpose() / (spread * spread);
    Eigen::CompleteOrthogonalDecomposition<Matrix> decomposition;
    decomposition.setThreshold(0.05);  // ignore a centre outside the plane of the poses
    const Vector solution = decomposition.compute(A).solve(rhs);
    const Vector3d centre = spread * solution.head<3>();
    const Eigen::RowVectorXd radii = (a.colwise() - centre).colwise().norm();
    const double scatter = std::sqrt((radii.array() - radii.mean()).square().mean());
    // If all poses are equal, their noise does not determine a sphere.
    if (decomposition.rank() == 4 && scatter < kMaxScatter * radii.mean())
      scaling.centre = mean + centre;
  }
  const double size = (problem.raw.colwise() - scaling.centre).colwise().norm().mean();
  if (size > 0) scaling.size = size;
  if (problem.temperature.size() > 0) {
    scaling.t0 = problem.temperature.mean();
    const double span = problem.temperature.maxCoeff() - problem.temperature.minCoeff();
    if (span > 0) scaling.span = span;
  }
  return scaling;
}

/// The poses in use, in scaled units.
struct Poses {
  std::vector<NormResidual> all;
  std::vector<char> used;
  int parameters = kNormParameters;  ///< number of fitted parameters, the first ones

  [[nodiscard]] Index count() const { return std::count(used.begin(), used.end(), 1); }
};

bool fit(const Poses& poses, double loss_scale, Vector& parameters) {
  ceres::Problem problem;
  for (std::size_t i = 0; i < poses.all.size(); ++i)
    if (poses.used[i])
      problem.AddResidualBlock(new ceres::AutoDiffCostFunction<NormResidual, 1, kNormParameters>(
                                   new NormResidual(poses.all[i])),
                               loss_scale > 0 ? new ceres::HuberLoss(loss_scale) : nullptr,
                               parameters.data());
  if (poses.parameters < kNormParameters)
    problem.SetManifold(parameters.data(),
                        new ceres::SubsetManifold(kNormParameters, {kNormParameters - 1}));
  ceres::Solver::Options options;
  options.linear_solver_type = ceres::DENSE_QR;
  options.max_num_iterations = 200;
  options.function_tolerance = 1e-14;
  options.parameter_tolerance = 1e-12;
  options.gradient_tolerance = 1e-14;
  options.logging_type = ceres::SILENT;
  ceres::Solver::Summary summary;
  ceres::Solve(options, &problem, &summary);
  return summary.IsSolutionUsable() && parameters.allFinite();
}

/// The norm does not determine the signs of the rows of U; choose positive scales.
void make_positive(Vector& p) {
  if (p(0) < 0) p.segment<3>(0) *= -1;
  if (p(3) < 0) p.segment<2>(3) *= -1;
  p(5) = std::abs(p(5));
}

/// d(|direction|)/dp of one pose.
Eigen::RowVectorXd sensitivity(const NormResidual& pose, const Vector& parameters) {
  using Jet = ceres::Jet<double, kNormParameters>;
  std::array<Jet, kNormParameters> p;
  for (int k = 0; k < kNormParameters; ++k) p[static_cast<std::size_t>(k)] = Jet(parameters(k), k);
  Jet residual;
  pose(p.data(), &residual);
  return residual.v.transpose();
}

double value(const NormResidual& pose, const Vector& parameters) {
  double residual = 0;
  pose(parameters.data(), &residual);
  return residual;
}

/// Rejects poses whose norm is far from that of the others, at most as many as the fit can spare.
bool fit_and_refuse(Poses& poses, Vector& parameters) {
  if (!fit(poses, 0, parameters)) return false;
  const Index numbers = poses.parameters;
  if (poses.count() < numbers + kSpareForOutliers) return true;
  double scale = 0;
  for (int round = 0; round < 3; ++round) {  // the scale is recomputed from the remaining residuals
    std::vector<double> sizes;
    sizes.reserve(poses.all.size());
    for (const NormResidual& pose : poses.all) sizes.push_back(std::abs(value(pose, parameters)));
    const auto middle = sizes.begin() + std::ssize(sizes) / 2;
    std::nth_element(sizes.begin(), middle, sizes.end());
    const double share = double(poses.count()) / double(poses.count() - numbers);
    scale = kNormalByMad * *middle * std::sqrt(share);
    if (!(scale > 0) || !fit(poses, scale, parameters)) return scale == 0;
  }
  std::vector<std::pair<double, std::size_t>> far;
  for (std::size_t i = 0; i < poses.all.size(); ++i) {
    const double size = std::abs(value(poses.all[i], parameters));
    if (size > kOutlier * scale) far.emplace_back(size, i);
  }
  std::sort(far.rbegin(), far.rend());
  for (const auto& [size, i] : far)
    if (poses.count() > numbers + 1) poses.used[i] = 0;
  return fit(poses, 0, parameters);
}

struct Pose {
  Vector3d direction;
  std::string name;
  int faces;  ///< number of faces that share it: 1 for "x up", 2 for an edge, 3 for a corner
};

/// Faces, edges and corners of a cube: poses in which a person can hold the device.
std::vector<Pose> poses_to_hold() {
  std::vector<Pose> poses;
  for (int faces = 1; faces <= 3; ++faces)  // the simple ones first
    for (int x = 1; x >= -1; --x)
      for (int y = 1; y >= -1; --y)
        for (int z = 1; z >= -1; --z) {
          if (std::abs(x) + std::abs(y) + std::abs(z) != faces) continue;
          std::vector<std::string> parts;
          const std::array<int, 3> signs = {x, y, z};
          for (std::size_t k = 0; k < 3; ++k)
            if (signs[k] != 0)
              parts.push_back(std::string(1, "xyz"[k]) + (signs[k] > 0 ? " up" : " down"));
          poses.push_back({Vector3d(x, y, z).normalized(),
                           (faces > 1 ? "halfway between " : "") +
                               fmt::format("{}", internal::joined(parts, " and ")),
                           faces});
        }
  return poses;
}

/// Poses to add. Each is the one that maximizes the determinant of the information. A simple pose
/// is preferred to one that is only slightly better.
std::vector<std::string> missing_poses(const Matrix& J, int parameters) {
  constexpr int kMax = 9;
  constexpr double kEnough = 0.15;   // smallest singular value of 9 well-chosen poses
  constexpr double kNothing = 1e-3;  // singular value of an undetermined direction
  constexpr double kSimple = 2;      // factor by which a pose that is harder to hold must be better
  const Vector ideal = (Vector(kNormParameters) << 1, 0, 0, 1, 0, 1, 0, 0, 0, 0).finished();
  std::vector<Pose> all = poses_to_hold();
  std::vector<std::string> names;
  Matrix information = J.transpose() * J;
  information.diagonal().array() += kNothing * kNothing;
  for (int i = 0; i < kMax; ++i) {
    const Eigen::SelfAdjointEigenSolver<Matrix> eigen(information);
    if (eigen.eigenvalues()(0) > kEnough * kEnough) break;
    const Matrix inverse = eigen.eigenvectors() * eigen.eigenvalues().cwiseInverse().asDiagonal() *
                           eigen.eigenvectors().transpose();
    auto best = all.end();
    double max = 0;
    Eigen::RowVectorXd row;
    for (auto pose = all.begin(); pose != all.end(); ++pose) {
      const Eigen::RowVectorXd candidate =
          sensitivity({pose->direction, 0}, ideal).head(parameters);
      const double told = candidate * inverse * candidate.transpose();
      if (told > max * (best == all.end() || best->faces == pose->faces ? 1.001 : kSimple)) {
        max = told;
        best = pose;
        row = candidate;
      }
    }
    if (best == all.end()) break;
    names.push_back(best->name);
    all.erase(best);
    information += row.transpose() * row;
  }
  return names;
}

/// Names of the parameters that change along a direction.
void name_unseen(const Vector& direction, std::vector<std::string>& names) {
  const double max = direction.cwiseAbs().maxCoeff();
  for (Index k = 0; k < direction.size(); ++k) {
    const std::string name = kNames[static_cast<std::size_t>(k)];
    if (std::abs(direction(k)) >= 0.4 * max &&
        std::find(names.begin(), names.end(), name) == names.end())
      names.push_back(name);
  }
}

void refuse(SensorCalibration& calibration, const Matrix& J, int parameters) {
  calibration.status = CalibrationStatus::not_observable;
  calibration.missing = missing_poses(J, parameters);
  std::string text =
      J.rows() <= parameters
          ? fmt::format(
                "the log has {}, expected at least {}, because {} parameters are fitted "
                "and one more pose is needed to check them",
                internal::counted(J.rows(), "pose"), parameters + 1, parameters)
          : fmt::format("{} {} not determine {}", internal::counted(J.rows(), "pose"),
                        J.rows() == 1 ? "does" : "do", internal::joined(calibration.unseen, ", "));
  if (!calibration.missing.empty())
    text += fmt::format("; missing poses: {}", internal::joined(calibration.missing, ", "));
  calibration.culprit = text;
}

void fill(SensorCalibration& c, const NormProblem& problem, const NormScaling& scaling,
          const Vector& p, const Vector& errors) {
  const double unit = problem.norm / scaling.size;  // of M
  c.M << p(0), p(1), p(2), 0, p(3), p(4), 0, 0, p(5);
  c.M *= unit;
  c.M_error << errors(0), errors(1), errors(2), 0, errors(3), errors(4), 0, 0, errors(5);
  c.M_error *= unit;
  c.b = scaling.centre + scaling.size * p.segment<3>(6);
  c.b_error = scaling.size * errors.segment<3>(6);
  c.t0 = scaling.t0;
  c.with_temperature = problem.with_temperature;
  if (problem.with_temperature) {
    c.d(2) = scaling.size * p(9) / scaling.span;
    c.d_error(2) = scaling.size * errors(9) / scaling.span;
  }
  split(c);
}

}  // namespace

void split(SensorCalibration& calibration) {
  calibration.K = calibration.M.diagonal().cwiseInverse();
  calibration.T = calibration.M * calibration.K.asDiagonal();
}

NormSolution norm_calibration(const NormProblem& problem) {
  NormSolution result;
  SensorCalibration& calibration = result.calibration;
  const int numbers = problem.with_temperature ? kNormParameters : kNormParameters - 1;
  if (problem.raw.cols() == 0) {
    refuse(calibration, Matrix(0, numbers), numbers);
    return result;
  }
  result.scaling = sphere(problem);
  Poses poses;
  poses.parameters = numbers;
  for (Index i = 0; i < problem.raw.cols(); ++i) {
    const double t = problem.with_temperature ? problem.temperature(i) : result.scaling.t0;
    poses.all.push_back(
        {result.scaling.scaled(problem.raw.col(i)), (t - result.scaling.t0) / result.scaling.span});
  }
  poses.used.assign(poses.all.size(), 1);
  result.parameters = (Vector(kNormParameters) << 1, 0, 0, 1, 0, 1, 0, 0, 0, 0).finished();
  const Vector start = result.parameters;
  const bool converged = fit_and_refuse(poses, result.parameters);

  make_positive(result.parameters);

  // The information of the poses is evaluated at the start of the fit, because along undetermined
  // directions the result is arbitrary.
  Matrix J(poses.count(), numbers), J_start(poses.count(), numbers);
  double before = 0, after = 0;
  for (std::size_t i = 0, row = 0; i < poses.all.size(); ++i) {
    if (!poses.used[i]) {
      calibration.refused.push_back(i);
      continue;
    }
    J.row(static_cast<Index>(row)) = sensitivity(poses.all[i], result.parameters).head(numbers);
    J_start.row(static_cast<Index>(row++)) = sensitivity(poses.all[i], start).head(numbers);
    after += std::pow(value(poses.all[i], result.parameters), 2);
  }
  // Before: one scale for all axes and no bias.
  const double scale = problem.raw.colwise().norm().mean();
  for (std::size_t i = 0; i < poses.all.size(); ++i)
    if (poses.used[i])
      before += std::pow(problem.raw.col(static_cast<Index>(i)).norm() / scale - 1, 2);
  calibration.used = static_cast<std::size_t>(poses.count());
  result.used = poses.used;
  if (J.rows() <= numbers) {
    refuse(calibration, J_start, numbers);
    return result;
  }
  calibration.residual_before = problem.norm * std::sqrt(before / double(J.rows()));
  calibration.residual_after = problem.norm * std::sqrt(after / double(J.rows()));
  const auto degrees = static_cast<double>(J.rows() - numbers);
  result.noise = std::sqrt(after / degrees);
  calibration.quantile = internal::student_quantile(0.975, degrees);
  for (const Matrix& seen : {J_start, J}) {
    const Eigen::JacobiSVD<Matrix> svd(seen, Eigen::ComputeThinV);
    const Vector& singular = svd.singularValues();
    for (Index k = 0; k < numbers; ++k)
      if (!(singular(k) > 1e-6 * singular(0)) ||
          calibration.quantile * result.noise / singular(k) > problem.max_error)
        name_unseen(svd.matrixV().col(k), calibration.unseen);
    if (calibration.unseen.empty()) continue;
    refuse(calibration, J_start, numbers);
    return result;
  }
  if (!converged) {
    calibration.status = CalibrationStatus::no_match;
    calibration.culprit = "the norms of the poses do not fit an ellipsoid";
    return result;
  }
  const Eigen::JacobiSVD<Matrix> svd(J, Eigen::ComputeThinV);
  const Eigen::ArrayXd spread = svd.singularValues().array().inverse();
  Vector errors = Vector::Zero(kNormParameters);
  for (Index k = 0; k < numbers; ++k)
    errors(k) = result.noise * (svd.matrixV().row(k).transpose().array() * spread).matrix().norm();
  fill(calibration, problem, result.scaling, result.parameters, errors);
  calibration.status = CalibrationStatus::solved;
  return result;
}

}  // namespace quadtune
