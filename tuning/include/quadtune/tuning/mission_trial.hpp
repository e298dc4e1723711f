// SPDX-License-Identifier: Apache-2.0
/// Evaluation of a controller over missions: a cost and limits, over draws of the uncertain
/// parameters that are the same for every controller.
#pragma once

#include <cstdint>
#include <functional>
#include <limits>
#include <string>
#include <utility>
#include <vector>

#include "quadtune/simulation/campaign/campaign_statistics.hpp"
#include "quadtune/simulation/campaign/uncertainty.hpp"
#include "quadtune/simulation/flight.hpp"

namespace quadtune {

/// One metric of the cost.
struct CostTerm {
  Metric metric = Metric::tracking_rms;  ///< the metric
  double weight = 1;                     ///< ≥ 0
};

/// A mission that is flown to compute the cost.
struct TrialMission {
  std::string name;           ///< name of the mission
  FlightSetup setup;          ///< its controller is replaced by the one under test
  std::vector<Limit> limits;  ///< limits to satisfy: those of the mission, or stricter ones
};

/// How the values of many draws are combined into one number.
enum class RobustMeasure {
  mean,
  quantile,  ///< TrialRequest::share of the draws have at most this cost
  worst,
};
/// "mean", "quantile" or "worst".
[[nodiscard]] std::string to_string(RobustMeasure measure);

/// The measure of a name, the inverse of to_string().
/// @throws InvalidInput  with the unknown name and the three known ones
[[nodiscard]] RobustMeasure robust_measure(const std::string& name, const std::string& where);

/// Minimum tail probability of a quantile. Quantiles farther out cannot be estimated with a
/// practical number of draws.
inline constexpr double kMinTail = 1e-4;

/// Defines the evaluation of a controller.
struct TrialRequest {
  std::vector<TrialMission> missions;           ///< at least one
  std::vector<CostTerm> cost;                   ///< at least one with weight > 0
  RobustMeasure measure = RobustMeasure::mean;  ///< how the costs of the draws are combined
  double share = 0.9;       ///< for RobustMeasure::quantile, kMinTail … 1 - kMinTail
  Uncertainty uncertainty;  ///< empty: only noise and wind differ from draw to draw
  std::uint32_t draws = 1;  ///< number of flights of each mission per evaluation, ≥ 1
  std::uint64_t seed = 1;   ///< of all draws
};

/// Validates everything except the controllers.
/// @throws InvalidInput  naming the invalid entry
void validate(const TrialRequest& request, const std::string& where);

/// A limit and the value of its metric over the draws, combined by the measure.
struct TrialLimit {
  std::string mission;               ///< name of the mission
  Metric metric = Metric::duration;  ///< which metric
  double value = 0;  ///< infinite if a flight ended early or never reached the event
  double max = 0;    ///< the limit

  /// excess_of() applied to the violation divided by the limit, or to the value if the limit is 0.
  [[nodiscard]] double excess() const;
};

/// Monotone measure of limit violation: max(share, -1) up to a share of 1, at which the limit is
/// exceeded by 100 %; 2 - 1/share above that, and 2 for values that are not finite.
[[nodiscard]] double excess_of(double share);

/// Largest excess with which a limit counts as satisfied; it allows for rounding, and for a design
/// exactly at the limit.
inline constexpr double kLimitTolerance = 1e-5;

/// Outcome of the flights of one controller.
struct TrialOutcome {
  std::vector<double> costs;       ///< one per draw, relative to the mean cost of the reference
  double cost = 0;                 ///< combined by the measure
  std::vector<TrialLimit> limits;  ///< mission by mission
  /// One per mission, over the draws; only metrics that all draws have
  std::vector<MetricValues> means;
  std::uint32_t failed = 0;   ///< number of flights that ended early
  std::uint32_t flights = 0;  ///< number of flights

  [[nodiscard]] bool satisfies_limits() const;  ///< whether every excess is at most kLimitTolerance
};

/// Flies controllers as a request defines. A flight that ends early costs at least kFailure, and
/// more the earlier it ends. In other flights, a metric costs kFailure if its event was never
/// reached, or if the reference has it and the flight lacks it.
class MissionTrial {
 public:
  using Stop = std::function<bool()>;      ///< called regularly; true throws Interrupted
  static constexpr double kFailure = 100;  ///< minimum cost of a flight that ends early

  /// @param request    accepted by validate()
  /// @param reference  the unit of each metric of the cost is its mean with this controller, over
  ///                   the first draws whose flights are complete; if there are none, the metric is
  ///                   not scaled. A metric that these flights do not have is ignored in their
  ///                   mission
  /// @param threads    as fly_all()
  /// @param interrupted  called regularly; true throws Interrupted
  /// @throws InvalidInput  as validate(); for a mission that measures no metric of the cost
  /// @throws Interrupted
  MissionTrial(TrialRequest request, const Controller& reference, std::size_t threads = 0,
               const Stop& interrupted = {});

  /// Flies the first TrialRequest::draws draws.
  /// @throws Interrupted
  [[nodiscard]] TrialOutcome fly(const Controller& controller, const Stop& interrupted = {}) const;
  /// The same for the draws `first` to `first + count` - 1.
  [[nodiscard]] TrialOutcome fly(const Controller& controller, std::uint32_t first,
                                 std::uint32_t count, const Stop& interrupted = {}) const;

  /// The setup of one of these flights, by the index of the mission and the number of the draw.
  [[nodiscard]] FlightSetup setup(const Controller& controller, std::size_t mission,
                                  std::uint32_t draw) const;

  [[nodiscard]] const TrialRequest& request() const { return request_; }  ///< the request

 private:
  [[nodiscard]] std::vector<FlightResult> results(const Controller& controller, std::uint32_t first,
                                                  std::uint32_t count,
                                                  const Stop& interrupted) const;
  void require_cost(std::size_t mission, const std::vector<FlightResult>& flown) const;
  [[nodiscard]] double cost_of(std::size_t mission, const FlightResult& result) const;

  TrialRequest request_;
  std::size_t threads_;
  /// The unit of a cost term in a mission.
  struct Scale {
    double unit = 1;
    bool counts = true;  ///< the flights of the reference have the metric
    bool known = true;   ///< at least one flight was complete, so that the metric is known
  };
  std::vector<std::vector<Scale>> scales_;  ///< of each mission's terms
};

/// Mean of the paired differences second - first, with its 95 % confidence interval.
/// @param first, second  values of the same draws, at least 2
[[nodiscard]] Estimated paired_difference(const std::vector<double>& first,
                                          const std::vector<double>& second);

/// Minimum number of draws to estimate a quantile: so many that two are expected on either side of
/// it.
/// @param share  as TrialRequest::share
[[nodiscard]] std::uint32_t min_draws(double share);
/// Minimum number of draws for the measure of a request; two for the mean or the worst case.
[[nodiscard]] std::uint32_t min_draws(const TrialRequest& request);

/// Quantile of second minus that of first, with the 95 % interval of the paired bootstrap (Efron
/// and Tibshirani 1993, chapter 13): 4,000 resamples, each as large as the set of draws and drawn
/// from it with replacement, each draw with both its values. Deterministic.
/// @param first, second  values of the same draws, at least min_draws(share)
/// @param share          of the quantile, within kMinTail … 1 - kMinTail
[[nodiscard]] Estimated paired_quantile_difference(const std::vector<double>& first,
                                                   const std::vector<double>& second, double share);

}  // namespace quadtune
