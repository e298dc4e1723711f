// SPDX-License-Identifier: Apache-2.0
#include "gains/gain_search.hpp"

#include <ceres/ceres.h>

#include <Eigen/Cholesky>
#include <Eigen/SVD>
#include <algorithm>
#include <cmath>
#include <numbers>
#include <random>

#include "quadtune/synthesis/lyapunov.hpp"

namespace quadtune::internal {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

/// Squared differences below this are rounding: the entries agree to about ten digits.
constexpr double kNoDifference = 1e-20;
/// Largest logarithm of the ratio of a weight to its start: 35 decades.
constexpr double kFar = 80;
/// Standard deviation of the logarithms of a random start: two decades.
constexpr double kSpread = 2 * std::numbers::ln10;

bool is_zero(const VectorXd& w, const std::vector<int>& group) { return w(group.front()) == 0; }

/// Groups of weights that are not 0.
std::vector<int> moving(const GainTarget& target, const VectorXd& w) {
  std::vector<int> result;
  for (std::size_t g = 0; g < target.groups.size(); ++g)
    if (!is_zero(w, target.groups[g])) result.push_back(static_cast<int>(g));
  return result;
}

/// w0 ∘ exp(z) over the groups in `free`.
VectorXd moved(const GainTarget& target, const VectorXd& w0, const std::vector<int>& free,
               const double* z) {
  VectorXd w = w0;
  for (std::size_t k = 0; k < free.size(); ++k)
    for (const int i : target.groups[static_cast<std::size_t>(free[k])]) w(i) *= std::exp(z[k]);
  return w;
}

/// The scaled differences as a cost function of Ceres.
class Differences : public ceres::CostFunction {
 public:
  Differences(const GainTarget& target, const VectorXd& w0, const std::vector<int>& free,
              GainSearch& counts)
      : target_(target), w0_(w0), free_(free), counts_(counts) {
    set_num_residuals(static_cast<int>(target.K.size()));
    mutable_parameter_block_sizes()->push_back(static_cast<int>(free.size()));
  }

  bool Evaluate(const double* const* z, double* r, double** jacobians) const override {
    if (counts_.stopped || (target_.interrupted && target_.interrupted())) {
      counts_.stopped = true;
      return false;
    }
    const auto n = static_cast<Index>(free_.size());
    const auto from_start = VectorXd::Map(z[0], n);
    if (!from_start.allFinite() || from_start.cwiseAbs().maxCoeff() > kFar) return false;
    ++counts_.evaluations;
    const GainPoint at = gain_point(target_, moved(target_, w0_, free_, z[0]));
    if (!at.solved()) return false;
    VectorXd::Map(r, num_residuals()) = at.r;
    if (jacobians == nullptr || jacobians[0] == nullptr) return true;
    const MatrixXd J = by_logarithms(target_, at)(Eigen::all, free_);
    using RowMajor = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>;
    Eigen::Map<RowMajor>(jacobians[0], num_residuals(), n) = J;
    return J.allFinite();
  }

