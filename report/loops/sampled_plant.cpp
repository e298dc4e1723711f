// SPDX-License-Identifier: Apache-2.0
#include "quadtune/workbench/sampling/sampled_plant.hpp"

#include <fmt/format.h>

#include "quadtune/internal/json.hpp"
#include "report/loops/loops.hpp"
#include "report/text/print.hpp"

namespace quadtune::report {
namespace {

using internal::Json;

bool is_continuous(const SampledPlant& sampled) {
  return std::holds_alternative<ContinuousLti>(sampled.plant) ||
         std::holds_alternative<ContinuousTransferFunction>(sampled.plant);
}

template <class Lti>
Json matrices_json(const Lti& plant) {
  Json json;
  json["A"] = internal::matrix_to_json(plant.A, "A");
  json["B"] = internal::matrix_to_json(plant.B, "B");
  json["C"] = internal::matrix_to_json(plant.C, "C");
  json["D"] = internal::matrix_to_json(plant.D, "D");
  if (!plant.states.empty())
    json["states"] = names_or_numbers(plant.states, std::ssize(plant.states));
  return json;
}

template <class Fraction>
Json fraction_json(const Fraction& plant, const char* delay_key) {
  Json json;
  json["num"] = internal::vector_to_json(plant.num, "num");
  json["den"] = internal::vector_to_json(plant.den, "den");
  json[delay_key] = plant.delay;
  return json;
}

Json plant_json(const ContinuousLti& plant) { return matrices_json(plant); }
Json plant_json(const DiscreteLti& plant) { return matrices_json(plant); }
Json plant_json(const ContinuousTransferFunction& plant) { return fraction_json(plant, "delay_s"); }
Json plant_json(const DiscreteTransferFunction& plant) {
  return fraction_json(plant, "delay_samples");
}

template <class Lti>
std::string matrices_text(const Lti& plant) {
  return section("A", plain(plant.A)) + section("B", plain(plant.B)) +
         section("C", plain(plant.C)) + section("D", plain(plant.D)) +
         (plant.states.empty() ? "" : section("states", names(plant.states)));
}

std::string fraction_text(const Eigen::VectorXd& num, const Eigen::VectorXd& den) {
  return section("num", plain(num.transpose())) + section("den", plain(den.transpose()));
}

std::string plant_text(const ContinuousLti& plant) { return matrices_text(plant); }
std::string plant_text(const DiscreteLti& plant) { return matrices_text(plant); }
std::string plant_text(const ContinuousTransferFunction& plant) {
  return fraction_text(plant.num, plant.den) +
         (plant.delay != 0 ? section("delay", number(plant.delay) + " s") : "");
}
std::string plant_text(const DiscreteTransferFunction& plant) {
  return fraction_text(plant.num, plant.den) +
         (plant.delay != 0 ? section("delay", fmt::format("{} samples", plant.delay)) : "");
}

}  // namespace

Json to_json(const SampledPlant& sampled) {
  Json json = std::visit([](const auto& plant) { return plant_json(plant); }, sampled.plant);
  json["dt"] = sampled.by.dt;
  json["method"] = to_string(sampled.by.method);
  if (is_continuous(sampled)) json["inverse"] = true;
  json["warnings"] = sampled.warnings;
  return json;
}

std::string to_text(const SampledPlant& sampled) {
  return std::visit([](const auto& plant) { return plant_text(plant); }, sampled.plant) +
         section("dt", number(sampled.by.dt) + " s, " + to_string(sampled.by.method) +
                           (is_continuous(sampled) ? ", to continuous" : ""));
}

}  // namespace quadtune::report
