// SPDX-License-Identifier: Apache-2.0
#include "quadtune/workbench/flown/flown_family.hpp"

#include <fmt/format.h>

#include <algorithm>

#include "quadtune/errors.hpp"
#include "quadtune/internal/in_parallel.hpp"
#include "quadtune/linearize/trim.hpp"
#include "quadtune/workbench/design/chosen_law.hpp"
#include "quadtune/workbench/flight/flight_plan.hpp"

namespace quadtune {
namespace {

/// A hover with an estimator (empty: the default), or with true states if the sensors do not
/// suffice for any; its law only defines the control period.
FlightSetup hover_of(const Vehicle& vehicle, double dt, const std::string& estimator) {
  CascadeController law;
  law.gains.dt = dt;
  for (const CascadeAxis axis : kAllCascadeAxes) law.gains.loops.push_back(cascade_loop(axis));
  FlightOptions options;
  options.estimator = estimator;
  if (estimator.empty() && !why_no_estimator(vehicle).empty()) options.estimator = "truth";
  return plan_flight(options, vehicle, load_mission("hover"), ChosenLaw{law, "none"}).setup;
}

/// Empty if the vehicle can hover.
std::string why_no_hover(const Vehicle& vehicle) {
  const TrimResult hover = trim(vehicle, FlightCondition{});
  return hover.solved() ? "" : hover.culprit;
}

}  // namespace

std::string why_no_reserve(Vehicle vehicle) {
  vehicle.mass *= kHeaviest;
  return why_no_hover(vehicle);
}

std::vector<FlownFamilyMember> flown_family(const Vehicle& vehicle, InputKind inputs, double dt,
                                            const std::string& estimator) {
  const FlightSetup hover = hover_of(vehicle, dt, estimator);
  std::vector<FlownFamilyMember> family = {{"at 1.1 m", 1.1, 1, 1, true, {}}};
  // Optical flow is converted to velocity with the height, and its errors scale with it.
  if (hover.estimator != EstimatorKind::truth && sensors_of(hover).flow) {
    family.push_back({"at 0.5 m", 0.5, 1, 1, true, {}});
    family.push_back({"at 3 m", 3, 1, 1, true, {}});
  }
  const bool lags = std::any_of(vehicle.rotors.begin(), vehicle.rotors.end(),
                                [](const Rotor& rotor) { return slower_lag(rotor) > 0; });
  if (lags) {
    family.push_back({"20 % lighter, lag 40 % longer", 1.1, 0.8, 1.4, false, {}});
    family.push_back({"20 % heavier, lag 40 % shorter", 1.1, kHeaviest, 0.6, false, {}});
  } else {
    family.push_back({"20 % lighter", 1.1, 0.8, 1, false, {}});
    family.push_back({"20 % heavier", 1.1, kHeaviest, 1, false, {}});
  }
  const auto build = [&](std::size_t i) {
    FlownFamilyMember& member = family[i];
    FlightSetup setup = hover;
    if (!member.nominal) {
      setup.flown = vehicle;
      setup.flown->mass *= member.mass;
      for (Rotor& rotor : setup.flown->rotors) {
        rotor.lag *= member.lag;
        rotor.lag_down *= member.lag;  // NaN (same lag both ways) stays NaN
      }
      if (const std::string why = why_no_hover(*setup.flown); !why.empty())
        throw NoSolution(
            fmt::format("{}: gains on the flown plant must also hold the vehicle with {:.0f} % of "
                        "its mass, which cannot hover: {}",
                        place_of(vehicle), 100 * member.mass, why),
            place_of(vehicle));
    }
    FlownPlantOptions options;
    options.inputs = inputs;
    options.dt = dt;
    options.height = member.height;
    options.separate_axes = true;
    member.plant = flown_plant(setup, options);
  };
  internal::in_parallel(family.size(), internal::thread_count(0), [&] { return build; }, {});
  return family;
}

}  // namespace quadtune
