// SPDX-License-Identifier: Apache-2.0
/// quadtune vehicle: the built-in vehicles, one in full, or whether a file is right.

#include "program/command_line.hpp"
#include "program/program.hpp"
#include "program/refusal.hpp"
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
    refuse("vehicle", "ACTION", "{}, expected list, show V or check FILE{}",
           action.empty() ? "no action came" : "'" + action + "'",
           internal::did_you_mean(action, {"list", "show", "check"}));
  if (action == "list" && !options.vehicle.empty())
    refuse("vehicle", options.vehicle, "unexpected argument '{}' after list", options.vehicle);
  if (action != "list" && options.vehicle.empty())
    refuse("vehicle", "V", "{} needs a built-in vehicle's name or a file", action);
}

void run_vehicle(const Options& options, Context& context) {
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

void add_options(CommandLine& line, Options& options) {
  line.add_option("ACTION", options.action, "list, show or check");
  line.add_option("V", options.vehicle, "a built-in vehicle's name or a vehicle file");
}

}  // namespace

Verb vehicle_verb() {
  return {"vehicle", "list | show V | check FILE", "list, show or check vehicles",
          "quadtune vehicle show mambo", with_options(add_options, run_vehicle)};
}

}  // namespace quadtune::cli
