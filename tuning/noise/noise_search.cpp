// SPDX-License-Identifier: Apache-2.0
#include "noise/noise_search.hpp"

#include <ceres/gradient_problem.h>
#include <ceres/gradient_problem_solver.h>

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>
#include <memory>
#include <mutex>

#include "noise/noise_description.hpp"
#include "quadtune/errors.hpp"
#include "quadtune/internal/in_parallel.hpp"

namespace quadtune::internal {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

/// Gradient, in coordinates of standard deviations, at which a search has converged.
constexpr double kConverged = 1e-6;
/// Directions with less information are treated as if they had this information, so that their
/// steps stay within a few e-folds.
constexpr double kMinInformation = 0.1;
/// Share of a parameter in flat directions (at most 1) from which on long steps are tried along it.
constexpr double kMinShare = 0.01;
/// Slope of a flat direction at which a search ends: the slope decays exponentially, so the
/// remaining gain is about as large.
constexpr double kMinGain = 1e-4;
/// Rounding error of a sum relative to the size of its terms: 7e-13 was observed with eight million
/// terms.
constexpr double kSearchRounding = 1e-11;
/// Gradient at which a rough search has converged.
constexpr double kNearEnough = 1e-2;
/// Minimum gain of log-likelihood of a long step.
constexpr double kGain = 1e-3;

/// Coordinates in which the information is the identity, except where it is small.
struct Whitening {
  MatrixXd W;             ///< θ = centre + W z
  std::vector<int> flat;  ///< entries of θ with a share in directions with little information
  bool still = false;     ///< the search has converged
};

/// @param information, gradient  of the entries `free`
Whitening whitening(const MatrixXd& information, const VectorXd& gradient,
                    const std::vector<int>& free, bool rough) {
  const Eigen::SelfAdjointEigenSolver<MatrixXd> eigen(information);
  const VectorXd known = eigen.eigenvalues().cwiseMax(kMinInformation);
  Whitening result;
  result.W = eigen.eigenvectors() * known.cwiseSqrt().cwiseInverse().asDiagonal();
  VectorXd share = VectorXd::Zero(known.size());
  for (Index q = 0; q < known.size(); ++q)
    if (eigen.eigenvalues()(q) < kMinInformation) share += eigen.eigenvectors().col(q).cwiseAbs2();
  for (Index i = 0; i < share.size(); ++i)
    if (share(i) > kMinShare) result.flat.push_back(free[static_cast<std::size_t>(i)]);
  const VectorXd slope = eigen.eigenvectors().transpose() * gradient;
  result.still = true;
  for (Index q = 0; q < slope.size(); ++q) {
    const bool is_flat = eigen.eigenvalues()(q) < kMinInformation;
    result.still =
        result.still &&
        std::abs(slope(q)) <
            (is_flat ? kMinGain : (rough ? kNearEnough : kConverged) * std::sqrt(known(q)));
  }
  return result;
}

/// θ = centre + W z on the free entries.
class Whitened final : public ceres::FirstOrderFunction {
 public:
  Whitened(const NoiseObjective& objective, VectorXd centre, double offset, MatrixXd W,
           const std::vector<int>& free, bool& interrupted)
      : objective_(objective),
        centre_(std::move(centre)),
        offset_(offset),
        W_(std::move(W)),
        free_(free),
        interrupted_(interrupted) {}

  [[nodiscard]] VectorXd theta(const double* z) const {
    const VectorXd step = W_ * Eigen::Map<const VectorXd>(z, W_.cols());
    VectorXd result = centre_;
    for (Index i = 0; i < step.size(); ++i) result(free_[static_cast<std::size_t>(i)]) += step(i);
    return result;
  }

  bool Evaluate(const double* z, double* cost, double* gradient) const override {
    const VectorXd there = theta(z);
    if (interrupted_ || !there.allFinite()) return false;
    try {
      const auto at = objective_.at(
          there, gradient == nullptr ? LikelihoodOrder::value : LikelihoodOrder::gradient);
      if (!at.computed) return false;
      *cost = offset_ - at.value;
      if (gradient != nullptr)
        Eigen::Map<VectorXd>(gradient, W_.cols()) = -W_.transpose() * chosen(at.gradient, free_);
      return true;
    } catch (const Interrupted&) {
      interrupted_ = true;  // exceptions must not propagate through Ceres
      return false;
    }
  }

  [[nodiscard]] int NumParameters() const override { return static_cast<int>(W_.cols()); }

