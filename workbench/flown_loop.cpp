// SPDX-License-Identifier: Apache-2.0
#include "quadtune/workbench/flown_loop.hpp"

#include <fmt/format.h>

#include <cmath>
#include <complex>

namespace quadtune {
namespace {

/// "a", "a and b", "a, b and c".
std::string joined(const std::vector<std::string>& names, const std::string& last = "and") {
  std::string text;
  for (std::size_t i = 0; i < names.size(); ++i)
    text += (i == 0 ? "" : i + 1 == names.size() ? " " + last + " " : ", ") + names[i];
  return text;
}

FlownPlantOptions plant_options(const FlightSetup& setup, const FlownLoopOptions& options) {
  FlownPlantOptions result;
  result.inputs = input_kind(setup);
  result.dt = control_period(setup);
  result.height = options.height;
  result.command_delay = options.command_delay;
  return result;
}

}  // namespace

double FlownLoop::decay() const { return -std::log(std::abs(mode.z)) / dt; }

double FlownLoop::frequency() const { return std::abs(std::arg(mode.z)) / dt; }

std::string what_helps(const PlannedFlight& plan, const FlownLoop& loop) {
  const auto holds = [&](const auto& change, double gain = 1) {
    FlightSetup setup = plan.setup;
    change(setup);
    DiscreteLti law = flown_law(setup);
    law.C *= gain;
    law.D *= gain;
    const FlownPlant plant = flown_plant(setup, plant_options(setup, loop.at));
    const Eigen::VectorXcd poles = periodic_poles(closed(cut_at_inputs(plant.plant, law)));
    return poles.size() == 0 || std::log(std::abs(poles(0))) / loop.dt < 1e-4;
  };
  const auto without_lag = [](FlightSetup& setup) {
    for (Rotor& rotor : setup.vehicle.rotors) rotor.lag = 0;
    if (setup.flown)
      for (Rotor& rotor : setup.flown->rotors) rotor.lag = 0;
  };
  std::vector<std::string> causes;
  if (plan.setup.estimator != EstimatorKind::truth &&
      holds([](FlightSetup& setup) { setup.estimator = EstimatorKind::truth; }))
    causes.emplace_back("true states");
  if (plan.setup.estimator != EstimatorKind::truth && plan.setup.real_sensors &&
      holds([](FlightSetup& setup) {
        setup.real_sensors = false;
        calibrate_flow(setup);
      }))
    causes.emplace_back("sensors without delay");
  if (holds(without_lag)) causes.emplace_back("rotors without lag");
  if (holds([](FlightSetup&) {}, 0.5)) causes.emplace_back("half the gains");
  if (causes.empty())
    return "neither true states, rotors without lag nor half the gains would hold it";
  return "it would hold with " + joined(causes, "or");
}

FlownLoop flown_loop(const PlannedFlight& plan, const FlownLoopOptions& options) {
  const FlightSetup& setup = plan.setup;
  const FlownPlantOptions of_plant = plant_options(setup, options);
  const FlownPlant plant = flown_plant(setup, of_plant);
  const PeriodicLti cut = cut_at_inputs(plant.plant, flown_law(setup));
  FlownLoop loop;
  loop.at = options;
  loop.dt = of_plant.dt;
  loop.period = cut.period();
  loop.estimator = plan.estimator;
  loop.sensors = plan.sensors;
  loop.drifts = plant.drifts;
  loop.notes = plan.notes;
  loop.notes.insert(loop.notes.end(), plant.notes.begin(), plant.notes.end());
  Eigen::VectorXd scale = Eigen::VectorXd::Ones(cut.C.cols());
  scale.head(plant.scale.size()) = plant.scale;
  loop.mode = largest_mode(closed(cut), cut.states, scale);
  loop.margins.dt = loop.dt;
  for (const Signal& input : cut.inputs) loop.margins.names.push_back(input.name);
  if (options.evidence != MarginsEvidence::none)
    for (Eigen::Index i = 0; i < cut.C.rows(); ++i)
      loop.margins.loops.push_back(loop_margins(channel(cut, i)));
  return loop;
}

std::string in_words(const FlownLoop& loop) {
  const double rate = std::abs(loop.decay());
  std::string text = joined(loop.mode.states) + ": ";
  // Nothing in a flight tells it from one that stands still.
  constexpr double kStandsStill = 1e-6;
  if (rate < kStandsStill)
    text += "neither grows nor decays";
  else
    text += fmt::format("{} in {:.3g} s", loop.decay() > 0 ? "halves" : "doubles",
                        std::log(2.0) / rate);
  if (loop.frequency() > 1e-6) text += fmt::format(", at {:.3g} rad/s", loop.frequency());
  return text;
}

std::vector<std::string> flown_notes(const FlownLoop& loop) {
  std::vector<std::string> notes;
  if (!loop.drifts.empty()) {
    std::vector<std::string> names;
    for (const Signal& state : loop.drifts) names.push_back(state.name);
    notes.push_back(
        fmt::format("no sensor that the estimator reads tells of {}: what is believed "
                    "of {} drifts away from what is true",
                    joined(names), names.size() == 1 ? "it" : "them"));
  }
  notes.insert(notes.end(), loop.notes.begin(), loop.notes.end());
  return notes;
}

}  // namespace quadtune
