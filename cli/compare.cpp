// SPDX-License-Identifier: Apache-2.0
/// quadtune compare: the same mission flown twice, and where the two flights part.
#include <fmt/format.h>

#include <cmath>
#include <memory>
#include <ostream>

#include "arguments/flight_arguments.hpp"
#include "program/command_line.hpp"
#include "program/program.hpp"
#include "quadtune/internal/json.hpp"
#include "quadtune/internal/suggest.hpp"
#include "report/flights/flight_difference.hpp"
#include "report/flights/flight_text.hpp"

namespace quadtune::cli {
namespace {

struct Options {
  std::string what, first, second;
  FlightOptions flight;
};

/// The two flights: what the user asked for, but for the one thing that is compared.
std::array<FlightOptions, 2> both_flights(Options options) {
  FlightOptions& flight = options.flight;
  const auto expect_none = [&](const std::string& value, const char* option, const char* because) {
    if (!value.empty())
      throw UsageError(fmt::format("quadtune compare: {} came with {}, expected none because {}",
                                   option, options.what, because),
                       option);
  };
  if (options.what == "integrators") {
    expect_none(flight.integrator, "--integrator", "euler is compared with tustin");
    flight = as_the_model_project(flight);
    std::array<FlightOptions, 2> two = {flight, flight};
    two[0].integrator = "euler";
    two[1].integrator = "tustin";
    return two;
  }
  if (options.what == "flow") {
    expect_none(flight.flow, "--flow", "the simplified flow is compared with the full one");
    if (!flight.vehicle.empty() && !load_vehicle(flight.vehicle).sensors.flow)
      throw UsageError(fmt::format("quadtune compare: flow: '{}' has no optical flow sensor, "
                                   "expected a vehicle with one",
                                   flight.vehicle),
                       "V");
    if (flight.estimator.empty()) flight.estimator = "mambo-original";
    flight = as_the_model_project(flight);
    std::array<FlightOptions, 2> two = {flight, flight};
    two[0].flow = "simplified";
    two[1].flow = "full";
    return two;
  }
  if (options.what == "filter") {
    expect_none(flight.estimator, "--estimator",
                "the position by filtered velocity is compared with that by the flow's own");
    std::array<FlightOptions, 2> two = {flight, flight};
    two[0].estimator = "mambo";
    two[1].estimator = "mambo-raw";
    return two;
  }
  if (options.what == "gains") {
    if (options.first.empty() || options.second.empty())
      throw UsageError(
          "quadtune compare: gains: expected two, as for --gains of quadtune fly, e.g. "
          "quadtune compare gains mambo published designed",
          "A");
    expect_none(flight.gains, "--gains", "the two that are compared follow the vehicle");
    std::array<FlightOptions, 2> two = {flight, flight};
    two[0].gains = options.first;
    two[1].gains = options.second;
    return two;
  }
  const std::vector<std::string> known = {"integrators", "flow", "filter", "gains"};
  throw UsageError(
      fmt::format("quadtune compare: no comparison '{}', expected integrators, flow, filter or "
                  "gains{}",
                  options.what, internal::did_you_mean(options.what, known)),
      "WHAT");
}

std::array<std::string, 2> names_of(const Options& options) {
  if (options.what == "integrators") return {"euler", "tustin"};
  if (options.what == "flow") return {"simplified", "full"};
  if (options.what == "filter") return {"filtered", "raw"};
  return {options.first, options.second};
}

}  // namespace

Verb compare_verb() {
  return {
      "compare", "integrators|flow|filter|gains V [A B] [--mission NAME|FILE] [options]",
      "fly the same mission twice and show where the flights part",
      "quadtune compare integrators mambo --mission hover", [](CommandLine& line) -> Action {
        auto options = std::make_shared<Options>();
        line.add_option("WHAT", options->what,
                        "integrators: euler against tustin; flow: simplified against full; "
                        "filter: filtered velocity against raw; gains: A against B");
        line.add_option("V", options->flight.vehicle, "a built-in vehicle or a vehicle file");
        line.add_option("A", options->first, "gains of the first flight");
        line.add_option("B", options->second, "gains of the second flight");
        add_flight_options(line, options->flight);
        return [options](Context& context) {
          if (options->what.empty())
            throw UsageError("quadtune compare: expected integrators, flow, filter or gains",
                             "WHAT");
          if (options->what != "gains" && !options->first.empty())
            throw UsageError(fmt::format("quadtune compare: '{}' came after the vehicle, "
                                         "expected nothing there but with gains",
                                         options->first),
                             "A");
          options->flight.seed = context.seed;
          const std::array<FlightOptions, 2> wanted =
              option_of_command("compare", [&] { return both_flights(*options); });
          // Both are planned before the first flies, so that a mistake in the second comes first.
          std::array<PlannedFlight, 2> plans;
          for (std::size_t i = 0; i < 2; ++i) {
            plans[i] = plan_of_command(wanted[i], "compare");
            option_of_command("compare", [&] { keep_log(plans[i]); });
          }
          for (const std::string& note : plans[0].notes) context.note("compare: note: " + note);
          std::array<FlownFlight, 2> flights;
          for (std::size_t i = 0; i < 2; ++i)
            flights[i] = fly_planned(std::move(plans[i]), interrupted);
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
