// SPDX-License-Identifier: Apache-2.0
/// The search for gains over missions: global, then local, without derivatives, limits honoured.
#pragma once

#include <Eigen/Core>
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "quadtune/tuning/mission_trial.hpp"

namespace quadtune {

/// A number that a design must keep before it flies, such as a margin.
struct DesignLimit {
  std::string name;  ///< e.g. "Ms of tau_x"
  double value = 0;
  double bound = 0;
  bool at_least = false;  ///< the bound is the least value, else the greatest
  double least = 0;       ///< that any design has: 1 of an Ms

  /// As excess_of() its share of the bound's distance from `least`; an infinite margin keeps any.
  [[nodiscard]] double excess() const;
};

/// One point of the search: a controller with what is known of it before it flies.
struct DesignPoint {
  std::optional<Controller> controller;  ///< none where the design has no solution or is unstable
  std::vector<DesignLimit> limits;       ///< as many for every point that has a controller
};

/// Controllers as a function of numbers without a unit: logarithms of factors on gains or weights.
struct DesignSpace {
  std::vector<std::string> names;  ///< n, e.g. "Kp of roll, pitch"
  Eigen::VectorXd start;           ///< (n) the synthesized design
  double reach = 1.5;              ///< how far from it each number may go, > 0
  std::function<DesignPoint(const Eigen::VectorXd&)> point;
};

struct MissionSearchOptions {
  double seconds = 60;       ///< of the search, > 0; kept to an evaluation's time
  int evaluations = 100000;  ///< at most
  /// Fresh ones, on which start and best are compared; ≥ 2, of a quantile ≥ its least_draws().
  std::uint32_t proof_draws = 24;
  /// Called after each point: the best cost, points tried, seconds left at most.
  std::function<void(double best, int evaluations, double left)> progress;
  /// Asked often; true ends the search with the best found, which is proved on 100 draws at most.
  /// In the proof it ends that: then nothing is proved, and the start stays.
  std::function<bool()> stop;
};

/// One point of the search, in the order in which they were tried.
struct SearchStep {
  double cost = 0;       ///< on the draws of the search; NaN without a controller
  bool allowed = false;  ///< it passes no limit, or none farther than the start
  double best = 0;       ///< cost of the best point so far
};

/// How a search ended.
enum class SearchEnd { budget, converged, interrupted };
[[nodiscard]] std::string to_string(SearchEnd end);

/// A binding limit is loosened by this share of its size to see what that buys.
inline constexpr double kLoosened = 0.1;

/// Never worse than the start. The best point is accepted where it costs less than the start by
/// 0.1 % beyond the interval of the fresh draws: on the mean, or at the quantile where that is the
/// measure; where that is the worst, on the mean, and its worst is no greater, since no draws bound
/// a maximum. Or where it keeps all limits on them and the start does not. Not where it passes a
/// limit there that the start keeps, or farther than the start, nor where more flights end early.
struct MissionSearchResult {
  bool accepted = false;
  bool repaired = false;       ///< accepted, and keeps all limits where the start does not
  std::string reason;          ///< why, in words
  Eigen::VectorXd best;        ///< (n) what counts: the start where nothing was accepted
  Eigen::VectorXd candidate;   ///< (n) the best point of the search, accepted or not
  TrialOutcome before, after;  ///< of start and candidate on the draws of the search
  TrialOutcome proof_before, proof_after;  ///< on fresh draws
  /// Of the costs, after - before, on fresh draws: of their quantile where that is the measure,
  /// else of their mean.
  Estimated difference;
  double less = 0, less_low = 0, less_high = 0;  ///< that difference as a fall of the same [%]
  std::vector<std::string> binding;  ///< limits that the candidate is as near to as it may be
  /// By how much the cost would fall [%] if one of `binding` were looser by kLoosened: the points
  /// that the slopes at the candidate lead to, within 0.1 of it in each variable and all other
  /// limits kept, are flown on the draws of the search. Empty where the search was interrupted.
  std::vector<double> buys;
  std::vector<std::string> broken;  ///< limits that `best` passes, on fresh draws
  std::vector<SearchStep> steps;
  int evaluations = 0;
  double seconds = 0;
  SearchEnd end = SearchEnd::budget;
};

/// @throws InvalidInput  for a start without a controller, or options out of range
/// @throws Interrupted   where `stop` came before the start was flown
[[nodiscard]] MissionSearchResult search_missions(const DesignSpace& space,
                                                  const MissionTrial& trial,
                                                  const MissionSearchOptions& options);

}  // namespace quadtune
