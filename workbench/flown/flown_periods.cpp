// SPDX-License-Identifier: Apache-2.0
#include "quadtune/workbench/flown/flown_periods.hpp"

#include <variant>

#include "quadtune/errors.hpp"
#include "quadtune/internal/in_parallel.hpp"
#include "quadtune/workbench/design/chosen_law.hpp"
#include "quadtune/workbench/flight/flight_plan.hpp"

namespace quadtune {
namespace {

Controller at_period(Controller law, double dt) {
  if (auto* cascade = std::get_if<CascadeController>(&law)) {
    cascade->gains.dt = dt;
    return law;
  }
  if (auto* own = std::get_if<OwnController>(&law)) {
    own->dt = dt;
    return law;
  }
  auto& feedback = std::get<StateFeedbackController>(law);
  if (feedback.gains.memory)
    throw InvalidInput(
        "flown periods",
        "the law stores past commands at its own period, so it cannot be analysed at another; "
        "expected a law without past commands");
  feedback.dt = dt;
  return law;
}

}  // namespace

std::vector<FlownPeriod> flown_at_periods(const Vehicle& vehicle, const Controller& law,
                                          const std::vector<double>& periods) {
  std::vector<FlownPeriod> all(periods.size());
  const auto one = [&](std::size_t i) {
    all[i].dt = periods[i];
    const ChosenLaw chosen{at_period(law, periods[i]), "the law that is compared"};
    try {
      all[i].loop =
          flown_loop(plan_flight(FlightOptions{}, vehicle, load_mission("hover"), chosen));
    } catch (const InvalidInput& error) {
      all[i].why = error.what();
    }
  };
  (void)at_period(law, 1);  // rejects a law with memory
  internal::in_parallel(all.size(), internal::thread_count(0), [&] { return one; }, {});
  return all;
}

}  // namespace quadtune
