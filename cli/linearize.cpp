// SPDX-License-Identifier: Apache-2.0
/// quadtune linearize: trim and Jacobians.
#include "quadtune/linearize/linearize.hpp"

#include <fmt/format.h>

#include <memory>
#include <ostream>

#include "arguments/plant_arguments.hpp"
#include "program/command_line.hpp"
#include "program/program.hpp"
#include "quadtune/internal/json.hpp"
#include "report/text/print.hpp"

namespace quadtune::cli {
namespace {

void print_json(const Linearization& model, Context& context) {
  internal::Json json;
  json["A"] = internal::matrix_to_json(model.plant.A, "A");
  json["B"] = internal::matrix_to_json(model.plant.B, "B");
  json["states"] = internal::signals_to_json(model.plant.states);
  json["inputs"] = internal::signals_to_json(model.plant.inputs);
  json["trim"] = {{"x", internal::vector_to_json(model.x0, "x")},
                  {"u", internal::vector_to_json(model.u0, "u")},
                  {"residual", internal::number_to_json(model.trim.residual, "residual")}};
  json["notes"] = model.notes;
  context.out << internal::readable(json) << "\n";
}

void print_text(const Linearization& model, Context& context) {
  const auto states = names_or_numbers(model.plant.states, model.plant.A.rows());
  const auto inputs = names_or_numbers(model.plant.inputs, model.plant.B.cols());
  context.out << section("trim x", table(model.x0.transpose(), {""}, states))
              << section("trim u", table(model.u0.transpose(), {""}, inputs))
              << section("residual", fmt::format("{:.2g}", model.trim.residual))
              << section("A", table(model.plant.A, states, states))
              << section("B", table(model.plant.B, states, inputs));
}

}  // namespace

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
              if (context.json)
                print_json(plant.model, context);
              else
                print_text(plant.model, context);
            };
          }};
}

}  // namespace quadtune::cli
