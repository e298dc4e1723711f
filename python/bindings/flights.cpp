// SPDX-License-Identifier: Apache-2.0
/// Flights: their verdict, and their records as arrays.
#include "flights.hpp"

#include <cmath>
#include <tuple>
#include <variant>

#include "quadtune/errors.hpp"
#include "quadtune/internal/json.hpp"
#include "quadtune/logs/flight_log.hpp"
#include "report/flights/flights.hpp"
#include "support/interrupts.hpp"
#include "support/topics.hpp"

namespace quadtune::python {
namespace {

namespace py = pybind11;
using namespace py::literals;

const LogTable& log_of(const Flight& flight) { return flight.flown.result.log; }

/// @throws KeyError  naming the column
const LogColumn& column(const Flight& flight, const std::string& name) {
  const LogColumn* found = log_of(flight).find(name);
  if (found == nullptr)
    throw py::key_error("no column '" + name + "'; columns lists them" +
                        (log_of(flight).columns.empty() ? " (the flight has log=False)" : ""));
  return *found;
}

Flight judged(FlownFlight flown, bool diagnosed) {
  Flight flight{std::move(flown), {}};
  if (diagnosed && !flight.flown.passed)
    flight.diagnosis = diagnose(flight.flown.plan, flight.flown);
  return flight;
}

std::vector<Flight> fly_words(const VehicleWord& vehicle, FlightOptions options, bool log,
                              std::uint32_t seeds, bool diagnosed) {
  options.vehicle = vehicle.text;
  if (seeds < 1) throw OptionError("seeds", "seeds is 0, expected at least 1");
  return long_call([&](const Stop& stop) {
    PlannedFlight plan = plan_flight(options, "fly");
    if (log) keep_log(plan);
    std::vector<FlownFlight> flown;
    if (seeds > 1)
      flown = fly_seeds(plan, seeds, stop);
    else
      flown.push_back(fly_planned(std::move(plan), stop));
    std::vector<Flight> flights;
    bool first = true;  // one diagnosis, as the command makes
    for (FlownFlight& one : flown) {
      const bool failed = !one.passed;
      flights.push_back(judged(std::move(one), diagnosed && first));
      if (failed) first = false;
    }
    return flights;
  });
}

/// One flight, or with `seeds` one for each seed.
std::variant<Flight, std::vector<Flight>> fly_python(
    const VehicleWord& vehicle, const Path& mission, const std::string& controller,
    const Path& gains, const std::string& integrator, const std::string& estimator,
    const std::string& flow, std::optional<double> flow_rate, const std::string& sensors,
    const std::string& wind, const std::string& allocation, const std::string& take_off,
    std::optional<double> duration, const std::string& solver, std::optional<double> step,
    bool dynamic_environment, std::uint64_t seed, std::optional<std::uint32_t> seeds, bool log,
    bool diagnosed) {
  for (const auto& [name, value, unit] :
       {std::tuple("flow_rate", flow_rate, "Hz"), std::tuple("duration", duration, "seconds"),
        std::tuple("step", step, "seconds")})
    if (value) require_positive(*value, name, unit);
  FlightOptions options;
  options.mission = mission.text;
  options.controller = controller_kind(controller);
  options.gains = gains.text;
  options.integrator = integrator;
  options.estimator = estimator;
  options.flow = flow;
  options.flow_rate = flow_rate;
  options.sensors = sensors;
  options.wind = wind;
  options.allocation = allocation;
  options.take_off = take_off;
  options.duration = duration;
  options.solver = solver;
  options.step = step;
  options.dynamic_environment = dynamic_environment;
  options.seed = seed;
  std::vector<Flight> flights = fly_words(vehicle, options, log, seeds.value_or(1), diagnosed);
  if (!seeds) return std::move(flights.front());
  return flights;
}

void add_checks(py::module_& module) {
  py::class_<LimitCheck>(module, "LimitCheck", "A limit of a mission held against a flight.")
      .def_property_readonly(
          "metric", [](const LimitCheck& check) { return name_of(check.metric); }, "Its name.")
      .def_readonly("value", &LimitCheck::value, "What was measured; NaN for nothing.")
      .def_readonly("bound", &LimitCheck::bound, "The limit.")
      .def_readonly("ok", &LimitCheck::ok, "Whether the flight kept it.");
  py::class_<LogEvent>(module, "FlightEvent", "Something that happened in a flight.")
      .def_readonly("time", &LogEvent::time, "When it happened [s].")
      .def_readonly("name", &LogEvent::name, "One word.")
      .def_readonly("detail", &LogEvent::detail, "A sentence; may be empty.");
  py::class_<Diagnosis>(module, "Diagnosis", "Why a flight failed, and what helps.")
      .def_property_readonly(
          "cause", [](const Diagnosis& diagnosis) { return to_string(diagnosis.cause); },
          "\"unstable loop\", \"motor limits\", ...")
      .def_readonly("why", &Diagnosis::why, "The mechanism, with its numbers.")
      .def_readonly("next", &Diagnosis::next, "What helps.");
}

}  // namespace

py::dict metrics_of(const MetricValues& values) {
  py::dict metrics;
  const std::vector<std::string> names = metric_names();
  for (std::size_t i = 0; i < names.size(); ++i)
    if (!std::isnan(values.value[i])) metrics[py::str(names[i])] = values.value[i];
  return metrics;
}

void add_flights(py::module_& module) {
  add_checks(module);
  py::class_<Flight> type(module, "Flight", "A simulated flight and its verdict.");
  type.def_property_readonly(
          "passed", [](const Flight& flight) { return flight.flown.passed; },
          "Whether it completed and kept every limit of its mission.")
      .def_property_readonly(
          "end", [](const Flight& flight) { return to_string(flight.flown.result.end); },
          "\"completed\", \"safety exit\" or \"diverged\".")
      .def_property_readonly(
          "end_time", [](const Flight& flight) { return flight.flown.result.end_time; },
          "How long it was flown [s].")
      .def_property_readonly(
          "reasons", [](const Flight& flight) { return reasons(flight.flown); },
          "Why it did not pass, a sentence each.")
      .def_property_readonly(
          "metrics", [](const Flight& flight) { return metrics_of(flight.flown.result.metrics); },
          "The figures of the flight by name, in SI units; one that was not reached is infinite.")
      .def_property_readonly(
          "checks", [](const Flight& flight) { return flight.flown.verdict.checks; },
          "The limits of the mission.")
      .def_property_readonly(
          "events", [](const Flight& flight) { return flight.flown.result.events; },
          "What happened, in the order of time.")
      .def_property_readonly(
          "law", [](const Flight& flight) { return flight.flown.plan.law; },
          "The control law in words.")
      .def_property_readonly(
          "estimator", [](const Flight& flight) { return flight.flown.plan.estimator; },
          "Name of the estimator.")
      .def_property_readonly(
          "seed", [](const Flight& flight) { return flight.flown.plan.setup.seed; }, "Its seed.")
      .def_property_readonly(
          "notes", [](const Flight& flight) { return flight.flown.plan.notes; },
          "Notes on choices that were made for the flight.")
      .def_readonly("diagnosis", &Flight::diagnosis, "Of a flight that failed, otherwise None.")
      .def_property_readonly(
          "final_state",
          [](const Flight& flight) -> Eigen::VectorXd { return flight.flown.result.final_state; },
          "True state at the end.")
      .def_property_readonly(
          "columns",
          [](const Flight& flight) {
            std::vector<std::string> names;
            for (const LogColumn& one : log_of(flight).columns) names.push_back(one.name);
            return names;
          },
          "Names of the recorded columns, \"t\" first; empty with log=False.")
      .def_property_readonly(
          "units",
          [](const Flight& flight) {
            py::dict units;
            for (const LogColumn& one : log_of(flight).columns) units[py::str(one.name)] = one.unit;
            return units;
          },
          "Their units by name.")
      .def(
          "__getitem__",
          [](py::object self, const std::string& name) {
            return view(column(self.cast<const Flight&>(), name).values, self);
          },
          "name"_a, "A column as an array with one value a control period, without a copy.")
      .def(
          "__contains__",
          [](const Flight& flight, const std::string& name) {
            return log_of(flight).find(name) != nullptr;
          },
          "name"_a, "Whether there is such a column.")
      .def(
          "save_log",
          [](const Flight& flight, const std::filesystem::path& file) {
            save(file.string(), log_bytes(log_of(flight), file.string()));
          },
          "file"_a, "Write the record to a .csv or .mat file, as `quadtune fly --log FILE`.")
      .def(
          "save_report",
          [](const Flight& flight, const std::filesystem::path& file) {
            save(file.string(), html(report::flight_page(flight.flown, "", flight.diagnosis)));
          },
          "file"_a, "Write the page of the flight, as `quadtune fly --report FILE`.")
      .def("__repr__", [](const Flight& flight) {
        return "<Flight of " + flight.flown.plan.setup.mission.name + ", " +
               (flight.flown.passed ? "pass" : "fail") + ">";
      });
  add_report(
      type, "quadtune fly V",
      [](const Flight& flight) { return report::to_json(flight.flown, flight.diagnosis); },
      [](const Flight& flight) { return report::to_text(flight.flown, flight.diagnosis); });
  const FlightOptions usual;
  module.def(
      "fly", &fly_python, "vehicle"_a, py::kw_only(), "mission"_a = usual.mission,
      "controller"_a = "", "gains"_a = "", "integrator"_a = "", "estimator"_a = "", "flow"_a = "",
      "flow_rate"_a = py::none(), "sensors"_a = "", "wind"_a = usual.wind, "allocation"_a = "",
      "take_off"_a = "", "duration"_a = py::none(), "solver"_a = usual.solver,
      "step"_a = py::none(), "dynamic_environment"_a = false, "seed"_a = usual.seed,
      "seeds"_a = py::none(), "log"_a = true, "diagnose"_a = true,
      "Fly a mission in the nonlinear simulation, with a verdict.\n\n"
      "mission: a built-in name or a file. controller: \"cascaded-pid\", \"state-feedback\" or\n"
      "\"firmware\". gains: \"designed\", \"published\", an export, a gain or design file, or\n"
      "what a result's save() wrote. duration > 0 [s]: default: that of the mission. step > 0:\n"
      "of the solver [s]. flow_rate > 0: of the optical flow [Hz]. The other words are those\n"
      "of `quadtune fly` (docs/cli.md#flights). seeds=N >= 1 flies N seeds from `seed` on and\n"
      "returns a list. log=False keeps no record; diagnose=False does not look for the cause\n"
      "of a failure. A flight that fails is a result with passed == False. Raises InvalidInput\n"
      "for unknown words and numbers out of range, NoSolution if the vehicle cannot hover or a\n"
      "design has no solution, FileError if a file cannot be read.");
}

}  // namespace quadtune::python
