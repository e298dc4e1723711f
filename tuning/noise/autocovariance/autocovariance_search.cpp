// SPDX-License-Identifier: Apache-2.0
#include "noise/autocovariance/autocovariance_search.hpp"

#include <ceres/dynamic_autodiff_cost_function.h>
#include <ceres/problem.h>
#include <ceres/solver.h>

#include <Eigen/Cholesky>
#include <Eigen/Eigenvalues>
#include <cmath>
#include <memory>

namespace quadtune::internal {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

/// Combinations of variances with less information than this share of the maximum count as
/// undetermined.
constexpr double kDeficient = 1e-8;
/// Weight of a prior that pulls a logarithm to its start if the moments do not determine it, in
/// standard deviations per e-fold: too small to count as information.
constexpr double kPull = 0.01;
/// Gradient, in standard deviations, at which the least squares have converged.
constexpr double kSolved = 1e-4;

/// r(z), for numbers and for automatic derivatives (jets).
struct Residuals {
  const SampledModel& sampled;
  const MatrixXd& map;
  const VectorXd& moments;
  const FilterModel& model;
  const std::vector<bool>& vague;
  VectorXd theta;
  Coordinates at;

  [[nodiscard]] int count() const {
    return static_cast<int>(moments.size() + 2 * static_cast<Index>(at.free.size()));
  }

  template <class T>
  bool operator()(T const* const* z, T* r) const {
    using std::exp;
    const auto p = static_cast<std::size_t>(theta.size());
    std::vector<T> logarithm(p), variance(p);
    for (std::size_t i = 0; i < p; ++i) {
      logarithm[i] = T(theta(static_cast<Index>(i)));
      variance[i] = exp(logarithm[i]);
    }
    for (std::size_t q = 0; q < at.free.size(); ++q) {
      const auto i = static_cast<std::size_t>(at.free[q]);
      if (at.scale[q] > 0) {
        variance[i] = z[0][q] * at.scale[q];
      } else {
        logarithm[i] = z[0][q];
        variance[i] = exp(z[0][q]);
      }
    }
    for (Index m = 0; m < moments.size(); ++m) r[m] = T(-moments(m));
    for (std::size_t t = 0; t < sampled.terms.size(); ++t) {
      const NoiseTerm& term = sampled.terms[t];
      const T value = term.row < 0
                          ? variance[static_cast<std::size_t>(term.parameter)]
                          : full_entry(logarithm.data() + term.parameter, term.row, term.column);
      const auto column = map.col(static_cast<Index>(t));
      for (Index m = 0; m < moments.size(); ++m) r[m] += value * column(m);
    }
    T* after = r + moments.size();
    for (std::size_t q = 0; q < at.free.size(); ++q) {
      const auto i = static_cast<std::size_t>(at.free[q]);
      const auto& prior = model.parameters[i].prior;
      after[2 * q] = prior ? (logarithm[i] - std::log(prior->median)) / prior->deviation : T(0);
      after[2 * q + 1] = vague[i] ? kPull * (logarithm[i] - theta(static_cast<Index>(i))) : T(0);
    }
    return true;
  }
};

VectorXd z_of(const VectorXd& theta, const Coordinates& at) {
  VectorXd z(static_cast<Index>(at.free.size()));
  for (std::size_t q = 0; q < at.free.size(); ++q) {
    const double value = theta(at.free[q]);
    z(static_cast<Index>(q)) = at.scale[q] > 0 ? std::exp(value) / at.scale[q] : value;
  }
  return z;
}

std::unique_ptr<ceres::CostFunction> jets_of(const Residuals& residuals) {
  auto function =
      std::make_unique<ceres::DynamicAutoDiffCostFunction<Residuals>>(new Residuals(residuals));
  function->AddParameterBlock(static_cast<int>(residuals.at.free.size()));
  function->SetNumResiduals(residuals.count());
  return function;
}

/// r and ∂r/∂z.
std::pair<VectorXd, MatrixXd> linearized(const Residuals& residuals, const VectorXd& z) {
  VectorXd r(residuals.count());
  Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor> J(r.size(), z.size());
  const double* blocks[] = {z.data()};
  double* jacobians[] = {J.data()};
  jets_of(residuals)->Evaluate(blocks, r.data(), jacobians);
  return {r, J};
}

/// Whether the gradient of ½ r², in standard deviations, is negligible for all parameters that are
/// not held at a bound.
bool is_still(const Residuals& residuals, const VectorXd& z) {
  const auto [r, J] = linearized(residuals, z);
  if (!r.allFinite() || !J.allFinite()) return false;
  for (Index q = 0; q < z.size(); ++q) {
    const double slope = J.col(q).dot(r);
    const bool is_variance = residuals.at.scale[static_cast<std::size_t>(q)] > 0;
    if (is_variance && z(q) < 1e-12 && slope >= 0) continue;
    if (std::abs(slope) > kSolved * std::max(1.0, J.col(q).norm())) return false;
  }
  return true;
}

}  // namespace

