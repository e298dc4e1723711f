// SPDX-License-Identifier: Apache-2.0
#include "quadtune/workbench/flown/flown_check.hpp"

#include <fmt/format.h>

#include <cmath>
#include <complex>
#include <exception>
#include <string>

#include "quadtune/exports/exporter.hpp"
#include "quadtune/workbench/design/chosen_law.hpp"
#include "quadtune/workbench/flight/flight_plan.hpp"
#include "quadtune/workbench/flown/flown_loop.hpp"
#include "quadtune/workbench/flown/flying_loop.hpp"

namespace quadtune {
namespace {

FlownLaw analysed(const Vehicle& vehicle, const Controller& controller,
                  const std::optional<StoredEstimator>& stored, const std::string& convention,
                  const char* name, bool margins) {
  FlownLaw law{name, {}, ""};
  try {
    const PlannedFlight plan = hover_under(vehicle, controller, stored, convention);
    FlownLoopOptions at;
    at.evidence = margins ? MarginsEvidence::essential : MarginsEvidence::none;
    law.loop = flown_loop(plan, at);
    if (law.loop->grows()) law.problem = what_helps(plan, *law.loop);
  } catch (const std::exception& error) {
    law.problem = error.what();
  }
  return law;
}

}  // namespace

std::string estimator_of_program(const Vehicle& vehicle, const std::string& convention) {
  for (const Exporter& exporter : exporters()) {
    const std::string& estimator = exporter.target.estimator;
    if (!exporter.convention.empty() && exporter.convention == convention && !estimator.empty() &&
        feed_estimator(vehicle.sensors, estimator))
      return estimator;
  }
  return "";
}

PlannedFlight hover_under(const Vehicle& vehicle, const Controller& controller,
                          const std::optional<StoredEstimator>& stored,
                          const std::string& convention) {
  FlightOptions options;
  ChosenLaw law{controller, "the exported law"};
  law.estimator = stored;
  if (!stored) options.estimator = estimator_of_program(vehicle, convention);
  return plan_flight(options, vehicle, load_mission("hover"), law);
}

bool has_flown_loop(const TrimResult& trim) {
  constexpr double kStill = 1e-9;  // [m/s], [rad/s], [rad]
  return trim.solved() && trim.x.segment<3>(kVelocity).isZero(kStill) &&
         trim.x.segment<3>(kRates).isZero(kStill) && std::abs(trim.x(kAttitude + 2)) <= kStill;
}

std::vector<FlownLaw> flown_laws(const Vehicle& vehicle, const std::optional<Gains>& gains,
                                 const std::optional<CascadeDesign>& cascade,
                                 const std::optional<StoredEstimator>& estimator, bool margins,
                                 bool cascade_margins) {
  std::vector<FlownLaw> laws;
  if (gains && gains->dt > 0 && has_flown_loop(linearization_of(vehicle, *gains).trim))
    laws.push_back(analysed(vehicle, feedback_controller(*gains, gains->dt), estimator,
                            gains->convention, "state feedback", margins));
  if (cascade)
    laws.push_back(analysed(vehicle, cascade_controller(*cascade, cascade->gains), estimator, "",
                            "PID cascade", cascade_margins));
  return laws;
}

std::vector<VerifyCheck> checks_of(const std::vector<FlownLaw>& laws) {
  std::vector<VerifyCheck> checks;
  for (const FlownLaw& law : laws) {
    VerifyCheck check{fmt::format("the flown loop of the {} is stable", law.name), law.holds(), ""};
    if (law.loop)
      check.detail = fmt::format("hover at {} m, estimator {}, {} sensors: largest |z| {:.6f}, {}",
                                 law.loop->at.height, law.loop->estimator, law.loop->sensors,
                                 std::abs(law.loop->mode.z), describe(*law.loop));
    if (!law.problem.empty()) check.detail += (law.loop ? "; " : "") + law.problem;
    checks.push_back(check);
  }
  return checks;
}

}  // namespace quadtune