 private:
  const NoiseObjective& objective_;
  VectorXd centre_;
  double offset_;
  MatrixXd W_;
  const std::vector<int>& free_;
  bool& interrupted_;
};

/// Far from the optimum the likelihood is flat: a noise that is too small by orders of magnitude
/// has no effect. Long steps along one logarithm at a time leave such a region.
void stride(const NoiseObjective& objective, const VectorXd& start, const std::vector<int>& flat,
            SearchResult& result) {
  const std::vector<NoiseParameter>& parameters = objective.likelihood().model().parameters;
  for (int halved = 0; halved < 8; ++halved)
    for (const int i : flat) {
      const double stride = 128 / std::exp2(halved);
      if (!parameters[static_cast<std::size_t>(i)].logarithmic) continue;
      // From the current point, and from the start, since a search may have moved far down a flat
      // slope.
      std::vector<double> targets = {result.theta(i) + stride, result.theta(i) - stride};
      if (result.theta(i) != start(i))
        targets.insert(targets.end(), {start(i) + stride, start(i) - stride});
      for (const double to : targets) {
        VectorXd there = result.theta;
        there(i) = to;
        const auto at = objective.at(there, LikelihoodOrder::value);
        if (!at.computed || !(at.value > result.value + kGain)) continue;
        result.theta = there;
        result.value = at.value;
        break;
      }
    }
}

/// Newton steps with a constant curvature, halved if necessary: they remove the error that a
/// quasi-Newton search leaves.
void polish(const NoiseObjective& objective, const std::vector<int>& free, SearchResult& result) {
  const Eigen::SelfAdjointEigenSolver<MatrixXd> eigen(
      chosen(objective.curvature(result.theta, free), free));
  // In the directions with enough information.
  MatrixXd inverse = MatrixXd::Zero(eigen.eigenvalues().size(), eigen.eigenvalues().size());
  for (Index q = 0; q < inverse.cols(); ++q)
    if (eigen.eigenvalues()(q) > kMinInformation)
      inverse += eigen.eigenvectors().col(q) * eigen.eigenvectors().col(q).transpose() /
                 eigen.eigenvalues()(q);
  auto at = objective.at(result.theta, LikelihoodOrder::gradient);
  for (int round = 0; round < 4 && at.computed; ++round) {
    const VectorXd g = chosen(at.gradient, free);
    if (g.dot(inverse * g) < 1e-20) break;
    const VectorXd step = inverse * g;
    VectorXd theta = result.theta;
    for (Index i = 0; i < step.size(); ++i) theta(free[static_cast<std::size_t>(i)]) += step(i);
    const auto there = objective.at(theta, LikelihoodOrder::gradient);
    // The gain of a last step is below the rounding error of the sum.
    if (!there.computed || there.value < at.value - at.rounding ||
        !(chosen(there.gradient, free).norm() < g.norm()))
      break;
    result.theta = theta;
    result.value = there.value;
    at = there;
  }
}

/// BFGS of Ceres from result.theta, where `at` was evaluated.
void quasi_newton(const NoiseObjective& objective, const MatrixXd& W, bool flat, int max_iterations,
                  const std::vector<int>& free, const NoiseObjective::Value& at,
                  SearchResult& result) {
  ceres::GradientProblemSolver::Options options;
  options.line_search_direction_type = ceres::BFGS;
  options.max_num_iterations = max_iterations;
  options.logging_type = ceres::SILENT;
  options.function_tolerance = 1e-14;
  options.parameter_tolerance = 0;
  // The rest is left to Newton's method, which does not apply to a flat direction.
  options.gradient_tolerance = flat ? 1e-5 : 1e-3;
  bool interrupted = false;
  const Whitened whitened(objective, result.theta, at.value, W, free, interrupted);
  ceres::GradientProblem problem(new Whitened(whitened));
  VectorXd z = VectorXd::Zero(W.cols());
  ceres::GradientProblemSolver::Summary summary;
  ceres::Solve(options, problem, z.data(), &summary);
  if (interrupted) throw Interrupted();
  const VectorXd theta = whitened.theta(z.data());
  const auto there = objective.at(theta, LikelihoodOrder::value);
  if (!there.computed || !(there.value > at.value)) return;
  result.theta = theta;
  result.value = there.value;
}

}  // namespace

