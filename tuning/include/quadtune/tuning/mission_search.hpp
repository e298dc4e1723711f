// SPDX-License-Identifier: Apache-2.0
/// Derivative-free search for gains over missions: first global, then local, subject to limits.
#pragma once

#include <Eigen/Core>
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "quadtune/tuning/mission_trial.hpp"

namespace quadtune {

/// A number of a design that is checked against a bound before any flight, such as a margin.
struct DesignLimit {
  std::string name;       ///< e.g. "Ms of tau_x"
  double value = 0;       ///< of the design
  double bound = 0;       ///< what it is compared with
  bool at_least = false;  ///< the bound is a minimum; otherwise it is a maximum
  double min = 0;         ///< minimum over all designs: 1 for an Ms

  /// excess_of() applied to the violation divided by the distance of the bound from `min`; an
  /// infinite margin satisfies any bound.
  [[nodiscard]] double excess() const;
};

/// One point of the search: a controller with the numbers that are known without a flight.
struct DesignPoint {
  std::optional<Controller> controller;  ///< empty if the design has no solution or is unstable
  std::vector<DesignLimit> limits;       ///< the same number for every point that has a controller
};

/// Controllers as a function of dimensionless numbers: logarithms of factors on gains or weights.
struct DesignSpace {
  std::vector<std::string> names;  ///< n, e.g. "Kp of roll, pitch"
  Eigen::VectorXd start;           ///< (n) the synthesized design
  double reach = 1.5;              ///< largest change of each number from the start, > 0
  std::function<DesignPoint(const Eigen::VectorXd&)> point;  ///< the controller of (n) numbers
};

/// Options of the search.
struct MissionSearchOptions {
  double seconds = 60;       ///< time limit of the search, > 0; exceeded by at most one evaluation
  int evaluations = 100000;  ///< maximum number of evaluations
  /// Number of fresh draws on which the start and the best point are compared; ≥ 2, and ≥
  /// min_draws() of a quantile.
  std::uint32_t proof_draws = 24;
  /// Called after each point with the best cost, the number of points evaluated, and an upper bound
  /// of the remaining seconds.
  std::function<void(double best, int evaluations, double left)> progress;
  /// Called often. If it returns true, the search ends with the best point so far, which is then
  /// proved on at most 100 draws. If it returns true during the proof, the proof ends without a
  /// result and the start is kept.
  std::function<bool()> stop;
};

/// One point of the search, in the order of evaluation.
struct SearchStep {
  double cost = 0;       ///< on the draws of the search; NaN if there is no controller
  bool allowed = false;  ///< it satisfies all limits, or exceeds none by more than the start does
  double best = 0;       ///< minimum cost so far
};

/// How a search ended.
enum class SearchEnd { budget, converged, interrupted };

/// "budget", "converged" or "interrupted".
[[nodiscard]] std::string to_string(SearchEnd end);

/// A binding limit is loosened by this share of its size to compute the cost reduction that this
/// allows.
inline constexpr double kLoosened = 0.1;

/// Result of the search, never worse than the start. The best point is accepted if its cost on the
/// fresh draws is lower than that of the start by 0.1 % beyond the confidence interval. The cost
/// compared is the mean, or the quantile if that is the measure. If the measure is the worst case,
/// the mean is compared and the worst case must not be larger, since no number of draws bounds a
/// maximum. The best point is also accepted if it satisfies all limits on the fresh draws and the
/// start does not. It is rejected if on the fresh draws it exceeds a limit that the start
/// satisfies, or exceeds one by more than the start does, or if more flights end early.
struct MissionSearchResult {
  bool accepted = false;      ///< whether the candidate replaces the start
  bool repaired = false;      ///< accepted, and satisfies all limits although the start does not
  std::string reason;         ///< why it was accepted or rejected
  Eigen::VectorXd best;       ///< (n) the result: the start if nothing was accepted
  Eigen::VectorXd candidate;  ///< (n) the best point of the search, accepted or not
  TrialOutcome before,        ///< of the start, on the draws of the search
      after;                  ///< of the candidate, likewise
  TrialOutcome proof_before,  ///< of the start, on fresh draws
      proof_after;            ///< of the candidate, likewise
  /// Difference of the costs, after - before, on fresh draws: of their quantile if that is the
  /// measure, otherwise of their mean.
  Estimated difference;
  double less = 0,                   ///< `difference` as a relative reduction [%]
      less_low = 0,                  ///< lower end of its interval [%]
      less_high = 0;                 ///< upper end [%]
  std::vector<std::string> binding;  ///< limits that are active at the candidate
  /// Reduction of the cost [%] if one limit of `binding` were looser by kLoosened, one entry for
  /// each. It is computed by flying, on the draws of the search, the points to which the slopes at
  /// the candidate lead, within 0.1 of it in each variable and with all other limits satisfied.
  /// Empty if the search was interrupted.
  std::vector<double> buys;
  std::vector<std::string> broken;    ///< limits that `best` exceeds on fresh draws
  std::vector<SearchStep> steps;      ///< one for each evaluation
  int evaluations = 0;                ///< number of evaluations
  double seconds = 0;                 ///< duration of the search [s]
  SearchEnd end = SearchEnd::budget;  ///< why the search ended
};

/// @throws InvalidInput  for a start without a controller, or options out of range
/// @throws Interrupted   if `stop` returned true before the start was flown
[[nodiscard]] MissionSearchResult search_missions(const DesignSpace& space,
                                                  const MissionTrial& trial,
                                                  const MissionSearchOptions& options);

}  // namespace quadtune
