// SPDX-License-Identifier: Apache-2.0
/// quadtune vehicle: the built-in vehicles, one in full, or whether a file is right.
#include <fmt/format.h>

#include <memory>
#include <ostream>

#include "program/command_line.hpp"
#include "program/program.hpp"
#include "quadtune/internal/json.hpp"
#include "quadtune/internal/suggest.hpp"
#include "quadtune/workbench/vehicle/vehicle_check.hpp"
#include "report/vehicles/vehicle_report.hpp"

namespace quadtune::cli {
namespace {

struct Options {
  std::string action, vehicle;
};

void require_action(const Options& options) {
  const std::string& action = options.action;
  if (action != "list" && action != "show" && action != "check")
    throw UsageError(fmt::format("quadtune vehicle: {}, expected list, show V or check FILE{}",
                                 action.empty() ? "no action came" : "'" + action + "'",
                                 internal::did_you_mean(action, {"list", "show", "check"})),
                     "ACTION");
  if (action == "list" && !options.vehicle.empty())
    throw UsageError(
        fmt::format("quadtune vehicle: unexpected argument '{}' after list", options.vehicle),
        options.vehicle);
  if (action != "list" && options.vehicle.empty())
    throw UsageError(
        fmt::format("quadtune vehicle: {} needs a built-in vehicle's name or a file", action), "V");
}

void run(const Options& options, Context& context) {
  require_action(options);
  if (options.action == "list") {
    const std::vector<std::string> names = built_in_vehicles();
    context.print(
        [&] {
          return internal::Json{{"vehicles", names}};
        },
        [&] { return vehicle_list(names); });
  } else if (options.action == "show") {
    const Vehicle vehicle = load_vehicle(options.vehicle);
    context.print([&] { return to_json(vehicle); }, [&] { return to_text(vehicle); });
  } else {
    const VehicleCheck check = check_vehicle(options.vehicle);
    context.print([&] { return to_json(check.vehicle); },
                  [&] { return to_text(check, options.vehicle); });
  }
}

}  // namespace

Verb vehicle_verb() {
  return {"vehicle", "list | show V | check FILE", "list, show or check vehicles",
          "quadtune vehicle show mambo", [](CommandLine& line) -> Action {
            auto options = std::make_shared<Options>();
            line.add_option("ACTION", options->action, "list, show or check");
            line.add_option("V", options->vehicle, "a built-in vehicle's name or a vehicle file");
            return [options](Context& context) { run(*options, context); };
          }};
}

}  // namespace quadtune::cli
