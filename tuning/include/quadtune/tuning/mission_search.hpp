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

  /// ≤ 0 where it is kept, as a share of the bound; 1 for what is not finite
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
  double seconds = 60;             ///< of computing, > 0; kept to a flight's time
  int evaluations = 100000;        ///< at most
  std::uint32_t proof_draws = 24;  ///< fresh ones, ≥ 2, on which start and best are compared
  /// Called after each point: the best cost, points tried, seconds left.
  std::function<void(double best, int evaluations, double left)> progress;
  /// Asked often; true ends the search with the best found.
  std::function<bool()> stop;
};

/// How a search ended.
enum class SearchEnd { budget, converged, interrupted };
[[nodiscard]] std::string to_string(SearchEnd end);

/// Never worse than the start: where the best point is not better than it by 0.1 % beyond the
/// interval of the fresh draws, or breaks a limit that the start keeps, `accepted` is false and the
/// start is what counts.
struct MissionSearchResult {
  bool accepted = false;
  std::string reason;                      ///< why, in words
  Eigen::VectorXd best;                    ///< (n); the start where nothing was accepted
  DesignPoint design;                      ///< of `best`
  TrialOutcome before, after;              ///< on the draws of the search
  TrialOutcome proof_before, proof_after;  ///< on fresh draws
  Estimated difference;                    ///< of the costs, after - before, on fresh draws
  std::vector<std::string> binding;        ///< limits that are within 2 % of their bound
  int evaluations = 0;
  double seconds = 0;
  SearchEnd end = SearchEnd::budget;
};

/// @throws InvalidInput  for a start without a controller, or options out of range
[[nodiscard]] MissionSearchResult search_missions(const DesignSpace& space,
                                                  const MissionTrial& trial,
                                                  const MissionSearchOptions& options);

}  // namespace quadtune
