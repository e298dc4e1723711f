// SPDX-License-Identifier: Apache-2.0
#include <fmt/format.h>

#include "quadtune/internal/json.hpp"
#include "quadtune/linearize/linearize.hpp"
#include "report/loops/loops.hpp"
#include "report/text/print.hpp"

namespace quadtune::report {

internal::Json to_json(const Linearization& model) {
  internal::Json json;
  json["A"] = internal::matrix_to_json(model.plant.A, "A");
  json["B"] = internal::matrix_to_json(model.plant.B, "B");
  json["states"] = internal::signals_to_json(model.plant.states);
  json["inputs"] = internal::signals_to_json(model.plant.inputs);
  json["trim"] = {{"x", internal::vector_to_json(model.x0, "x")},
                  {"u", internal::vector_to_json(model.u0, "u")},
                  {"residual", internal::number_to_json(model.trim.residual, "residual")}};
  json["notes"] = model.notes;
  return json;
}

std::string to_text(const Linearization& model) {
  const std::vector<std::string> states = names_of(model.plant.states);
  const std::vector<std::string> inputs = names_of(model.plant.inputs);
  return section("trim x", table(model.x0.transpose(), {""}, states)) +
         section("trim u", table(model.u0.transpose(), {""}, inputs)) +
         section("residual", fmt::format("{:.2g}", model.trim.residual)) +
         section("A", table(model.plant.A, states, states)) +
         section("B", table(model.plant.B, states, inputs));
}

}  // namespace quadtune::report
