// SPDX-License-Identifier: Apache-2.0
#include "quadtune/workbench/design/lqi_report.hpp"

#include "quadtune/workbench/design/chosen_law.hpp"
#include "quadtune/workbench/design/near_hover.hpp"
#include "quadtune/workbench/flown/flown_messages.hpp"
#include "quadtune/workbench/flown/flying_loop.hpp"

namespace quadtune {

PlannedFlight hover_under(const Vehicle& vehicle, const Gains& gains, const FlightOptions& flight) {
  return plan_flight(flight, vehicle, load_mission("hover"),
                     ChosenLaw{feedback_controller(gains, kUsualPeriod), "state feedback"});
}

LqiReport lqi_report(const Vehicle& vehicle, const FlownLqiOptions& options,
                     const FlightOptions& flight, const FlownLoopOptions& at) {
  LqiReport report;
  report.design = flown_lqi(vehicle, options);
  Gains& gains = report.design.lqi.gains;
  keep_near_hover(vehicle, gains);
  report.flown = flown_loop(hover_under(vehicle, gains, flight), at);
  report.ideal = margins_report(OpenLoop(open_loop(model_of(vehicle, gains).plant, gains)),
                                report.flown.margins.names, at.evidence);
  report.estimator = stored_estimator(vehicle, flight.estimator, gains.dt);
  report.messages = flown_messages(report.design.notes, report.flown);
  return report;
}

}  // namespace quadtune
