// SPDX-License-Identifier: Apache-2.0
#include <fmt/format.h>

#include <algorithm>
#include <utility>

#include "quadtune/errors.hpp"
#include "quadtune/estimation/tuned_noise.hpp"
#include "quadtune/internal/text_file.hpp"
#include "quadtune/workbench/design.hpp"

namespace quadtune {
namespace {

/// A name that is no mission was written in the design.
Mission mission_of(const MissionRequest& request) {
  try {
    return load_mission(request.mission);
  } catch (const InvalidInput& error) {
    if (error.where() == "mission") throw InvalidInput(request.where, error.what());
    throw;
  }
}

/// Tuned covariances in place of the simulated estimator's own, for its own period.
void take_tuned_noise(const Design& design, FlightSetup& setup) {
  if (design.estimator && setup.estimator == EstimatorKind::uquad) {
    setup.uquad_filter.dt = control_period(setup);
    take_noise(design.estimator->model, "design", setup.uquad_filter);
  }
  MamboEstimatorSettings<double>& estimator = setup.mambo_estimator;
  for (const KalmanDesign& filter : design.kalman) {
    if (filter.tuned.empty()) continue;
    const double periods = control_period(setup) / filter.model.dt;
    if (filter.name == "altitude") {
      estimator.altitude_Q = filter.Q(0, 0) * periods;
      estimator.altitude_R = filter.R(0, 0);
    } else if (filter.name == "velocity") {
      // It has one variance for both axes.
      estimator.velocity_Q = filter.Q.diagonal().mean() * periods;
      estimator.velocity_R = filter.R.diagonal().mean();
    }
  }
}

/// As it will fly, with the words of a mission's request.
PlannedFlight plan_of(const DesignOutcome& outcome, const MissionRequest& request,
                      const Mission& mission, std::uint64_t seed) {
  const Design& design = outcome.design;
  FlightOptions options;
  options.vehicle = design.vehicle.name;
  options.estimator = request.estimator;
  options.sensors = request.sensors;
  options.flow = request.flow;
  options.wind = request.wind;
  options.seed = seed;
  const bool cascade = request.controller == kCascadedPid;
  const Controller controller =
      cascade ? Controller(cascade_controller(*design.cascade, outcome.cascade->cascade.gains))
              : Controller(feedback_controller(*outcome.gains, kUsualPeriod));
  const ChosenLaw law{
      controller, fmt::format("{} of {}", cascade ? "cascaded PID" : "state feedback", design.name),
      cascade ? std::optional(outcome.cascade->margins) : outcome.margins,
      cascade ? position_bandwidth(*outcome.cascade) : 0};
  try {
    return plan_flight(options, design.vehicle, mission, law);
  } catch (const OptionError& error) {
    if (request.where.empty()) throw;
    throw InvalidInput(request.where, error.what());
  }
}

FlownFlight fly_one(const DesignOutcome& outcome, const MissionRequest& request,
                    const Mission& mission, std::uint64_t seed, bool keep_log,
                    const std::function<bool()>& stop) {
  PlannedFlight plan = plan_of(outcome, request, mission, seed);
  plan.setup.log = keep_log;
  take_tuned_noise(outcome.design, plan.setup);
  FlownFlight flight = fly_planned(std::move(plan), stop);
  judge_loop(flight);
  return flight;
}

}  // namespace

std::vector<FlownFlight> fly_missions(const DesignOutcome& outcome, std::uint64_t seed,
                                      bool keep_logs, const std::function<bool()>& stop) {
  // Each leaves a page of its name.
  std::vector<Mission> missions;
  for (const MissionRequest& request : outcome.design.missions) {
    missions.push_back(mission_of(request));
    for (std::size_t i = 0; i + 1 < missions.size(); ++i)
      if (missions[i].name == missions.back().name)
        throw InvalidInput(request.where,
                           fmt::format("a second mission has the name '{}', expected another name "
                                       "because each leaves a page of its name",
                                       internal::printable(missions[i].name)));
  }
  std::vector<FlownFlight> flights;
  for (std::size_t i = 0; i < missions.size(); ++i)
    flights.push_back(
        fly_one(outcome, outcome.design.missions[i], missions[i], seed, keep_logs, stop));
  return flights;
}

bool missions_passed(const DesignOutcome& outcome) {
  return std::all_of(outcome.flights.begin(), outcome.flights.end(),
                     [](const FlownFlight& flight) { return flight.passed; });
}

}  // namespace quadtune
