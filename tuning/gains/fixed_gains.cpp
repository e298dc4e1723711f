// SPDX-License-Identifier: Apache-2.0
#include "quadtune/tuning/fixed_gains.hpp"

#include <ceres/first_order_function.h>
#include <ceres/gradient_problem.h>
#include <ceres/gradient_problem_solver.h>
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <utility>

#include "quadtune/errors.hpp"
#include "quadtune/internal/enum_names.hpp"

namespace quadtune {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

constexpr const char* kWhere = "fixed gains";
/// The search tightens all bounds by kReserve; a bound holds if it is not exceeded by more than
/// kSlack.
constexpr double kReserve = 0.02;
constexpr double kSlack = 1e-3;

/// 1 + F_inner P at each frequency. The sensitivity of the outer loop is (1 + F_inner P)/(1 + F P).
Eigen::RowVectorXcd inner_loop(const FixedGainsMember& member, const Eigen::RowVectorXd& F) {
  Eigen::RowVectorXcd result = Eigen::RowVectorXcd::Ones(member.response.cols());
  for (const Index j : member.inner) result += F(j) * member.response.row(j);
  return result;
}

/// Returns Σ max(0, |S_outer|/Ms - 1)² over the frequencies and adds `share` times its gradient
/// with respect to F to `slope`.
double outer_penalty(const FixedGainsMember& member, const Eigen::RowVectorXd& F, double Ms,
                     double share, MatrixXd& slope) {
  if (member.inner.empty() || std::isinf(Ms)) return 0;
  const Eigen::RowVectorXcd inner = inner_loop(member, F);
  double sum = 0;
  for (Index i = 0; i < inner.size(); ++i) {
    const std::complex<double> whole = 1.0 + (F * member.response.col(i)).value();
    const double size = std::abs(inner(i)) / std::abs(whole) / Ms, excess = size - 1;
    if (!(excess > 0) || !std::isfinite(excess)) continue;
    sum += excess * excess;
    // d|z|/|z| = Re(dz/z)
    const double factor = share * 2 * excess * size;
    for (const Index j : member.inner)
      slope(0, j) += factor * (member.response(j, i) / inner(i)).real();
    for (Index j = 0; j < F.size(); ++j)
      slope(0, j) -= factor * (member.response(j, i) / whole).real();
  }
  return sum;
}

double product_of(const GainProductBound& bound, const MatrixXd& F) {
  double product = bound.factor;
  for (std::size_t j = 0; j < bound.powers.size(); ++j)
    product *= std::pow(std::abs(F(0, static_cast<Index>(j))), bound.powers[j]);
  return product;
}

/// Returns Σ max(0, product - 1)² with kReserve and adds `share` times its gradient with respect to
/// F to `slope`.
double product_penalty(const std::vector<GainProductBound>& bounds, const MatrixXd& F, double share,
                       MatrixXd& slope) {
  double sum = 0;
  for (const GainProductBound& bound : bounds) {
    const double product = product_of(bound, F) / (1 - kReserve), excess = product - 1;
    if (!(excess > 0)) continue;
    sum += excess * excess;
    for (std::size_t j = 0; j < bound.powers.size(); ++j)
      if (bound.powers[j] != 0)
        slope(0, static_cast<Index>(j)) +=
            share * 2 * excess * product * bound.powers[j] / F(0, static_cast<Index>(j));
  }
  return sum;
}

/// The costs of the members as a function of the free gains, each relative to its starting value.
class Costs {
 public:
  Costs(const std::vector<FixedGainsMember>& members, const MatrixXd& start,
        const std::vector<GainProductBound>& products)
      : members_(members), start_(start), products_(products), slope_(start.rows(), start.cols()) {
    for (Index j = 0; j < start.cols(); ++j)
      for (Index i = 0; i < start.rows(); ++i)
        if (start(i, j) != 0) free_.emplace_back(i, j);
  }

  [[nodiscard]] Index size() const { return std::ssize(free_); }
  [[nodiscard]] MatrixXd gains(const double* relative) const {
    MatrixXd F = MatrixXd::Zero(start_.rows(), start_.cols());
    for (std::size_t n = 0; n < free_.size(); ++n)
      F(free_[n].first, free_[n].second) = relative[n] * start_(free_[n].first, free_[n].second);
    return F;
  }

  /// Computes Σ weight · cost; returns false if a member is unstable, whose index is then in
  /// `at_fault`.
  bool evaluate(const MatrixXd& F, double& cost) {
    ++evaluations;
    cost = 0;
    slope_.setZero();
    for (std::size_t m = 0; m < members_.size(); ++m) {
      const OutputFeedbackCost one = output_feedback_cost(members_[m].problem, F);
      if (!one.stable || !std::isfinite(one.cost) || !one.slope.allFinite()) {
        at_fault = m;
        return false;
      }
      cost += members_[m].weight * one.cost;
      slope_ += members_[m].weight * one.slope;
    }
    return true;
  }

