// SPDX-License-Identifier: Apache-2.0
#include "quadtune/tuning/match_gains.hpp"

#include <fmt/format.h>

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>
#include <complex>

#include "gains/gain_optimality.hpp"
#include "gains/gain_search.hpp"
#include "gains/weight_description.hpp"
#include "quadtune/errors.hpp"
#include "quadtune/internal/counted.hpp"
#include "quadtune/internal/enum_names.hpp"
#include "quadtune/internal/joined.hpp"
#include "quadtune/internal/suggest.hpp"
#include "quadtune/internal/text_file.hpp"
#include "quadtune/matrix_checks.hpp"

namespace quadtune {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;
using internal::GainPoint;
using internal::GainTarget;

constexpr char kMatchWhere[] = "match_gains";
/// Minimum scale of a difference, relative to the largest entry of its row and of the matrix.
constexpr double kMinInRow = 1e-6;
constexpr double kMin = 1e-9;

void check(const MatrixXd& K, const DiagonalLqr& problem, const VectorXd& w0,
           const GainMatchOptions& options) {
  require_shape(K, problem.inputs(), problem.states(), kMatchWhere, "[K K_int]",
                "one row per input, one column per state and integral");
  require_finite(K, kMatchWhere, "[K K_int]");
  if (K.isZero(0)) throw InvalidInput(kMatchWhere, "the gain is 0; expected a nonzero gain");
  if (w0.size() != problem.size())
    throw InvalidInput(kMatchWhere,
                       fmt::format("there are {} weights; expected {} ({})", w0.size(),
                                   problem.size(), internal::joined(problem.names(), " ")));
  for (Index i = 0; i < w0.size(); ++i)
    if (!std::isfinite(w0(i)) || w0(i) < 0 || (w0(i) == 0 && i >= problem.states()))
      throw InvalidInput(kMatchWhere,
                         fmt::format("the weight of {} is {}, expected {}",
                                     problem.names()[static_cast<std::size_t>(i)], w0(i),
                                     i < problem.states() ? "0 or more" : "more than 0"));
  if (!(options.tolerance > 0) || !std::isfinite(options.tolerance))
    throw InvalidInput(kMatchWhere, fmt::format("the tolerance is {}, expected a positive number",
                                                options.tolerance));
  if (options.starts < 1)
    throw InvalidInput(kMatchWhere, fmt::format("{} starts, expected 1 or more", options.starts));
}

/// Scale of the difference of each entry.
MatrixXd scale_of(const MatrixXd& K) {
  const MatrixXd size = K.cwiseAbs();
  const VectorXd row = size.rowwise().maxCoeff();
  const Eigen::RowVectorXd column = size.colwise().maxCoeff();
  MatrixXd scale(K.rows(), K.cols());
  for (Index i = 0; i < K.rows(); ++i)
    for (Index j = 0; j < K.cols(); ++j)
      scale(i, j) =
          std::max({std::min(row(i), column(j)), kMinInRow * row(i), kMin * size.maxCoeff()});
  return scale;
}

/// Groups of the weights: tied weights together, each other weight alone.
std::vector<std::vector<int>> groups_of(const std::vector<std::string>& names,
                                        const std::vector<std::vector<std::string>>& ties) {
  std::vector<std::vector<int>> groups;
  std::vector<bool> tied(names.size(), false);
  for (const std::vector<std::string>& tie : ties) {
    std::vector<int>& group = groups.emplace_back();
    for (const std::string& name : tie) {
      const auto found = std::find(names.begin(), names.end(), name);
      if (found == names.end())
        throw InvalidInput(
            kMatchWhere,
            fmt::format("cannot tie the weight of '{}': unknown name; expected some of: {}{}",
                        internal::printable(name), internal::joined(names, " "),
                        internal::did_you_mean(name, names)));
      const auto index = static_cast<std::size_t>(found - names.begin());
      if (tied[index])
        throw InvalidInput(kMatchWhere,
                           fmt::format("'{}' is in more than one tie; expected at most one", name));
      tied[index] = true;
      group.push_back(static_cast<int>(index));
    }
    if (group.size() < 2)
      throw InvalidInput(kMatchWhere, fmt::format("a tie has {}; expected 2 or more",
                                                  internal::counted(group.size(), "weight")));
  }
  for (std::size_t i = 0; i < names.size(); ++i)
    if (!tied[i]) groups.push_back({static_cast<int>(i)});
  std::sort(groups.begin(), groups.end(), [](const auto& a, const auto& b) {
    return *std::min_element(a.begin(), a.end()) < *std::min_element(b.begin(), b.end());
  });
  return groups;
}

/// Tied weights start at their geometric mean.
void level_ties(const DiagonalLqr& problem, const std::vector<std::vector<int>>& groups,
                VectorXd& w) {
  const Index n = problem.states();
  for (const std::vector<int>& group : groups) {
    double sum = 0;
    for (const int i : group) {
      const std::string& name = problem.names()[static_cast<std::size_t>(i)];
      const std::string& first = problem.names()[static_cast<std::size_t>(group.front())];
      if ((i < n) != (group.front() < n))
        throw InvalidInput(
            kMatchWhere, fmt::format("'{}' and '{}' are tied; expected only states or only inputs, "
                                     "because Q and R are in different units",
                                     first, name));
      if ((w(i) == 0) != (w(group.front()) == 0))
        throw InvalidInput(kMatchWhere,
                           fmt::format("'{}' and '{}' are tied and one of them has the "
                                       "weight 0; expected both or neither",
                                       first, name));
      sum += std::log(w(i));
    }
    if (w(group.front()) == 0) continue;
    for (const int i : group) w(i) = std::exp(sum / static_cast<double>(group.size()));
  }
}

/// "Q(x)", "Q_integral(x)", "R(w1)"
std::string weight_name(const DiagonalLqr& problem, const LqrDesign& design, Index i) {
  const auto nx = problem.states() - std::ssize(design.integrals);
  if (i >= nx && i < problem.states())
    return fmt::format("Q_integral({})", design.integrals[static_cast<std::size_t>(i - nx)]);
  return fmt::format("{}({})", i < nx ? "Q" : "R", problem.names()[static_cast<std::size_t>(i)]);
}

/// Describes the unstable pole of the loop of the given gain; empty if the loop is stable.
std::string unstable_pole(const DiagonalLqr& problem, const MatrixXd& K) {
  return std::visit(
      [&](const auto& plant) -> std::string {
        constexpr bool discrete = std::is_same_v<decltype(plant), const DiscreteLti&>;
        const MatrixXd loop = plant.A - plant.B * K;
        const Eigen::VectorXcd poles = loop.eigenvalues();
        const double worst = discrete ? poles.cwiseAbs().maxCoeff() : poles.real().maxCoeff();
        // The pole of an integral that is not fed back is on the stability limit, up to rounding.
        const double rounding = 1e-13 * (discrete ? 1 : loop.norm());
        if (worst < (discrete ? 1 : 0) - rounding) return "";
        return discrete
                   ? fmt::format("a pole of modulus {:.6g}, expected less than 1", worst)
                   : fmt::format("a pole of real part {:.6g} 1/s, expected less than 0", worst);
      },
      problem.plant());
}

/// The entry with the largest difference.
struct Worst {
  double value = 0;
  Index row = 0, column = 0;
};
Worst worst_of(const GainTarget& target, const GainPoint& at) {
  Worst worst;
  const MatrixXd r = at.r.reshaped(target.K.rows(), target.K.cols());
  worst.value = r.cwiseAbs().maxCoeff(&worst.row, &worst.column);
  return worst;
}

void tell_differences(const GainTarget& target, const GainPoint& start, const GainPoint& best,
                      const LqrDesign& design, GainMatch& match) {
  if (start.solved()) match.before = worst_of(target, start).value;
  const Worst worst = worst_of(target, best);
  match.after = worst.value;
  const auto nx = target.K.cols() - std::ssize(design.integrals);
  const std::string input =
      target.problem.names()[static_cast<std::size_t>(target.problem.states() + worst.row)];
  match.worst = worst.column < nx
                    ? fmt::format("K({}, {})", input,
                                  target.problem.names()[static_cast<std::size_t>(worst.column)])
                    : fmt::format("K_int({}, {})", input,
                                  design.integrals[static_cast<std::size_t>(worst.column - nx)]);
  match.given = target.K(worst.row, worst.column);
  match.found = best.solution.K(worst.row, worst.column);
}

/// Names, intervals and verdicts of the weights; tied weights share theirs.
void tell_weights(const GainTarget& target, const VectorXd& w0, const GainPoint& best,
                  const LqrDesign& design, double tolerance, GainMatch& match) {
  const auto count = std::ssize(target.groups);
  internal::WeightKnowledge knowledge;
  knowledge.values = knowledge.share_of_R = VectorXd::Zero(count);
  for (Index g = 0; g < count; ++g) {
    const std::vector<int>& group = target.groups[static_cast<std::size_t>(g)];
    std::vector<std::string> names;
    for (const int i : group) {
      names.push_back(weight_name(target.problem, design, i));
      if (i >= target.problem.states())
        knowledge.share_of_R(g) += 1 / static_cast<double>(target.problem.inputs());
    }
    knowledge.names.push_back(fmt::format("{}", internal::joined(names, " = ")));
    knowledge.values(g) = best.w(group.front());
    knowledge.fixed.push_back(w0(group.front()) == 0);
  }
  knowledge.by_logarithms = internal::by_logarithms(target, best);
  knowledge.by_weights = internal::by_weights(target, best);
  knowledge.tolerance = tolerance;
  std::vector<MatchedWeight> groups(static_cast<std::size_t>(count));
  internal::describe_weights(knowledge, groups, match.unseen);
  match.weights.resize(static_cast<std::size_t>(w0.size()));
  for (std::size_t g = 0; g < groups.size(); ++g)
    for (const int i : target.groups[g]) {
      MatchedWeight& weight = match.weights[static_cast<std::size_t>(i)];
      weight = groups[g];
      weight.name = weight_name(target.problem, design, i);
      weight.before = w0(i);
    }
}

}  // namespace

