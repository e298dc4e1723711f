// SPDX-License-Identifier: Apache-2.0
#include "quadtune/workbench/flown/flown_loop.hpp"

#include <fmt/format.h>

#include <cmath>
#include <complex>
#include <variant>

#include "quadtune/internal/in_parallel.hpp"

namespace quadtune {
namespace {

/// For example "a", "a and b" or "a, b and c".
std::string joined(const std::vector<std::string>& names, const std::string& last = "and") {
  std::string text;
  for (std::size_t i = 0; i < names.size(); ++i)
    text += (i == 0 ? "" : i + 1 == names.size() ? " " + last + " " : ", ") + names[i];
  return text;
}

/// Whether a state belongs to a sensor or is a delayed sample. Such states add nothing to the
/// description of a mode by the states of the vehicle and the estimator.
bool is_of_sensor(const std::string& state) {
  for (const char* start : {"waiting ", "accelerometer", "gyroscope", "magnetometer", "barometer",
                            "sonar", "flow", "GPS", "vision"})
    if (state.rfind(start, 0) == 0) return true;
  return false;
}

}  // namespace

FlownPlantOptions plant_options(const FlightSetup& setup, const FlownLoopOptions& options) {
  FlownPlantOptions result;
  result.inputs = input_kind(setup);
  result.dt = control_period(setup);
  result.height = options.height;
  result.command_delay = options.command_delay;
  return result;
}

double FlownLoop::decay() const { return -std::log(std::abs(mode.z)) / dt; }

double FlownLoop::frequency() const { return std::abs(std::arg(mode.z)) / dt; }

std::string what_helps(const PlannedFlight& plan, const FlownLoop& loop) {
  const auto holds = [&](const auto& change, double gain = 1) {
    FlightSetup setup = plan.setup;
    change(setup);
    auto* feedback = std::get_if<StateFeedbackController>(&setup.controller);
    const bool remembers = feedback != nullptr && feedback->gains.memory;
    if (remembers) {
      // The law uses its own commands, which are half as large, too.
      feedback->gains.K *= gain;
      feedback->gains.K_int *= gain;
      feedback->gains.memory->K_lag *= gain;
      feedback->gains.memory->K_past *= gain;
    }
    DiscreteLti law = flown_law(setup);
    if (!remembers) {
      law.C *= gain;
      law.D *= gain;
    }
    const FlownPlant plant = flown_plant(setup, plant_options(setup, loop.at));
    const Eigen::VectorXcd poles =
        periodic_poles(closed(loop_part(cut_at_inputs(plant.plant, law))));
    return poles.size() == 0 || std::log(std::abs(poles(0))) / loop.dt < 1e-4;
  };
  const auto without_lag = [](FlightSetup& setup) {
    for (Rotor& rotor : setup.vehicle.rotors) rotor.lag = rotor.lag_down = 0;
    if (setup.flown)
      for (Rotor& rotor : setup.flown->rotors) rotor.lag = rotor.lag_down = 0;
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
    return "neither true states nor rotors without lag nor half the gains would stabilize it";
  return "it would be stable with " + joined(causes, "or");
}

FlownLoop flown_loop(const PlannedFlight& plan, const FlownLoopOptions& options) {
  const FlightSetup& setup = plan.setup;
  const FlownPlantOptions of_plant = plant_options(setup, options);
  const FlownPlant plant = flown_plant(setup, of_plant);
  const PeriodicLti whole = cut_at_inputs(plant.plant, flown_law(setup));
  // A law that uses only some states does not affect the others; they are not part of the loop.
  std::vector<Eigen::Index> kept;
  const PeriodicLti cut = loop_part(whole, &kept);
  FlownLoop loop;
  loop.at = options;
  loop.dt = of_plant.dt;
  loop.period = cut.period();
  loop.estimator = plan.estimator;
  loop.sensors = plan.sensors;
  loop.drifts = plant.drifts;
  loop.notes = plan.notes;
  loop.notes.insert(loop.notes.end(), plant.notes.begin(), plant.notes.end());
  Eigen::VectorXd scale = Eigen::VectorXd::Ones(whole.C.cols());
  scale.head(plant.scale.size()) = plant.scale;
  constexpr double kNeverNamed = 1e9;
  for (std::size_t i = 0; i < whole.states.size(); ++i)
    if (is_of_sensor(whole.states[i].name)) scale(static_cast<Eigen::Index>(i)) *= kNeverNamed;
  loop.mode = largest_mode(closed(cut), cut.states, scale(kept));
  loop.margins.dt = loop.dt;
  for (const Signal& input : cut.inputs) loop.margins.names.push_back(input.name);
  if (options.evidence == MarginsEvidence::none) return loop;
  const std::vector<PeriodicLti> channels = decoupled_channels(cut);
  loop.margins.loops.resize(channels.size());
  const auto one = [&](std::size_t i) { loop.margins.loops[i] = loop_margins(channels[i]); };
  internal::in_parallel(channels.size(), internal::thread_count(0), [&] { return one; }, {});
  return loop;
}

std::string describe(const FlownLoop& loop) {
  const double rate = std::abs(loop.decay());
  std::string text;
  constexpr double kNeutral = 1e-6;  // [1/s], too small to be observable in a flight
  if (rate < kNeutral)
    text += "deviations neither grow nor decay";
  else
    text += fmt::format("deviations {} in {:.3g} s", loop.decay() > 0 ? "halve" : "double",
                        std::log(2.0) / rate);
  if (loop.frequency() > 1e-6) text += fmt::format(", at {:.3g} rad/s", loop.frequency());
  return text + ", mainly in " + joined(loop.mode.states);
}

std::vector<std::string> flown_notes(const FlownLoop& loop) {
  std::vector<std::string> notes;
  if (!loop.drifts.empty()) {
    std::vector<std::string> names;
    names.reserve(loop.drifts.size());
    for (const Signal& state : loop.drifts) names.push_back(state.name);
    notes.push_back(fmt::format(
        "the sensors that the estimator uses do not observe {}: {} from the true {}", joined(names),
        names.size() == 1 ? "its estimate drifts" : "their estimates drift",
        names.size() == 1 ? "value" : "values"));
  }
  notes.insert(notes.end(), loop.notes.begin(), loop.notes.end());
  return notes;
}

}  // namespace quadtune
