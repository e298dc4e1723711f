// SPDX-License-Identifier: Apache-2.0
/// What a controller is worth over missions: a cost, and limits that it keeps or not, over draws of
/// what is uncertain that are the same for every controller.
#pragma once

#include <cstdint>
#include <functional>
#include <limits>
#include <string>
#include <utility>
#include <vector>

#include "quadtune/simulation/campaign_statistics.hpp"
#include "quadtune/simulation/flight.hpp"
#include "quadtune/simulation/uncertainty.hpp"

namespace quadtune {

/// One figure of the cost.
struct CostTerm {
  Metric metric = Metric::tracking_rms;
  double weight = 1;  ///< ≥ 0
};

/// A mission that is flown for its cost.
struct TrialMission {
  std::string name;
  FlightSetup setup;          ///< its controller is replaced by the one that is tried
  std::vector<Limit> limits;  ///< to be kept; the mission's own, or stricter ones
};

/// How many draws make one number.
enum class RobustMeasure {
  mean,
  quantile,  ///< TrialRequest::share of the draws cost no more
  worst,
};
/// "mean", "quantile", "worst", and back.
[[nodiscard]] std::string to_string(RobustMeasure measure);
[[nodiscard]] RobustMeasure robust_measure(const std::string& name, const std::string& where);

/// Of a quantile farther out no number of draws that anybody flies tells anything.
inline constexpr double kLeastTail = 1e-4;

/// What is asked of a controller.
struct TrialRequest {
  std::vector<TrialMission> missions;  ///< at least one
  std::vector<CostTerm> cost;          ///< at least one of weight > 0
  RobustMeasure measure = RobustMeasure::mean;
  double share = 0.9;       ///< of RobustMeasure::quantile, kLeastTail … 1 - kLeastTail
  Uncertainty uncertainty;  ///< none: only noise and wind differ from draw to draw
  std::uint32_t draws = 1;  ///< flights of each mission for one evaluation, ≥ 1
  std::uint64_t seed = 1;
};

/// Checks all of it but the controllers.
/// @throws InvalidInput  naming what is wrong
void validate(const TrialRequest& request, const std::string& where);

/// One limit over the draws, by the measure.
struct TrialLimit {
  std::string mission;
  Metric metric = Metric::duration;
  double value = 0;  ///< infinite where a flight ended early or never came there
  double most = 0;

  /// As excess_of() its share of the limit, or itself where that is 0.
  [[nodiscard]] double excess() const;
};

/// How far a limit is passed, so that the farther is always the greater: `share` from -1 to 1, 1
/// for what is passed by as much again; beyond that 2 - 1/share, 2 for what is not finite.
[[nodiscard]] double excess_of(double share);

/// An excess up to which a limit is kept: what rounding, and a design to the limit itself, leave.
inline constexpr double kLimitTolerance = 1e-5;

/// What became of one controller.
struct TrialOutcome {
  std::vector<double> costs;        ///< of each draw: 1 is what the reference costs on the mean
  double cost = 0;                  ///< by the measure
  std::vector<TrialLimit> limits;   ///< mission by mission
  std::vector<MetricValues> means;  ///< of each mission, over the draws; of what all draws have
  std::uint32_t failed = 0;         ///< flights that ended early
  std::uint32_t flights = 0;

  [[nodiscard]] bool keeps_limits() const;
};

/// Flies controllers for a request. A flight that ends early costs kFailure and more, the earlier
/// the more; so does a figure that was never reached, or that the reference has and a flight lacks.
class MissionTrial {
 public:
  using Stop = std::function<bool()>;  ///< asked now and then; true ends it with Interrupted
  static constexpr double kFailure = 100;

  /// @param reference  each figure of the cost is measured by what it is with this controller, on
  ///                   the mean of the first draws that fly to the end; by itself where none does.
  ///                   A figure that these flights do not have does not count in their mission
  /// @throws InvalidInput  as validate(); for a mission that measures nothing of the cost
  /// @throws Interrupted
  MissionTrial(TrialRequest request, const Controller& reference, std::size_t threads = 0,
               const Stop& interrupted = {});

  /// Draws `first` to `first + count` - 1; the request's first draws unless said.
  /// @throws Interrupted
  [[nodiscard]] TrialOutcome fly(const Controller& controller, const Stop& interrupted = {}) const;
  [[nodiscard]] TrialOutcome fly(const Controller& controller, std::uint32_t first,
                                 std::uint32_t count, const Stop& interrupted = {}) const;

  /// One flight of these: a mission by its place, a draw by its number.
  [[nodiscard]] FlightSetup setup(const Controller& controller, std::size_t mission,
                                  std::uint32_t draw) const;

  [[nodiscard]] const TrialRequest& request() const { return request_; }

 private:
  [[nodiscard]] std::vector<FlightResult> results(const Controller& controller, std::uint32_t first,
                                                  std::uint32_t count,
                                                  const Stop& interrupted) const;
  void require_cost(std::size_t mission, const std::vector<FlightResult>& flown) const;
  [[nodiscard]] double cost_of(std::size_t mission, const FlightResult& result) const;

  TrialRequest request_;
  std::size_t threads_;
  /// What a term is measured by in a mission.
  struct Scale {
    double unit = 1;
    bool counts = true;  ///< the reference's flights have the figure
    bool known = true;   ///< some flew to the end, and so can tell
  };
  std::vector<std::vector<Scale>> scales_;  ///< of each mission's terms
};

/// Mean of the differences second - first, draw by draw, with its interval of 95 %.
/// @param first, second  the same draws, at least 2
[[nodiscard]] Estimated paired_difference(const std::vector<double>& first,
                                          const std::vector<double>& second);

/// How many draws tell something of a quantile: two on either side of it, and two in all.
/// @param share  as TrialRequest::share
[[nodiscard]] std::uint32_t least_draws(double share);
/// How many tell something of what is asked for; of a mean or the worst two.
[[nodiscard]] std::uint32_t least_draws(const TrialRequest& request);

/// Quantile of second less that of first, with the interval of 95 % that the paired bootstrap
/// gives (Efron and Tibshirani 1993, chapter 13): 4,000 samples as large as that of the draws,
/// drawn from them with return, each draw with both its values. The same at each call.
/// @param first, second  the same draws, at least least_draws(share)
[[nodiscard]] Estimated paired_quantile_difference(const std::vector<double>& first,
                                                   const std::vector<double>& second, double share);

}  // namespace quadtune
