// SPDX-License-Identifier: Apache-2.0
#include "design_flights.hpp"

#include <fmt/format.h>

#include <algorithm>

#include "program.hpp"
#include "quadtune/errors.hpp"
#include "quadtune/estimation/tuned_noise.hpp"
#include "quadtune/internal/text_file.hpp"

namespace quadtune::cli {
namespace {

using internal::Json;

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

FlownFlight fly_one(const DesignOutcome& outcome, const MissionRequest& request,
                    const Mission& mission, std::uint64_t seed, bool keep_log) {
  const Design& design = outcome.design;
  FlightArguments arguments;
  arguments.vehicle = design.vehicle.name;
  arguments.estimator = request.estimator;
  arguments.sensors = request.sensors;
  arguments.flow = request.flow;
  arguments.wind = request.wind;
  arguments.seed = seed;
  const bool cascade = request.controller == "cascaded-pid";
  // Continuous gains are flown at the rate of the Mambo's program.
  constexpr double kUsualPeriod = 0.005;
  const Controller controller =
      cascade ? Controller(cascade_controller(*design.cascade, outcome.cascade->cascade.gains))
              : Controller(feedback_controller(*outcome.gains, kUsualPeriod));
  try {
    const ChosenLaw law{
        controller,
        fmt::format("{} of {}", cascade ? "cascaded PID" : "state feedback", design.name),
        cascade ? std::optional(outcome.cascade->margins) : outcome.margins,
        cascade ? position_bandwidth(*outcome.cascade) : 0};
    PlannedFlight plan = plan_flight(arguments, design.vehicle, mission, law, "design");
    plan.setup.log = keep_log;
    take_tuned_noise(design, plan.setup);
    return fly_planned(std::move(plan));
  } catch (const UsageError& error) {
    // The words came from the file, not from the command line.
    std::string message = error.what();
    const std::string prefix = "quadtune design: ";
    if (message.starts_with(prefix)) message.erase(0, prefix.size());
    if (message.starts_with("--")) message.erase(0, 2);
    throw InvalidInput(request.where, message);
  }
}

}  // namespace

std::vector<FlownFlight> fly_missions(const DesignOutcome& outcome, std::uint64_t seed,
                                      bool keep_logs) {
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
    flights.push_back(fly_one(outcome, outcome.design.missions[i], missions[i], seed, keep_logs));
  return flights;
}

bool missions_passed(const DesignOutcome& outcome) {
  return std::all_of(outcome.flights.begin(), outcome.flights.end(),
                     [](const FlownFlight& flight) { return flight.passed; });
}

Json missions_json(const DesignOutcome& outcome) {
  Json json = Json::array();
  for (const FlownFlight& flight : outcome.flights) json.push_back(to_json(flight));
  return json;
}

std::string missions_text(const DesignOutcome& outcome) {
  std::string text;
  for (const FlownFlight& flight : outcome.flights) {
    const MetricValues& metrics = flight.result.metrics;
    text += fmt::format("{}{}: {}; {:.4g} s flown", text.empty() ? "" : "\n",
                        flight.plan.setup.mission.name, flight.passed ? "pass" : "FAIL",
                        flight.result.end_time);
    for (const Metric metric :
         {Metric::settling_time, Metric::tracking_rms, Metric::tilt_max, Metric::energy})
      if (std::isfinite(metrics[metric]))
        text += fmt::format(", {} {:.3g} {}", label_of(metric), metrics[metric], unit_of(metric));
    text += "\n  " + circumstances(flight.plan);
    for (const std::string& reason : reasons(flight)) text += "\n  " + reason;
  }
  return text;
}

}  // namespace quadtune::cli
