// SPDX-License-Identifier: Apache-2.0
/// quadtune compare: the same mission flown twice, and where the two flights part.
#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <cmath>
#include <memory>
#include <ostream>

#include "flight_arguments.hpp"
#include "flight_difference.hpp"
#include "flight_story.hpp"
#include "program.hpp"
#include "quadtune/internal/suggest.hpp"

namespace quadtune::cli {
namespace {

struct Options {
  std::string what, first, second;
  FlightArguments flight;
};

/// The two flights: what the user asked for, but for the one thing that is compared.
std::array<FlightArguments, 2> both_flights(Options options) {
  FlightArguments& flight = options.flight;
  // Where nothing is said, the experiments are those of the model project.
  const auto by_default = [](std::string& option, const char* value) {
    if (option.empty()) option = value;
  };
  if (options.what == "integrators") {
    if (!flight.integrator.empty())
      throw UsageError(
          "quadtune compare: --integrator came with integrators, expected none because "
          "euler is compared with tustin",
          "--integrator");
    std::array<FlightArguments, 2> two = {flight, flight};
    two[0].integrator = "euler";
    two[1].integrator = "tustin";
    return two;
  }
  if (options.what == "flow") {
    by_default(flight.estimator, "mambo-original");
    std::array<FlightArguments, 2> two = {flight, flight};
    two[0].flow = "simplified";
    two[1].flow = "full";
    return two;
  }
  if (options.what == "gains") {
    if (options.first.empty() || options.second.empty())
      throw UsageError(
          "quadtune compare: gains: expected two, as for --gains of quadtune fly, e.g. "
          "quadtune compare gains mambo published designed",
          "A");
    std::array<FlightArguments, 2> two = {flight, flight};
    two[0].gains = options.first;
    two[1].gains = options.second;
    return two;
  }
  const std::vector<std::string> known = {"integrators", "flow", "gains"};
  throw UsageError(
      fmt::format("quadtune compare: no comparison '{}', expected integrators, flow or "
                  "gains{}",
                  options.what, internal::did_you_mean(options.what, known)),
      "WHAT");
}

std::array<std::string, 2> names_of(const Options& options) {
  if (options.what == "integrators") return {"euler", "tustin"};
  if (options.what == "flow") return {"simplified", "full"};
  return {options.first, options.second};
}

}  // namespace

Verb compare_verb() {
  return {
      "compare", "integrators|flow|gains V [A B] [--mission NAME|FILE] [options]",
      "fly the same mission twice and show where the flights part",
      "quadtune compare integrators mambo --mission hover", [](CLI::App& app) -> Action {
        auto options = std::make_shared<Options>();
        app.add_option("WHAT", options->what,
                       "integrators: euler against tustin; flow: simplified against full; "
                       "gains: A against B");
        app.add_option("V", options->flight.vehicle, "a built-in vehicle or a vehicle file");
        app.add_option("A", options->first, "gains of the first flight");
        app.add_option("B", options->second, "gains of the second flight");
        add_flight_options(app, options->flight);
        return [options](Context& context) {
          if (options->what.empty())
            throw UsageError("quadtune compare: expected integrators, flow or gains", "WHAT");
          if (options->what != "gains" && !options->first.empty())
            throw UsageError(fmt::format("quadtune compare: '{}' came after the vehicle, "
                                         "expected nothing there but with gains",
                                         options->first),
                             "A");
          options->flight.seed = context.seed;
          std::array<FlightArguments, 2> wanted = both_flights(*options);
          std::array<FlownFlight, 2> flights;
          for (std::size_t i = 0; i < 2; ++i) {
            PlannedFlight plan = plan_flight(wanted[i], "compare");
            plan.setup.log = true;
            if (i == 0)
              for (const std::string& note : plan.notes) context.note("compare: note: " + note);
            flights[i] = fly_planned(std::move(plan));
          }
          const FlightDifference difference =
              difference_of(flights[0].result.log, flights[1].result.log);
          const std::array<std::string, 2> names = names_of(*options);
          if (context.json)
            context.out << internal::readable(to_json(options->what, names, flights, difference))
                        << "\n";
          else
            context.out << to_text(options->what, names, flights, difference);
        };
      }};
}

}  // namespace quadtune::cli
