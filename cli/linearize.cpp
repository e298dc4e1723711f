// SPDX-License-Identifier: Apache-2.0
/// quadtune linearize: trim and Jacobians.
#include <memory>

#include "arguments/plant_arguments.hpp"
#include "program/command_line.hpp"
#include "program/program.hpp"
#include "quadtune/internal/json.hpp"
#include "report/loops/linearization_report.hpp"

namespace quadtune::cli {
Verb linearize_verb() {
  return {"linearize", "V [options]", "trim a vehicle and print its linear model",
          "quadtune linearize uquad --at hover --convention uquad --inputs rotor-speed",
          [](CommandLine& line) -> Action {
            auto arguments = std::make_shared<PlantArguments>();
            add_plant_options(line, *arguments);
            return [arguments](Context& context) {
              if (arguments->vehicle.empty())
                throw UsageError("quadtune linearize: expected a vehicle's name or file", "V");
              const LinearVehicle plant = make_plant(*arguments);
              for (const std::string& note : plant.model.notes)
                context.note("linearize: note: " + note);
              context.print([&] { return to_json(plant.model); },
                            [&] { return to_text(plant.model); });
            };
          }};
}

}  // namespace quadtune::cli