  /// Returns Σ penalty and adds `share` times its gradient to that of the cost.
  double penalize(const MatrixXd& F, double share) {
    double sum = product_penalty(products_, F, share, slope_);
    for (const FixedGainsMember& member : members_) {
      if (member.response.size() == 0) continue;
      const MarginPenalty one = margin_penalty(member.response, F.row(0), tightened(member.bounds));
      sum += one.penalty;
      slope_.row(0) += share * one.slope;
      sum += outer_penalty(member, F.row(0), member.outer_Ms * (1 - kReserve), share, slope_);
    }
    return sum;
  }

  /// The gradient with respect to relative changes of the gains.
  void slope(double* result, double share) const {
    for (std::size_t n = 0; n < free_.size(); ++n) {
      const auto [i, j] = free_[n];
      result[n] = share * slope_(i, j) * start_(i, j);
    }
  }

  /// The largest relative violation, and the index of its member.
  [[nodiscard]] std::pair<double, std::size_t> violation(const MatrixXd& F) const {
    std::pair<double, std::size_t> worst{-1, 0};
    for (const GainProductBound& bound : products_)
      worst = std::max(worst, {product_of(bound, F) - 1, members_.size()});
    for (std::size_t m = 0; m < members_.size(); ++m) {
      if (members_[m].response.size() == 0) continue;
      const MarginBounds& bounds = members_[m].bounds;
      const Eigen::RowVectorXcd L = F.row(0) * members_[m].response;
      const Eigen::RowVectorXcd inner = inner_loop(members_[m], F.row(0));
      for (Index i = 0; i < L.size() && !members_[m].inner.empty(); ++i) {
        const double S = std::abs(inner(i)) / std::abs(1.0 + L(i));
        if (std::isfinite(S)) worst = std::max(worst, {1 - members_[m].outer_Ms / S, m});
      }
      for (const std::complex<double>& at : L) {
        const double p = std::abs(1.0 + at);
        if (!std::isfinite(p)) continue;
        worst = std::max(worst, {1 - bounds.Ms * p, m});
        worst = std::max(worst, {1 - p / (bounds.disk * std::abs(1.0 - at) / 2), m});
      }
    }
    return worst;
  }

  int evaluations = 0;
  std::size_t at_fault = 0;

 private:
  static MarginBounds tightened(const MarginBounds& bounds) {
    return {bounds.Ms * (1 - kReserve), bounds.disk * (1 + kReserve)};
  }

  const std::vector<FixedGainsMember>& members_;
  const MatrixXd& start_;
  const std::vector<GainProductBound>& products_;
  std::vector<std::pair<Index, Index>> free_;
  MatrixXd slope_;
};

/// cost/scale + share · penalty.
class Objective : public ceres::FirstOrderFunction {
 public:
  Objective(Costs& costs, double scale, double share)
      : costs_(costs), scale_(scale), share_(share) {}

  bool Evaluate(const double* x, double* value, double* slope) const override {
    const MatrixXd F = costs_.gains(x);
    double cost = 0;
    if (!costs_.evaluate(F, cost)) return false;
    *value = cost / scale_;
    if (share_ > 0) *value += share_ * costs_.penalize(F, share_ * scale_);
    if (slope != nullptr) costs_.slope(slope, 1 / scale_);
    return true;
  }
  [[nodiscard]] int NumParameters() const override { return static_cast<int>(costs_.size()); }

