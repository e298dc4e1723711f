// SPDX-License-Identifier: Apache-2.0
#include "quadtune/workbench/missions/mission_tuning.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <limits>
#include <utility>

#include "quadtune/errors.hpp"
#include "quadtune/internal/built_in.hpp"
#include "quadtune/internal/json.hpp"
#include "quadtune/internal/utf8.hpp"

namespace quadtune {
namespace {

constexpr std::uint32_t kUsualDraws = 4, kUsualProof = 24;

std::uint32_t proof_draws(const TrialRequest& request, const MissionTuningOptions& options) {
  const std::uint32_t min = min_draws(request);
  if (options.proof == 0) return std::max(kUsualProof, min);
  if (options.proof < min)
    throw OptionError("proof",
                      fmt::format("proof is {}, expected at least {} because the {:g} quantile "
                                  "requires as many draws",
                                  options.proof, min, request.share));
  return options.proof;
}

DistanceOverTime distance_of(const LogTable& log) {
  DistanceOverTime distance;
  if (log.columns.empty()) return distance;
  distance.time = log.columns.front().values;
  distance.value.assign(distance.time.size(), 0);
  for (const char* axis : {"px", "py", "pz"}) {
    const LogColumn* was = log.find(std::string("x.") + axis);
    const LogColumn* asked = log.find(std::string("reference.") + axis);
    if (was == nullptr || asked == nullptr) return {};
    for (std::size_t i = 0; i < distance.value.size(); ++i)
      distance.value[i] = std::hypot(distance.value[i], was->values[i] - asked->values[i]);
  }
  return distance;
}

}  // namespace

MissionTuningPlan plan_mission_tuning(const MissionTuning& tuning,
                                      const MissionRequirements& requirements,
                                      const MissionTuningOptions& options, const std::string& who) {
  MissionTuningPlan plan;
  plan.start = tuning.design(tuning.start);
  if (!plan.start.point.controller)
    throw NoSolution(who +
                         ": the design at the start of the search does not stabilize the vehicle; "
                         "expected other weights or gains at the start",
                     "V");
  // Rejects loops that do not exist before anything is flown.
  (void)margin_limits(requirements, plan.start.margins, plan.start.margins);
  TrialRequest& request = plan.request;
  request.cost = requirements.cost;
  request.measure = requirements.measure;
  request.share = requirements.share;
  request.draws = options.draws > 0 ? options.draws : requirements.draws.value_or(kUsualDraws);
  request.uncertainty = requirements.uncertainty;
  request.seed = options.seed;
  const ChosenLaw law{*plan.start.point.controller, tuning.law, {}, tuning.position_bandwidth};
  for (std::size_t i = 0; i < requirements.missions.size(); ++i) {
    CampaignMission mission = requirements.missions[i];
    mission.mission.limits = requirements.limits[i];
    PlannedFlight flight = plan_flight(mission.arguments, tuning.vehicle, mission.mission, law);
    plan.notes.insert(plan.notes.end(), flight.notes.begin(), flight.notes.end());
    if (i == 0) plan.first = flight;
    for (const WidenedLimit& widened : flight.widened)
      plan.widened.push_back({mission.mission.name, widened});
    std::vector<Limit> limits = flight.setup.mission.limits;
    request.missions.push_back({mission.mission.name, std::move(flight.setup), std::move(limits)});
  }
  plan.proof = proof_draws(request, options);
  return plan;
}

MissionTuningResult tune_missions(const MissionTuning& tuning,
                                  const MissionRequirements& requirements, MissionTuningPlan plan,
                                  const MissionTuningOptions& options) {
  const Controller& start = *plan.start.point.controller;
  const auto limits = [&](const TunedDesign& design) {
    return margin_limits(requirements, design.margins, plan.start.margins);
  };
  const auto trial =
      std::make_shared<MissionTrial>(plan.request, start, options.threads, options.stop);
  DesignSpace space;
  space.names = tuning.names;
  space.start = tuning.start;
  space.point = [&](const Eigen::VectorXd& x) {
    TunedDesign design = tuning.design(x);
    if (design.point.controller) design.point.limits = limits(design);
    return std::move(design.point);
  };
  MissionSearchOptions search;
  search.seconds = options.seconds;
  search.evaluations = static_cast<int>(std::min<std::uint64_t>(options.evaluations, 1 << 30));
  search.proof_draws = plan.proof;
  search.stop = options.stop;
  search.progress = options.progress;
  MissionTuningResult result;
  result.tuning = tuning;
  result.search = search_missions(space, *trial, search);
  // After an interrupt, the result so far is still reported and written, which takes little time.
  const MissionTrial::Stop stop =
      result.search.end == SearchEnd::interrupted ? MissionTrial::Stop{} : options.stop;
  const TunedDesign best = tuning.design(result.search.candidate);
  result.before = plan.start.margins;
  result.after = best.margins;
  result.limits = limits(best);
  const auto fresh = static_cast<std::uint32_t>(result.search.proof_before.costs.size());
  std::optional<Controller> rival;
  if (tuning.rival) {
    rival = tuning.rival->controller;
    result.rival =
        fresh > 0 ? trial->fly(*rival, plan.request.draws, fresh, stop) : trial->fly(*rival, stop);
  }
  result.widened = std::move(plan.widened);
  result.flown = flown_evidence(plan.first, start, best.point.controller, rival);
  reject_unstable(result.flown, tuning.start, result.search);
  result.request = std::move(plan.request);
  result.trial = trial;
  return result;
}

double DistanceOverTime::at(double t) const {
  constexpr double kNaN = std::numeric_limits<double>::quiet_NaN();
  if (time.empty() || t > time.back() + 1e-9) return kNaN;
  const auto after = std::upper_bound(time.begin(), time.end(), t + 1e-9);
  return after == time.begin() ? kNaN : value[static_cast<std::size_t>(after - time.begin()) - 1];
}

std::vector<TunedFlights> tuned_flights(const MissionTuningResult& result,
                                        const std::function<bool()>& stop) {
  constexpr double kMaxRows = 2e6;  // of a log in memory
  std::vector<Controller> controllers = {
      *result.tuning.design(result.tuning.start).point.controller,
      *result.tuning.design(result.search.candidate).point.controller};
  if (result.tuning.rival) controllers.push_back(result.tuning.rival->controller);
  std::vector<TunedFlights> all;
  for (std::size_t m = 0; m < result.request.missions.size(); ++m) {
    TunedFlights flights{result.request.missions[m].name, {}};
    for (const Controller& controller : controllers) {
      FlightSetup setup = result.trial->setup(controller, m, result.request.draws);
      if (duration_of(setup) / control_period(setup) > kMaxRows) return all;
      setup.log = true;
      flights.distances.push_back(distance_of(fly(setup, stop).log));
    }
    all.push_back(std::move(flights));
  }
  return all;
}

std::string vehicle_text(const std::string& word) {
  const std::string vehicle =
      internal::looks_like_path(word) ? std::filesystem::absolute(word).string() : word;
  if (internal::valid_utf8(vehicle) != vehicle)
    throw InvalidInput(vehicle,
                       "is not UTF-8, expected a UTF-8 path, because design files are TOML");
  return internal::json_text(internal::Json(vehicle));  // valid TOML, too
}

}  // namespace quadtune