NoiseObjective::Value NoiseObjective::at(const VectorXd& theta, LikelihoodOrder order) const {
  ++evaluations_;
  if (!theta.allFinite()) return {};
  Likelihood likelihood = likelihood_.evaluate(theta, order);
  Value result{likelihood.computed(), likelihood.value, likelihood.gradient,
               likelihood.information};
  result.rounding =
      kSearchRounding * (std::abs(likelihood.value) + static_cast<double>(likelihood.innovations));
  const FilterModel& model = likelihood_.model();
  for (std::size_t i = 0; i < model.parameters.size(); ++i) {
    if (!model.parameters[i].prior) continue;
    const NoisePrior& prior = *model.parameters[i].prior;
    const auto k = static_cast<Index>(i);
    const double precision = 1 / (prior.deviation * prior.deviation);
    const double off = theta(k) - std::log(prior.median);
    result.value -= 0.5 * off * off * precision;
    if (result.gradient.size() > 0) result.gradient(k) -= off * precision;
    if (result.information.size() > 0) result.information(k, k) += precision;
  }
  if (!result.computed) return result;
  if (best_.theta.size() == 0 || result.value > best_.value) {
    likelihood.gradient.resize(0);
    likelihood.information.resize(0, 0);
    best_ = {theta, result.value, std::move(likelihood)};
  }
  if (report_) report_(result.value);
  return result;
}

void NoiseObjective::in_parallel(
    std::size_t parts, const std::function<void(std::size_t, const NoiseObjective&)>& one) const {
  // Each thread has its own copy; their results are added when all have finished.
  struct Thread {
    InnovationLikelihood likelihood;
    NoiseObjective objective;
    Thread(const InnovationLikelihood& of, const std::function<void(double)>& report)
        : likelihood(of), objective(likelihood, 1, report) {}
  };
  std::mutex mutex;
  std::vector<std::unique_ptr<Thread>> threads;
  const auto add_up = [&] {
    for (const auto& thread : threads) {
      evaluations_ += thread->objective.evaluations();
      const Best& best = thread->objective.best();
      if (best.theta.size() > 0 && (best_.theta.size() == 0 || best.value > best_.value))
        best_ = best;
    }
  };
  try {
    internal::in_parallel(
        parts, thread_count(threads_),
        [&]() -> PartWorker {
          const std::lock_guard lock(mutex);
          const NoiseObjective& objective =
              threads.emplace_back(std::make_unique<Thread>(likelihood_, report_))->objective;
          return [&one, &objective](std::size_t part) { one(part, objective); };
        },
        {});
  } catch (const Interrupted&) {
    add_up();
    throw;
  }
  add_up();
}

MatrixXd NoiseObjective::curvature(const VectorXd& theta, const std::vector<int>& free) const {
  constexpr double h = 1e-4;
  MatrixXd result = MatrixXd::Zero(theta.size(), theta.size());
  const auto column = [&](std::size_t part, const NoiseObjective& objective) {
    const int i = free[part];
    VectorXd there = theta;
    there(i) = theta(i) + h;
    const Value above = objective.at(there, LikelihoodOrder::gradient);
    there(i) = theta(i) - h;
    const Value below = objective.at(there, LikelihoodOrder::gradient);
    if (!above.computed || !below.computed) return;
    for (const int j : free) result(j, i) = (below.gradient(j) - above.gradient(j)) / (2 * h);
  };
  if (threads_ == 1)
    for (std::size_t part = 0; part < free.size(); ++part) column(part, *this);
  else
    in_parallel(free.size(), column);
  return 0.5 * (result + result.transpose());
}

SearchResult search(const NoiseObjective& objective, const VectorXd& start,
                    const std::vector<int>& free, const SearchOptions& options) {
  SearchResult result;
  result.theta = start;
  auto at = objective.at(start, LikelihoodOrder::information);
  result.computed = at.computed;
  result.value = at.value;
  if (!at.computed) return result;
  if (free.empty()) {
    result.converged = true;
    return result;
  }
  bool strode = false;
  for (int round = 0; round < 20; ++round) {
    const auto [W, flat, still] =
        whitening(chosen(at.information, free), chosen(at.gradient, free), free, options.rough);
    if (!flat.empty() && !strode && options.strides) {
      strode = true;
      stride(objective, start, flat, result);
      if (result.value > at.value) {
        at = objective.at(result.theta, LikelihoodOrder::information);
        continue;
      }
    }
    if (still) {
      result.converged = true;
      break;
    }
    const VectorXd before = result.theta;
    quasi_newton(objective, W, !flat.empty(), options.max_iterations, free, at, result);
    // Newton's method may succeed if a line search fails.
    if (!options.rough || result.theta == before) polish(objective, free, result);
    if (result.theta == before) break;
    strode = false;
    at = objective.at(result.theta, LikelihoodOrder::information);
  }
  result.information = at.information;
  return result;
}

}  // namespace quadtune::internal
