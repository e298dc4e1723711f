// SPDX-License-Identifier: Apache-2.0
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <utility>

#include "quadtune/design/export_target.hpp"
#include "quadtune/errors.hpp"
#include "quadtune/estimation/tuned_noise.hpp"
#include "quadtune/internal/text_file.hpp"
#include "quadtune/workbench/design/design.hpp"

namespace quadtune {
namespace {

/// The mission of a request; an unknown name is an error in the design.
Mission mission_of(const MissionRequest& request) {
  try {
    return load_mission(request.mission);
  } catch (const InvalidInput& error) {
    if (error.where() == "mission") throw InvalidInput(request.where, error.what());
    throw;
  }
}

/// Replaces the covariances of the simulated estimator by tuned ones, converted to its period.
void take_tuned_noise(const Design& design, FlightSetup& setup) {
  if (design.estimator && setup.estimator == EstimatorKind::uquad) {
    setup.uquad_filter.dt = control_period(setup);
    copy_noise(design.estimator->model, "design", setup.uquad_filter);
  }
  MamboEstimatorSettings<double>& estimator = setup.mambo_estimator;
  for (const KalmanDesign& filter : design.kalman) {
    if (filter.tuned.empty()) continue;
    const double periods = control_period(setup) / filter.model.dt;
    if (filter.name == "altitude") {
      estimator.altitude_Q = filter.Q(0, 0) * periods;
      estimator.altitude_R = filter.R(0, 0);
    } else if (filter.name == "velocity") {
      // This estimator has a single variance for both axes.
      estimator.velocity_Q = filter.Q.diagonal().mean() * periods;
      estimator.velocity_R = filter.R.diagonal().mean();
    }
  }
}

/// Plans the flight of a mission request.
PlannedFlight plan_of(const DesignOutcome& outcome, const MissionRequest& request,
                      const Mission& mission, std::uint64_t seed) {
  const Design& design = outcome.design;
  FlightOptions options;
  options.vehicle = design.vehicle.name;
  options.estimator = request.estimator.empty() ? program_estimator(design) : request.estimator;
  options.sensors = request.sensors;
  options.flow = request.flow;
  options.wind = request.wind;
  options.seed = seed;
  options.gains = design.file.string();  // only for the commands of a diagnosis
  options.controller = request.controller;
  options.mission = request.mission;
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
                    const Mission& mission, std::uint64_t seed, std::uint32_t seeds, bool keep_log,
                    const std::function<bool()>& stop) {
  PlannedFlight plan = plan_of(outcome, request, mission, seed);
  take_tuned_noise(outcome.design, plan.setup);
  FlownFlight flight = worst_of(fly_seeds(plan, seeds, stop));
  if (keep_log) {  // only for the flight that is shown
    std::vector<SeedVerdict> verdicts = std::move(flight.seeds);
    flight.plan.setup.log = true;
    flight = fly_planned(std::move(flight.plan), stop);
    flight.seeds = std::move(verdicts);
  }
  judge_loop(flight);
  return flight;
}

/// Widens the limits, because a disturbed vehicle leaves its place; it must continue and return.
void loosen(Mission& mission) {
  std::erase_if(mission.limits, [](const Limit& limit) {
    switch (limit.metric) {
      case Metric::settling_time:
      case Metric::overshoot:
      case Metric::yaw_overshoot:
      case Metric::tracking_rms:
      case Metric::height_rms:
      case Metric::yaw_rms:
        return true;
      default:
        return false;
    }
  });
  for (Limit& limit : mission.limits) switch (limit.metric) {
      case Metric::tracking_max:
      case Metric::height_max:
      case Metric::height_peak:
      case Metric::yaw_max:
      case Metric::final_distance:
        limit.max *= kDisturbedSlack;
        break;
      default:
        break;
    }
}

void add_gust(PlannedFlight& plan) {
  FlightSetup& setup = plan.setup;
  if (!has_aerodynamics(setup.vehicle))
    plan.notes.push_back(fmt::format(
        "the file of '{}' has no drag: the gust does not move the vehicle", setup.vehicle.name));
  Gust& gust = setup.environment.wind.gust;
  if (!gust.velocity.isZero(0)) return;  // the mission has its own gust
  gust.velocity = Eigen::Vector3d(kGustSpeed, kGustSpeed, 0) / std::sqrt(2.0);
  gust.length = kGustLength;
  gust.start = duration_of(setup) / 2;
  const std::string words = fmt::format("a gust of {:g} m/s", kGustSpeed);
  plan.wind = plan.wind == "calm" ? words : plan.wind + " and " + words;
}

/// Adds a step of the weight that neither law nor estimator knows about.
void add_load(FlightSetup& setup) {
  const double half = duration_of(setup) / 2;
  std::vector<FlightEvent>& events = setup.mission.events;
  const auto later = std::find_if(events.begin(), events.end(),
                                  [&](const FlightEvent& event) { return event.time > half; });
  events.insert(later, {half, LoadChange{kLoadShare * flown_vehicle(setup).mass}});
}

}  // namespace

std::string program_estimator(const Design& design) {
  const Sensors& sensors = design.vehicle.sensors;
  const bool tuned = std::any_of(design.kalman.begin(), design.kalman.end(),
                                 [](const KalmanDesign& filter) { return !filter.tuned.empty(); });
  const auto asked_for = [&](EstimatorKind kind) {
    if (kind == EstimatorKind::mambo && tuned) return true;
    if (kind == EstimatorKind::uquad && design.estimator) return true;
    return std::any_of(design.exports.begin(), design.exports.end(),
                       [&](const ExportRequest& request) {
                         return export_target(request.to, "export").estimator == to_string(kind);
                       });
  };
  for (const EstimatorKind kind :
       {EstimatorKind::mambo, EstimatorKind::uquad, EstimatorKind::general, EstimatorKind::truth})
    if (asked_for(kind) && feed_estimator(sensors, to_string(kind))) return to_string(kind);
  // A matrix is optimized with the estimator of the program of its convention.
  if (design.lqi && design.lqi->matrix)
    return estimator_of_program(design.vehicle, design.lqi->matrix->convention);
  return "";
}

std::vector<FlownFlight> fly_disturbed(const DesignOutcome& outcome, std::uint64_t seed,
                                       const std::function<bool()>& stop) {
  std::vector<FlownFlight> flights;
  for (const MissionRequest& request : outcome.design.missions) {
    const Mission mission = mission_of(request);
    // A flight with ideal sensors is a textbook test, without gusts.
    if (request.sensors == "ideal") continue;
    if (std::holds_alternative<MotorTest>(mission.kind) ||
        std::holds_alternative<Carried>(mission.kind))
      continue;
    for (const bool gust : {true, false}) {
      PlannedFlight plan = plan_of(outcome, request, mission, seed);
      take_tuned_noise(outcome.design, plan.setup);
      loosen(plan.setup.mission);
      plan.widened.clear();  // they belong to the original limits
      if (gust)
        add_gust(plan);
      else
        add_load(plan.setup);
      FlownFlight flight = fly_planned(std::move(plan), stop);
      flight.variant = gust ? "gust" : "load";
      flights.push_back(std::move(flight));
    }
  }
  return flights;
}

std::vector<FlownFlight> fly_missions(const DesignOutcome& outcome, std::uint64_t seed,
                                      bool keep_logs, const std::function<bool()>& stop,
                                      std::uint32_t seeds) {
  // Each mission writes a page with its name.
  std::vector<Mission> missions;
  for (const MissionRequest& request : outcome.design.missions) {
    missions.push_back(mission_of(request));
    for (std::size_t i = 0; i + 1 < missions.size(); ++i)
      if (missions[i].name == missions.back().name)
        throw InvalidInput(request.where,
                           fmt::format("two missions have the name '{}'; expected distinct names, "
                                       "because each writes a page with its name",
                                       internal::printable(missions[i].name)));
  }
  std::vector<FlownFlight> flights;
  for (std::size_t i = 0; i < missions.size(); ++i)
    flights.push_back(
        fly_one(outcome, outcome.design.missions[i], missions[i], seed, seeds, keep_logs, stop));
  return flights;
}

bool missions_passed(const DesignOutcome& outcome) {
  const auto all_pass = [](const std::vector<FlownFlight>& flights) {
    return std::all_of(flights.begin(), flights.end(),
                       [](const FlownFlight& flight) { return flight.passed; });
  };
  return all_pass(outcome.flights) && all_pass(outcome.disturbed);
}

}  // namespace quadtune