AutocovarianceProblem::AutocovarianceProblem(const SampledModel& sampled, const FilterModel& model,
                                             const MomentMap& map, const VectorXd& moments,
                                             const MatrixXd& covariance)
    : sampled_(sampled),
      model_(model),
      linear_(model.parameters.size(), true),
      vague_(model.parameters.size(), false) {
  // The autocovariances of a slow predictor are nearly dependent: add a ridge if the factorization
  // requires one.
  const VectorXd size = covariance.diagonal().cwiseSqrt().cwiseInverse();
  const MatrixXd correlation = size.asDiagonal() * covariance * size.asDiagonal();
  Eigen::LLT<MatrixXd> factor;
  for (const double ridge : {1e-12, 1e-10, 1e-8, 1e-6, 1e-4, 1e-2}) {
    factor.compute(correlation + ridge * MatrixXd::Identity(moments.size(), moments.size()));
    if (factor.info() == Eigen::Success) break;
  }
  map_ = factor.matrixL().solve(size.asDiagonal() * map.of);
  moments_ = factor.matrixL().solve(size.asDiagonal() * (moments - map.constant));

  const auto p = static_cast<Index>(model.parameters.size());
  MatrixXd columns = MatrixXd::Zero(map_.rows(), p);
  for (std::size_t t = 0; t < sampled.terms.size(); ++t) {
    const NoiseTerm& term = sampled.terms[t];
    if (term.row < 0) {
      columns.col(term.parameter) += map_.col(static_cast<Index>(t));
      continue;
    }
    const int last = term.parameter + term.row * (term.row + 3) / 2;
    for (int i = term.parameter; i <= last; ++i) linear_[static_cast<std::size_t>(i)] = false;
  }
  std::vector<int> told;
  for (Index i = 0; i < p; ++i) {
    const auto k = static_cast<std::size_t>(i);
    if (model.parameters[k].prior || !model.parameters[k].logarithmic) linear_[k] = false;
    const double norm = columns.col(i).norm();
    if (norm > 0) columns.col(i) /= norm;
    if (linear_[k] && norm > 0 && !model.parameters[k].fixed) told.push_back(static_cast<int>(i));
  }
  if (told.empty()) return;
  // Variances of which only a combination is determined stay positive, close to their start.
  const MatrixXd seen = columns(Eigen::all, told);
  const Eigen::SelfAdjointEigenSolver<MatrixXd> eigen(MatrixXd(seen.transpose() * seen));
  for (Index q = 0; q < seen.cols(); ++q) {
    if (eigen.eigenvalues()(q) > kDeficient) continue;
    for (Index i = 0; i < seen.cols(); ++i)
      if (std::abs(eigen.eigenvectors()(i, q)) > 0.1) {
        const auto k = static_cast<std::size_t>(told[static_cast<std::size_t>(i)]);
        linear_[k] = false;
        vague_[k] = true;
      }
  }
}

LeastSquares AutocovarianceProblem::solve(const VectorXd& theta,
                                          const std::vector<int>& free) const {
  LeastSquares result = search(theta, free);
  // The search is slow along a bound: parameters that ended there are held there while the others
  // are computed, and released again if the gradient points inwards.
  for (int round = 0; !result.converged && round < 4; ++round) {
    std::vector<int> others;
    for (const int i : free)
      if (!result.at_zero[static_cast<std::size_t>(i)]) others.push_back(i);
    if (others.size() == free.size()) break;
    const std::vector<bool> held = result.at_zero;
    result = search(result.theta, others);
    for (const int i : free)
      if (held[static_cast<std::size_t>(i)]) result.at_zero[static_cast<std::size_t>(i)] = true;
    const Coordinates at = coordinates(free);
    result.converged = is_still({sampled_, map_, moments_, model_, vague_, result.theta, at},
                                z_of(result.theta, at));
    if (result.converged) break;
    VectorXd off = result.theta;
    for (const int i : free)
      if (held[static_cast<std::size_t>(i)]) off(i) = std::log(resolution(i));
    result = search(off, free);
  }
  return result;
}