 private:
  const GainTarget& target_;
  const VectorXd& w0_;
  const std::vector<int>& free_;
  GainSearch& counts_;
};

/// Levenberg–Marquardt from w0. Its steps are orthogonal to the directions that do not affect the
/// gain.
GainPoint descend(const GainTarget& target, const VectorXd& w0, GainSearch& counts) {
  GainPoint start = gain_point(target, w0);
  const std::vector<int> free = moving(target, w0);
  if (!start.solved() || free.empty()) return start;
  VectorXd z = VectorXd::Zero(static_cast<Index>(free.size()));
  ceres::Problem problem;
  problem.AddResidualBlock(new Differences(target, w0, free, counts), nullptr, z.data());
  ceres::Solver::Options options;
  options.linear_solver_type = ceres::DENSE_QR;
  options.logging_type = ceres::SILENT;
  options.max_num_iterations = 300;
  options.max_num_consecutive_invalid_steps = 30;
  options.function_tolerance = 1e-13;
  options.parameter_tolerance = 1e-15;
  options.gradient_tolerance = 1e-24;
  ceres::Solver::Summary summary;
  ceres::Solve(options, &problem, &summary);
  GainPoint end = gain_point(target, moved(target, w0, free, z.data()));
  return end.solved() && end.cost() <= start.cost() ? end : start;
}

/// The matrices of the plant of the Riccati equation, and whether it is discrete.
struct Plant {
  MatrixXd A, B;
  bool discrete;
};

Plant plant_of(const DiagonalLqr& problem) {
  return std::visit(
      [](const auto& plant) {
        return Plant{plant.A, plant.B, std::is_same_v<decltype(plant), const DiscreteLti&>};
      },
      problem.plant());
}

/// For each weight alone: the cost of the given gain, and the residual of its stationarity
/// condition; both are linear in the weights.
struct Stationarity {
  std::vector<MatrixXd> R;     ///< R + BᵀXB, or R
  std::vector<MatrixXd> miss;  ///< R K - Bᵀ X A_c - Nᵀ, A_c = I in continuous time
};

Stationarity stationarity(const GainTarget& target) {
  const auto [A, B, discrete] = plant_of(target.problem);
  const MatrixXd& K = target.K;
  const MatrixXd closed = A - B * K;
  Stationarity result;
  for (Index i = 0; i < target.problem.size(); ++i) {
    const LqrWeights unit = target.problem.weights(VectorXd::Unit(target.problem.size(), i));
    MatrixXd cost = unit.Q + K.transpose() * unit.R * K;
    if (unit.N.size() > 0) {
      const MatrixXd NK = unit.N * K;
      cost -= NK + NK.transpose();
    }
    cost = (0.5 * (cost + cost.transpose())).eval();
    const LyapunovResult X = discrete ? lyapunov_discrete(closed.transpose(), cost)
                                      : lyapunov_continuous(closed.transpose(), cost);
    const MatrixXd BX = B.transpose() * X.X;
    MatrixXd miss = unit.R * K;
    miss -= discrete ? MatrixXd(BX * closed) : BX;
    if (unit.N.size() > 0) miss -= unit.N.transpose();
    result.miss.push_back(std::move(miss));
    result.R.push_back(discrete ? MatrixXd(unit.R + BX * B) : unit.R);
  }
  return result;
}

/// Computes the weights closest to w in the space of the smallest singular vectors of the
/// stationarity residuals, which are multiplied by S⁻¹ at w. Negative results are raised to a small
/// positive value.
VectorXd stationary_round(const GainTarget& target, const Stationarity& of, const VectorXd& w) {
  const std::vector<int> free = moving(target, w);
  MatrixXd S = MatrixXd::Zero(target.K.rows(), target.K.rows());
  for (Index i = 0; i < w.size(); ++i) S += w(i) * of.R[static_cast<std::size_t>(i)];
  const Eigen::LDLT<MatrixXd> solver(S);
  MatrixXd M = MatrixXd::Zero(target.K.size(), static_cast<Index>(free.size()));
  for (std::size_t k = 0; k < free.size(); ++k)
    for (const int i : target.groups[static_cast<std::size_t>(free[k])]) {
      const MatrixXd step = solver.solve(of.miss[static_cast<std::size_t>(i)]);
      M.col(static_cast<Index>(k)) += w(i) * step.cwiseQuotient(target.scale).reshaped();
    }
  const VectorXd size = M.colwise().norm().transpose().cwiseMax(1e-12 * M.norm());
  if (!M.allFinite() || !(size.minCoeff() > 0)) return w;
  const Eigen::JacobiSVD<MatrixXd> svd(M * size.cwiseInverse().asDiagonal(), Eigen::ComputeFullV);
  const VectorXd& sigma = svd.singularValues();
  const double min = std::max(2 * sigma.minCoeff(), 1e-9 * sigma(0));
  VectorXd v = VectorXd::Zero(size.size());
  for (Index k = 0; k < svd.matrixV().cols(); ++k)
    if (k >= sigma.size() || sigma(k) <= min)
      v += svd.matrixV().col(k) * svd.matrixV().col(k).dot(size);
  v = v.cwiseQuotient(size).eval();
  if (!v.allFinite() || !(v.maxCoeff() > 0)) return w;
  const VectorXd z = v.cwiseMax(1e-8 * v.maxCoeff()).array().log();
  return moved(target, w, free, z.data());
}

/// Sets a weight to 0 if it became very small and 0 fits as well; the other weights are then
/// searched again.
void settle_zeros(const GainTarget& target, const VectorXd& w0, GainSearch& search) {
  constexpr double kDown = 1e-3, kSeen = 1e-9;
  // Restore the scale of the start, since the gain does not determine the common factor.
  const auto nu = target.problem.inputs();
  const double common =
      std::exp((search.best.w.tail(nu).array() / w0.tail(nu).array()).log().mean());
  for (std::size_t g = 0; g < target.groups.size(); ++g) {
    const int first = target.groups[g].front();
    if (first >= target.problem.states()) continue;  // the weight of an input must not be 0
    const double usual = common * w0(first);
    if (search.best.w(first) == 0 || search.best.w(first) > kDown * usual) continue;
    VectorXd w = search.best.w;
    for (const int i : target.groups[g]) w(i) = 0;
    GainPoint without = gain_point(target, w);
    if (!without.solved()) continue;
    const double sensitivity =
        usual * by_weights(target, without).col(static_cast<Index>(g)).norm();
    if (!(sensitivity > kSeen)) continue;  // not determined by the gain, which is handled elsewhere
    without = descend(target, w, search);
    if (search.stopped) return;
    if (without.cost() > (1 + 1e-6) * search.best.cost() + kNoDifference) continue;
    search.best = std::move(without);
    search.zeros.push_back(static_cast<int>(g));
  }
}

}  // namespace

