// SPDX-License-Identifier: Apache-2.0
/// quadtune compare: flies the same mission twice and shows where the flights differ.
#include <algorithm>
#include <utility>

#include "arguments/flight_arguments.hpp"
#include "program/command_line.hpp"
#include "program/program.hpp"
#include "program/refusal.hpp"
#include "quadtune/internal/json.hpp"
#include "quadtune/internal/suggest.hpp"
#include "quadtune/workbench/flight/flight_difference.hpp"
#include "report/flights/flights.hpp"

namespace quadtune::cli {
namespace {

struct Options {
  std::string what, first, second;
  FlightOptions flight;
};

/// Validates WHAT and the arguments that it requires.
void require_words(const Options& options) {
  const FlightOptions& flight = options.flight;
  const std::vector<std::string>& known = compared_things();
  if (options.what.empty()) refuse("WHAT", "expected integrators, flow, filter or gains");
  if (std::find(known.begin(), known.end(), options.what) == known.end())
    refuse("WHAT", "unknown comparison '{}'; expected integrators, flow, filter or gains{}",
           options.what, internal::did_you_mean(options.what, known));
  if (options.what != "gains" && !options.first.empty())
    refuse("A", "unexpected argument '{}' after the vehicle; only `compare gains` takes two more",
           options.first);
  const bool needs_sensors = options.what == "flow" || options.what == "filter";
  if (needs_sensors && !flight.vehicle.empty())
    if (const std::string missing = missing_sensor(options.what, flight.estimator.empty(),
                                                   load_vehicle(flight.vehicle).sensors);
        !missing.empty())
      refuse("V", "{}: '{}' has no {}, expected a vehicle with one", options.what, flight.vehicle,
             missing);
  if (options.what == "gains" && (options.first.empty() || options.second.empty()))
    refuse("A",
           "gains: expected two sets of gains after the vehicle, as for --gains of quadtune fly, "
           "e.g. quadtune compare gains mambo published designed");
}

std::array<PlannedFlight, 2> planned(const FlightPair& pair, const std::string& what,
                                     const std::string& verb) {
  try {
    return plan_both(pair, verb);
  } catch (const OptionError& error) {
    // The comparison has set this option, not the user.
    const bool compared = error.option() == pair.option ||
                          error.option().starts_with(pair.option + " ");  // and the word
    if (what == "gains" || !compared) throw;
    refuse("WHAT", "comparison '{}': {}", what, error.what());
  }
}

void run_compare(Options& options, Context& context) {
  require_words(options);
  options.flight.seed = context.seed;
  const FlightPair pair =
      flight_pair(options.what, options.flight, {options.first, options.second});
  if (options.flight.vehicle.empty()) refuse("V", "expected a vehicle");
  if (options.what == "gains" && options.first == options.second)
    context.note(
        fmt::format("note: both sets of gains are {}: the flights are the same", options.first));
  std::array<PlannedFlight, 2> plans = planned(pair, options.what, context.verb);
  context.notes("note: ", plans[0].notes);
  const ComparedFlights compared = fly_both(pair, std::move(plans), interrupted);
  context.print([&] { return to_json(compared); }, [&] { return to_text(compared); });
}

void add_options(CommandLine& line, Options& options) {
  line.add_option("WHAT", options.what,
                  "integrators: euler against tustin; flow: simplified against full; filter: "
                  "filtered velocity against raw; gains: A against B");
  line.add_option("V", options.flight.vehicle, "a built-in vehicle or a vehicle file");
  line.add_option("A", options.first, "gains of the first flight");
  line.add_option("B", options.second, "gains of the second flight");
  add_flight_options(line, options.flight);
}

}  // namespace

Verb compare_verb() {
  return {"compare", "integrators|flow|filter|gains V [A B] [--mission NAME|FILE] [options]",
          "fly the same mission twice and show where the flights differ",
          "quadtune compare integrators mambo --mission hover",
          with_options(add_options, run_compare)};
}

}  // namespace quadtune::cli
