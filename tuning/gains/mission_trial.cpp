// SPDX-License-Identifier: Apache-2.0
#include "quadtune/tuning/mission_trial.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numeric>
#include <random>

#include "quadtune/errors.hpp"
#include "quadtune/internal/enum_names.hpp"
#include "quadtune/internal/joined.hpp"
#include "quadtune/internal/suggest.hpp"
#include "quadtune/internal/tails.hpp"
#include "quadtune/internal/text_file.hpp"

namespace quadtune {
namespace {

constexpr double kInfinity = std::numeric_limits<double>::infinity();
/// A metric this small relative to its unit counts as zero.
constexpr double kMinScale = 1e-9;

/// Combines values, which may be infinite, by the measure.
double robust(const TrialRequest& request, std::vector<double> values) {
  switch (request.measure) {
    case RobustMeasure::mean:
      return std::accumulate(values.begin(), values.end(), 0.0) /
             static_cast<double>(values.size());
    case RobustMeasure::worst:
      return *std::max_element(values.begin(), values.end());
    case RobustMeasure::quantile:
      break;
  }
  return sample_quantile(values, request.share);
}

void require_pairs(const char* where, const std::vector<double>& first,
                   const std::vector<double>& second, std::size_t min) {
  if (first.size() != second.size() || first.size() < min)
    throw InvalidInput(where,
                       fmt::format("there are {} and {} values; expected equal numbers, {} or more",
                                   first.size(), second.size(), min));
}

bool ended_early(const FlightResult& result) { return result.end != FlightEnd::completed; }

}  // namespace

constexpr internal::EnumName<RobustMeasure> kRobustMeasures[] = {
    {RobustMeasure::mean, "mean"},
    {RobustMeasure::quantile, "quantile"},
    {RobustMeasure::worst, "worst"}};

std::string to_string(RobustMeasure measure) { return internal::name_in(kRobustMeasures, measure); }

RobustMeasure robust_measure(const std::string& name, const std::string& where) {
  if (const auto measure = internal::value_in(kRobustMeasures, name)) return *measure;
  throw InvalidInput(
      where, fmt::format("unknown measure '{}'; expected mean, quantile or worst{}",
                         internal::printable(name),
                         internal::did_you_mean(name, internal::names_in(kRobustMeasures))));
}

void validate(const TrialRequest& request, const std::string& where) {
  if (request.missions.empty())
    throw InvalidInput(where, "there is no mission; expected at least one");
  double sum = 0;
  for (const CostTerm& term : request.cost) {
    if (!(term.weight >= 0) || !std::isfinite(term.weight))
      throw InvalidInput(where, fmt::format("the weight of {} is {}, expected 0 or more",
                                            name_of(term.metric), term.weight));
    sum += term.weight;
  }
  if (!(sum > 0))
    throw InvalidInput(where, "the cost has no weight; expected at least one greater than 0");
  if (request.draws == 0) throw InvalidInput(where, "there are 0 draws, expected 1 or more");
  if (!(request.share >= kMinTail && request.share <= 1 - kMinTail))
    throw InvalidInput(where, fmt::format("the quantile is {}, expected from {} to {}",
                                          request.share, kMinTail, 1 - kMinTail));
  validate(request.uncertainty, where);
  for (const TrialMission& mission : request.missions) {
    FlightSetup setup = mission.setup;
    apply(request.uncertainty, draw(request.uncertainty, request.seed, 0), setup);
  }
}

double excess_of(double share) {
  if (!std::isfinite(share)) return 2;
  return share > 1 ? 2 - 1 / share : std::max(share, -1.0);
}

double TrialLimit::excess() const { return excess_of(max > 0 ? value / max - 1 : value); }

bool TrialOutcome::satisfies_limits() const {
  return std::all_of(limits.begin(), limits.end(),
                     [](const TrialLimit& limit) { return limit.excess() <= kLimitTolerance; });
}

MissionTrial::MissionTrial(TrialRequest request, const Controller& reference, std::size_t threads,
                           const Stop& interrupted)
    : request_(std::move(request)), threads_(threads) {
  validate(request_, "trial");
  const std::vector<FlightResult> flown = results(reference, 0, request_.draws, interrupted);
  for (std::size_t m = 0; m < request_.missions.size(); ++m) {
    require_cost(m, flown);
    std::vector<Scale>& scales = scales_.emplace_back();
    for (const CostTerm& term : request_.cost) {
      double sum = 0;
      int count = 0, lacking = 0, completed = 0;
      for (std::uint32_t d = 0; d < request_.draws; ++d) {
        const FlightResult& result = flown[m * request_.draws + d];
        const double value = result.metrics[term.metric];
        if (ended_early(result)) continue;
        ++completed;
        if (std::isnan(value)) ++lacking;
        if (!std::isfinite(value)) continue;
        sum += value;
        ++count;
      }
      scales.push_back({count > 0 && sum / count > kMinScale ? sum / count : 1,
                        completed == 0 || lacking<completed, completed> 0});
    }
  }
}

/// A mission that has no metric of the cost would rate every controller as perfect.
void MissionTrial::require_cost(std::size_t mission, const std::vector<FlightResult>& flown) const {
  bool any_completed = false;
  for (std::uint32_t d = 0; d < request_.draws; ++d) {
    const FlightResult& result = flown[mission * request_.draws + d];
    if (ended_early(result)) continue;
    any_completed = true;
    for (const CostTerm& term : request_.cost)
      if (term.weight > 0 && !std::isnan(result.metrics[term.metric])) return;
  }
  if (!any_completed) return;
  std::vector<std::string> metrics;
  for (const CostTerm& term : request_.cost)
    if (term.weight > 0) metrics.push_back(name_of(term.metric));
  throw InvalidInput(
      fmt::format("mission '{}'", request_.missions[mission].name),
      fmt::format("its flight of {} s yields none of the metrics of the cost ({}), expected a "
                  "mission that yields one of them, or a longer flight",
                  duration_of(request_.missions[mission].setup), internal::joined(metrics, ", ")));
}

std::vector<FlightResult> MissionTrial::results(const Controller& controller, std::uint32_t first,
                                                std::uint32_t count,
                                                const Stop& interrupted) const {
  std::vector<FlightSetup> setups;
  setups.reserve(request_.missions.size() * count);
  for (std::size_t m = 0; m < request_.missions.size(); ++m)
    for (std::uint32_t d = first; d < first + count; ++d) setups.push_back(setup(controller, m, d));
  return fly_all(setups, threads_, interrupted);
}

FlightSetup MissionTrial::setup(const Controller& controller, std::size_t mission,
                                std::uint32_t draw) const {
  FlightSetup setup = request_.missions[mission].setup;
  setup.controller = controller;
  setup.seed = request_.seed;
  setup.flight = draw;
  if (!request_.uncertainty.numbers.empty())
    apply(request_.uncertainty, quadtune::draw(request_.uncertainty, request_.seed, draw), setup);
  return setup;
}

double MissionTrial::cost_of(std::size_t mission, const FlightResult& result) const {
  if (ended_early(result)) {
    const double flown = result.end_time / duration_of(request_.missions[mission].setup);
    return kFailure * (2 - std::min(flown, 1.0));
  }
  double cost = 0, weights = 0;
  for (std::size_t t = 0; t < request_.cost.size(); ++t) {
    const CostTerm& term = request_.cost[t];
    const double value = result.metrics[term.metric];
    const Scale& scale = scales_[mission][t];
    if (!scale.counts || (!scale.known && std::isnan(value))) continue;
    weights += term.weight;
    cost +=
        term.weight * (std::isfinite(value) ? std::min(value / scale.unit, kFailure) : kFailure);
  }
  return weights > 0 ? cost / weights : 0;
}

TrialOutcome MissionTrial::fly(const Controller& controller, const Stop& interrupted) const {
  return fly(controller, 0, request_.draws, interrupted);
}

TrialOutcome MissionTrial::fly(const Controller& controller, std::uint32_t first,
                               std::uint32_t count, const Stop& interrupted) const {
  const std::vector<FlightResult> flown = results(controller, first, count, interrupted);
  const std::size_t missions = request_.missions.size();
  TrialOutcome outcome;
  outcome.costs.assign(count, 0);
  outcome.flights = static_cast<std::uint32_t>(flown.size());
  for (std::size_t m = 0; m < missions; ++m) {
    const TrialMission& mission = request_.missions[m];
    const FlightResult* const of_mission = flown.data() + m * count;
    for (std::uint32_t d = 0; d < count; ++d) {
      outcome.costs[d] += cost_of(m, of_mission[d]) / static_cast<double>(missions);
      outcome.failed += static_cast<std::uint32_t>(ended_early(of_mission[d]));
    }
    for (const Limit& limit : mission.limits) {
      std::vector<double> values;
      for (std::uint32_t d = 0; d < count; ++d) {
        const double value = of_mission[d].metrics[limit.metric];
        values.push_back(ended_early(of_mission[d]) || std::isnan(value) ? kInfinity : value);
      }
      outcome.limits.push_back(
          {mission.name, limit.metric, robust(request_, std::move(values)), limit.max});
    }
    MetricValues& means = outcome.means.emplace_back();
    for (std::size_t i = 0; i < kMetrics; ++i) {
      double sum = 0;
      for (std::uint32_t d = 0; d < count; ++d) sum += of_mission[d].metrics.value[i];
      means.value[i] = sum / count;
    }
  }
  outcome.cost = robust(request_, outcome.costs);
  return outcome;
}

Estimated paired_difference(const std::vector<double>& first, const std::vector<double>& second) {
  require_pairs("paired_difference", first, second, 2);
  const auto n = static_cast<double>(first.size());
  double mean = 0, squares = 0;
  for (std::size_t i = 0; i < first.size(); ++i) mean += (second[i] - first[i]) / n;
  for (std::size_t i = 0; i < first.size(); ++i)
    squares += std::pow(second[i] - first[i] - mean, 2);
  const double t = internal::student_quantile(0.975, n - 1);
  const double width = t * std::sqrt(squares / (n - 1) / n);
  return {mean, mean - width, mean + width};
}

std::uint32_t min_draws(double share) {
  // Rounding of 1 - share must not add a draw.
  return static_cast<std::uint32_t>(std::ceil(2 / std::min(share, 1 - share) * (1 - 1e-12)));
}

std::uint32_t min_draws(const TrialRequest& request) {
  return request.measure == RobustMeasure::quantile ? min_draws(request.share) : 2;
}

Estimated paired_quantile_difference(const std::vector<double>& first,
                                     const std::vector<double>& second, double share) {
  require_pairs("paired_quantile_difference", first, second, min_draws(share));
  constexpr std::size_t kResamples = 4000;
  std::vector<double> a = first, b = second, differences;
  const double value = sample_quantile(b, share) - sample_quantile(a, share);
  std::mt19937_64 random(1);
  differences.reserve(kResamples);
  for (std::size_t r = 0; r < kResamples; ++r) {
    for (std::size_t i = 0; i < first.size(); ++i) {
      const std::size_t k = random() % first.size();
      a[i] = first[k];
      b[i] = second[k];
    }
    differences.push_back(sample_quantile(b, share) - sample_quantile(a, share));
  }
  return {value, sample_quantile(differences, 0.025), sample_quantile(differences, 0.975)};
}

}  // namespace quadtune
