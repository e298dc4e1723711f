// SPDX-License-Identifier: Apache-2.0
#include "noise/noise_description.hpp"

#include <fmt/format.h>

#include <Eigen/Eigenvalues>
#include <boost/math/tools/toms748_solve.hpp>
#include <cmath>

#include "quadtune/internal/joined.hpp"
#include "quadtune/internal/tails.hpp"

namespace quadtune::internal {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

/// Describes a direction of the free parameters along which the likelihood is constant.
void name_direction(const VectorXd& direction, const std::vector<int>& free,
                    std::vector<FittedParameter>& parameters, std::vector<std::string>& unseen) {
  std::vector<Index> main;
  const double max = direction.cwiseAbs().maxCoeff();
  for (Index q = 0; q < direction.size(); ++q)
    if (std::abs(direction(q)) > 0.3 * max) main.push_back(q);
  const auto parameter = [&](Index q) -> FittedParameter& {
    return parameters[static_cast<std::size_t>(free[static_cast<std::size_t>(q)])];
  };
  for (const Index q : main)
    parameter(q).verdict =
        main.size() == 1 ? ParameterVerdict::not_seen : ParameterVerdict::combination;
  if (main.size() == 1) {
    unseen.push_back(
        fmt::format("{}: the measurements do not determine it", parameter(main[0]).name));
    return;
  }
  const double a = direction(main[0]), b = direction(main[1]);
  if (main.size() == 2 && std::abs(std::abs(a) - std::abs(b)) < 0.2 * max) {
    unseen.push_back(fmt::format("only the {} of {} {} {} is determined",
                                 a * b > 0 ? "ratio" : "product", parameter(main[0]).name,
                                 a * b > 0 ? "to" : "and", parameter(main[1]).name));
    return;
  }
  std::vector<std::string> words;
  words.reserve(main.size());
  for (const Index q : main)
    words.push_back(fmt::format("{:+.2f} log {}", direction(q), parameter(q).name));
  unseen.push_back(fmt::format("not determined: {}", internal::joined(words, " ")));
}

}  // namespace

VectorXd chosen(const VectorXd& all, const std::vector<int>& free) { return all(free); }

MatrixXd chosen(const MatrixXd& all, const std::vector<int>& free) { return all(free, free); }

std::vector<FittedParameter> unfitted_parameters(const FilterModel& model) {
  std::vector<FittedParameter> parameters;
  parameters.reserve(model.parameters.size());
  for (const NoiseParameter& of : model.parameters) {
    FittedParameter& p = parameters.emplace_back();
    p.name = of.name;
    p.unit = of.unit;
    if (of.fixed) p.verdict = ParameterVerdict::fixed;
  }
  return parameters;
}

std::vector<FittedParameter> parameters_at(const FilterModel& model, const VectorXd& theta) {
  std::vector<FittedParameter> parameters = unfitted_parameters(model);
  for (std::size_t i = 0; i < parameters.size(); ++i) {
    const double entry = theta(static_cast<Index>(i));
    parameters[i].value = model.parameters[i].logarithmic ? std::exp(entry) : entry;
    if (!model.parameters[i].fixed) parameters[i].verdict = ParameterVerdict::not_known;
  }
  return parameters;
}

void name_unmeasured(FittedParameter& parameter, std::vector<std::string>& unseen) {
  parameter.verdict = ParameterVerdict::not_seen;
  unseen.push_back(fmt::format("{}: no measurement depends on it", parameter.name));
}

void describe_seen(const MatrixXd& information, const std::vector<int>& free,
                   std::vector<FittedParameter>& parameters, std::vector<std::string>& unseen) {
  const auto n = static_cast<Index>(free.size());
  if (n == 0) return;
  MatrixXd covariance = MatrixXd::Zero(n, n);
  const Eigen::SelfAdjointEigenSolver<MatrixXd> eigen(chosen(information, free));
  for (Index q = 0; q < n; ++q) {
    const VectorXd direction = eigen.eigenvectors().col(q);
    if (eigen.eigenvalues()(q) > kSeen)
      covariance += direction * direction.transpose() / eigen.eigenvalues()(q);
    else
      name_direction(direction, free, parameters, unseen);
  }
  for (Index q = 0; q < n; ++q) {
    FittedParameter& p = parameters[static_cast<std::size_t>(free[static_cast<std::size_t>(q)])];
    if (p.verdict == ParameterVerdict::seen) p.standard_error = std::sqrt(covariance(q, q));
  }
}

double edge_of_loss(const std::function<double(double)>& loss, double max, double centre, int side,
                    double step) {
  const auto over = [&](double value) { return loss(value) - max; };
  double inside = centre, outside = centre, before = -max, after = before;
  for (int tries = 0; tries < 40; ++tries) {
    outside = inside + side * step;
    after = over(outside);
    if (after > 0) break;
    inside = outside;
    before = after;
    step *= 1.5;
  }
  if (!(after > 0)) return std::numeric_limits<double>::quiet_NaN();
  std::uintmax_t tries = 60;
  const bool up = inside < outside;
  const auto bracket = boost::math::tools::toms748_solve(
      over, up ? inside : outside, up ? outside : inside, up ? before : after, up ? after : before,
      [](double a, double b) { return std::abs(a - b) < 1e-4; }, tries);
  return 0.5 * (bracket.first + bracket.second);
}

double deviations(double confidence) { return normal_exceeded(0.5 - 0.5 * confidence); }

}  // namespace quadtune::internal