Coordinates AutocovarianceProblem::coordinates(const std::vector<int>& free) const {
  Coordinates at{free, {}};
  at.scale.reserve(free.size());
  for (const int i : free) {
    const double scale = linear_[static_cast<std::size_t>(i)] ? resolution(i) : 0;
    at.scale.push_back(std::isfinite(scale) ? scale : 0);
  }
  return at;
}

LeastSquares AutocovarianceProblem::search(const VectorXd& theta,
                                           const std::vector<int>& free) const {
  LeastSquares result;
  result.theta = theta;
  result.at_zero.assign(model_.parameters.size(), false);
  if (free.empty()) {
    result.converged = true;
    result.cost = cost(theta);
    return result;
  }
  const Residuals residuals{sampled_, map_, moments_, model_, vague_, theta, coordinates(free)};
  const std::vector<double>& scale = residuals.at.scale;
  VectorXd z = z_of(theta, residuals.at);
  ceres::Problem problem;
  problem.AddResidualBlock(jets_of(residuals).release(), nullptr, z.data());
  for (std::size_t q = 0; q < free.size(); ++q)
    if (scale[q] > 0) problem.SetParameterLowerBound(z.data(), static_cast<int>(q), 0);
  ceres::Solver::Options options;
  options.linear_solver_type = ceres::DENSE_QR;
  options.logging_type = ceres::SILENT;
  options.max_num_iterations = 500;
  options.function_tolerance = 1e-15;
  options.gradient_tolerance = 1e-12;
  options.parameter_tolerance = 1e-12;
  ceres::Solver::Summary summary;
  ceres::Solve(options, &problem, &summary);
  result.converged = summary.IsSolutionUsable() && is_still(residuals, z);
  result.cost = summary.final_cost;
  for (std::size_t q = 0; q < free.size(); ++q) {
    const int i = free[q];
    const double value = z(static_cast<Index>(q));
    result.at_zero[static_cast<std::size_t>(i)] = scale[q] > 0 && !(value > 0);
    result.theta(i) = !(scale[q] > 0) ? value : value > 0 ? std::log(value * scale[q]) : kNothing;
  }
  return result;
}

double AutocovarianceProblem::misfit(const VectorXd& theta) const {
  return 0.5 * (map_ * term_values(sampled_, theta) - moments_).squaredNorm();
}

double AutocovarianceProblem::cost(const VectorXd& theta) const {
  double sum = misfit(theta);
  for (std::size_t i = 0; i < model_.parameters.size(); ++i) {
    const auto& prior = model_.parameters[i].prior;
    if (!prior || model_.parameters[i].fixed) continue;
    const double off = (theta(static_cast<Index>(i)) - std::log(prior->median)) / prior->deviation;
    sum += 0.5 * off * off;
  }
  return sum;
}

MatrixXd AutocovarianceProblem::information(const VectorXd& theta,
                                            const std::vector<int>& free) const {
  const auto p = theta.size();
  MatrixXd result = MatrixXd::Zero(p, p);
  if (free.empty()) return result;
  std::vector<bool> not_vague(vague_.size(), false);
  const Residuals residuals{sampled_,
                            map_,
                            moments_,
                            model_,
                            not_vague,
                            theta,
                            {free, std::vector<double>(free.size(), 0)}};
  const auto [r, J] = linearized(residuals, z_of(theta, residuals.at));
  result(free, free) = J.transpose() * J;
  return result;
}

double AutocovarianceProblem::distance(const VectorXd& a, const VectorXd& b) const {
  return (map_ * (term_values(sampled_, a) - term_values(sampled_, b))).norm();
}

double AutocovarianceProblem::resolution(int parameter) const {
  VectorXd column = VectorXd::Zero(map_.rows());
  for (std::size_t t = 0; t < sampled_.terms.size(); ++t)
    if (sampled_.terms[t].row < 0 && sampled_.terms[t].parameter == parameter)
      column += map_.col(static_cast<Index>(t));
  return 1 / column.norm();
}

}  // namespace quadtune::internal