GainPoint gain_point(const GainTarget& target, const VectorXd& w) {
  GainPoint at{w, target.problem.solve(w), {}};
  if (at.solved()) at.r = (at.solution.K - target.K).cwiseQuotient(target.scale).reshaped();
  return at;
}

MatrixXd by_weights(const GainTarget& target, const GainPoint& at) {
  const MatrixXd each = target.scale.reshaped().cwiseInverse().asDiagonal() *
                        target.problem.jacobian(at.w, at.solution);
  MatrixXd J = MatrixXd::Zero(each.rows(), std::ssize(target.groups));
  for (std::size_t g = 0; g < target.groups.size(); ++g)
    for (const int i : target.groups[g]) J.col(static_cast<Index>(g)) += each.col(i);
  return J;
}

MatrixXd by_logarithms(const GainTarget& target, const GainPoint& at) {
  MatrixXd J = by_weights(target, at);
  for (std::size_t g = 0; g < target.groups.size(); ++g)
    J.col(static_cast<Index>(g)) *= at.w(target.groups[g].front());
  return J;
}

VectorXd stationary_weights(const GainTarget& target, const VectorXd& w0) {
  const Stationarity of = stationarity(target);
  VectorXd w = w0;
  for (int round = 0; round < 3; ++round) w = stationary_round(target, of, w);
  return w;
}

GainSearch search_weights(const GainTarget& target, const VectorXd& w0, int max,
                          std::uint64_t seed) {
  GainSearch search;
  std::mt19937_64 random(seed);
  std::normal_distribution<double> normal(0, kSpread);
  const std::vector<int> free = moving(target, w0);
  std::vector<double> costs;
  for (int k = 0; k < max && !search.stopped; ++k) {
    VectorXd from = w0;
    if (k == 1) {
      from = stationary_weights(target, w0);
    } else if (k > 1) {
      VectorXd z(static_cast<Index>(free.size()));
      for (double& entry : z) entry = normal(random);
      from = moved(target, w0, free, z.data());
    }
    GainPoint end = descend(target, from, search);
    ++search.starts;
    if (!end.solved()) continue;
    costs.push_back(end.cost());
    if (!search.best.solved() || end.cost() < 0.999 * search.best.cost() - kNoDifference)
      search.best = std::move(end);
    if (search.best.cost() < kNoDifference) break;
  }
  if (search.stopped || !search.best.solved()) return search;
  const double best = search.best.cost();
  search.agreeing = static_cast<int>(std::count_if(costs.begin(), costs.end(), [&](double cost) {
    return cost <= 1.001 * best + kNoDifference;
  }));
  settle_zeros(target, w0, search);
  return search;
}

}  // namespace quadtune::internal
