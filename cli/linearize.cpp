// SPDX-License-Identifier: Apache-2.0
/// quadtune linearize: trim and Jacobians.
#include "arguments/plant_arguments.hpp"
#include "program/command_line.hpp"
#include "program/program.hpp"
#include "program/refusal.hpp"
#include "quadtune/internal/json.hpp"
#include "report/loops/loops.hpp"

namespace quadtune::cli {
namespace {

void run_linearize(const PlantArguments& arguments, Context& context) {
  if (arguments.vehicle.empty()) refuse("V", "expected a built-in vehicle or a vehicle file");
  const LinearVehicle plant = make_plant(arguments);
  context.notes("note: ", plant.model.notes);
  context.print([&] { return to_json(plant.model); }, [&] { return to_text(plant.model); });
}

}  // namespace

Verb linearize_verb() {
  return {"linearize", "V [options]", "trim a vehicle and print its linear model",
          "quadtune linearize uquad --at hover --convention uquad --inputs rotor-speed",
          with_options(add_plant_options, run_linearize)};
}

}  // namespace quadtune::cli