constexpr internal::EnumName<GainMatchStatus> kGainMatchStatuses[] = {
    {GainMatchStatus::not_run, "not run"},
    {GainMatchStatus::matched, "matched"},
    {GainMatchStatus::not_matched, "not matched"},
    {GainMatchStatus::not_stabilizing, "not stabilizing"},
    {GainMatchStatus::no_solution, "no solution"},
    {GainMatchStatus::interrupted, "interrupted"}};

std::string to_string(GainMatchStatus status) {
  return internal::name_in(kGainMatchStatuses, status);
}

constexpr internal::EnumName<WeightVerdict> kWeightVerdicts[] = {
    {WeightVerdict::seen, ""},
    {WeightVerdict::hardly_seen, "poorly determined"},
    {WeightVerdict::combination, "in combination"},
    {WeightVerdict::not_seen, "not determined"},
    {WeightVerdict::at_zero, "at zero"},
    {WeightVerdict::fixed, "fixed"}};

std::string to_string(WeightVerdict verdict) { return internal::name_in(kWeightVerdicts, verdict); }

GainMatch match_gains(const ContinuousLti& plant, const LqrDesign& start,
                      const Eigen::Ref<const MatrixXd>& K, const Eigen::Ref<const MatrixXd>& K_int,
                      const GainMatchOptions& options) {
  const DiagonalLqr problem(plant, start);
  const auto ni = std::ssize(start.integrals);
  require_shape(K, problem.inputs(), problem.states() - ni, kMatchWhere, "K",
                "one row per input, one column per state");
  require_shape(K_int, problem.inputs(), ni, kMatchWhere, "K_int",
                "one row per input, one column per integral");
  MatrixXd both(K.rows(), K.cols() + K_int.cols());
  both << K, K_int;
  VectorXd w0 = diagonals_of(start);
  check(both, problem, w0, options);
  const GainTarget target{problem, both, scale_of(both), groups_of(problem.names(), options.ties),
                          options.interrupted};
  const double mean_R = w0.tail(problem.inputs()).array().log().mean();
  level_ties(problem, target.groups, w0);

  GainMatch match;
  match.design = start;
  const std::string pole = unstable_pole(problem, both);
  if (!pole.empty()) {
    match.status = GainMatchStatus::not_stabilizing;
    match.culprit =
        "the loop of the given gain has " + pole + ", because every LQR gain stabilizes its loop";
    return match;
  }
  const GainPoint first = internal::gain_point(target, w0);
  internal::GainSearch search = internal::search_weights(target, w0, options.starts, options.seed);
  match.evaluations = search.evaluations;
  match.starts = search.starts;
  match.agreeing = search.agreeing;
  if (search.stopped || !search.best.solved()) {
    match.status = search.stopped ? GainMatchStatus::interrupted : GainMatchStatus::no_solution;
    match.culprit = search.stopped ? "" : first.solution.culprit;
    return match;
  }
  // The gain does not determine the common factor of all weights: R keeps its geometric mean.
  const double mean = search.best.w.tail(problem.inputs()).array().log().mean();
  const GainPoint best = internal::gain_point(target, search.best.w * std::exp(mean_R - mean));
  if (!best.solved()) {
    match.status = GainMatchStatus::no_solution;
    match.culprit = best.solution.culprit;
    return match;
  }
  match.design = with_diagonals(start, best.w);
  match.feedback = {best.solution, best.solution.K.leftCols(K.cols()),
                    best.solution.K.rightCols(ni)};
  tell_differences(target, first, best, start, match);
  tell_weights(target, w0, best, start, options.tolerance, match);
  const internal::SensitivityPeak peak =
      internal::weighted_sensitivity(problem, best.w, best.solution, both);
  match.weighted_sensitivity = peak.value;
  match.weighted_sensitivity_at = peak.at;
  const internal::ExcessCost excess = internal::excess_cost(problem, best.w, best.solution, both);
  match.excess_cost = excess.value;
  match.excess_culprit = excess.culprit;
  if (excess.culprit.empty())
    match.excess_state = problem.names()[static_cast<std::size_t>(excess.state)];
  match.status =
      match.after <= options.tolerance ? GainMatchStatus::matched : GainMatchStatus::not_matched;
  return match;
}

}  // namespace quadtune