 private:
  Costs& costs_;
  double scale_;
  double share_;
};

void require(const std::vector<FixedGainsMember>& members, const MatrixXd& start,
             const FixedGainsOptions& options) {
  if (members.empty())
    throw InvalidInput(kWhere, "there is no member; expected at least one plant");
  if (start.isZero(0))
    throw InvalidInput(kWhere,
                       "every starting gain is 0; expected a nonzero free gain, because "
                       "gains of 0 stay 0");
  for (const GainProductBound& bound : options.products)
    if (start.rows() != 1 || std::ssize(bound.powers) != start.cols() || !(bound.factor > 0))
      throw InvalidInput(kWhere,
                         fmt::format("a bound on the product of the gains has {} powers and "
                                     "the factor {}; expected {} powers, a factor > 0 and "
                                     "a law with one input",
                                     bound.powers.size(), bound.factor, start.cols()));
  if (options.max_iterations < 1)
    throw InvalidInput(
        kWhere, fmt::format("max_iterations is {}, expected at least 1", options.max_iterations));
  for (const FixedGainsMember& member : members) {
    if (!(member.weight >= 0) || !std::isfinite(member.weight))
      throw InvalidInput(kWhere, fmt::format("the weight of '{}' is {}, expected 0 or more",
                                             member.name, member.weight));
    if (member.response.size() == 0) continue;
    if (start.rows() != 1)
      throw InvalidInput(kWhere, fmt::format("the margins of '{}' are bounded and the law has {} "
                                             "inputs; expected a law with one input",
                                             member.name, start.rows()));
    if (!(member.bounds.Ms > 1) || !(member.bounds.disk > 0) || !(member.bounds.disk < 2))
      throw InvalidInput(kWhere,
                         fmt::format("the bounds of '{}' are Ms {} and disk {}; expected Ms "
                                     "> 1 and a disk between 0 and 2",
                                     member.name, member.bounds.Ms, member.bounds.disk));
    if (!(member.outer_Ms > 1))
      throw InvalidInput(kWhere, fmt::format("the bound of the outer loop of '{}' is Ms {}, "
                                             "expected more than 1",
                                             member.name, member.outer_Ms));
    for (const Index j : member.inner)
      if (j < 0 || j >= start.cols())
        throw InvalidInput(
            kWhere, fmt::format("output {} of the inner loop of '{}' is not one of the {} outputs",
                                j + 1, member.name, start.cols()));
  }
}

}  // namespace

constexpr internal::EnumName<FixedGainsStatus> kFixedGainsStatuses[] = {
    {FixedGainsStatus::not_run, "not run"},
    {FixedGainsStatus::solved, "solved"},
    {FixedGainsStatus::unstable_start, "unstable start"},
    {FixedGainsStatus::bounds_violated, "bounds violated"},
    {FixedGainsStatus::no_convergence, "no convergence"}};

std::string to_string(FixedGainsStatus status) {
  return internal::name_in(kFixedGainsStatuses, status);
}

FixedGainsResult fixed_gains(const std::vector<FixedGainsMember>& members, const MatrixXd& start,
                             const FixedGainsOptions& options) {
  require(members, start, options);
  FixedGainsResult result;
  result.F = start;
  Costs costs(members, start, options.products);
  if (!costs.evaluate(start, result.start_cost)) {
    result.status = FixedGainsStatus::unstable_start;
    result.culprit = members[costs.at_fault].name;
    return result;
  }
  result.cost = result.start_cost;
  VectorXd x = VectorXd::Ones(costs.size());
  ceres::GradientProblemSolver::Options solver;
  solver.line_search_direction_type = ceres::BFGS;
  solver.max_num_iterations = options.max_iterations;
  solver.gradient_tolerance = options.gradient_tolerance;
  solver.function_tolerance = 1e-14;
  solver.parameter_tolerance = 1e-12;
  solver.logging_type = ceres::SILENT;
  const bool bounded = !options.products.empty() ||
                       std::any_of(members.begin(), members.end(),
                                   [](const FixedGainsMember& m) { return m.response.size() > 0; });
  // The weight of the penalty; the minimum moves inside the bounds as the weight grows.
  const std::vector<double> shares =
      bounded ? std::vector<double>{1, 10, 100, 1000, 1e4} : std::vector<double>{0};
  bool converged = false;
  for (const double share : shares) {
    const ceres::GradientProblem problem(new Objective(costs, result.start_cost, share));
    ceres::GradientProblemSolver::Summary summary;
    ceres::Solve(solver, problem, x.data(), &summary);
    // If the line search finds no lower value, the search has reached rounding error.
    converged = summary.termination_type != ceres::NO_CONVERGENCE;
    if (bounded && costs.violation(costs.gains(x.data())).first <= kSlack) break;
  }
  result.F = costs.gains(x.data());
  VectorXd slope = VectorXd::Zero(x.size());
  if (costs.evaluate(result.F, result.cost)) costs.slope(slope.data(), 1 / result.cost);
  result.slope = slope.cwiseAbs().maxCoeff();
  result.evaluations = costs.evaluations;
  const auto [violation, whose] = costs.violation(result.F);
  result.violation = bounded ? violation : 0;
  if (bounded && violation > kSlack) {
    result.status = FixedGainsStatus::bounds_violated;
    result.culprit = whose < members.size() ? members[whose].name : "the product of the gains";
  } else if (!converged) {
    result.status = FixedGainsStatus::no_convergence;
    result.culprit = fmt::format("{} iterations", options.max_iterations);
  } else {
    result.status = FixedGainsStatus::solved;
  }
  return result;
}

}  // namespace quadtune
