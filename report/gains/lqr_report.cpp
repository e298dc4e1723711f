// SPDX-License-Identifier: Apache-2.0
#include "quadtune/workbench/design/lqr_report.hpp"

#include <fmt/format.h>

#include "quadtune/internal/json.hpp"
#include "report/gains/gains.hpp"
#include "report/loops/loops.hpp"
#include "report/loops/margins_report.hpp"
#include "report/text/print.hpp"

namespace quadtune::report {
namespace {

using internal::Json;

Json evidence_json(const RiccatiResult& result) {
  Json json;
  json["poles"] = internal::poles_to_json(result.poles, "poles");
  json["residual"] = internal::number_to_json(result.residual, "residual");
  json["rcond"] = internal::number_to_json(result.rcond, "rcond");
  json["iterations"] = result.iterations;
  json["gain_error"] = result.gain_error;
  json["culprit"] = result.culprit;
  json["warning"] = result.warning;
  return json;
}

std::string riccati_text(const RiccatiResult& result) {
  return fmt::format("residual {:.2g}, rcond {:.2g}, {}", result.residual, result.rcond,
                     result.used_extended ? "in 50 digits"
                     : result.used_schur  ? "ordered Schur method"
                                          : fmt::format("{} doubling steps", result.iterations));
}

}  // namespace

Json to_json(const LqrReport& report) {
  const RiccatiResult& riccati = report.riccati;
  Json json = {{"status", to_string(riccati.status)},
               {"K", internal::matrix_to_json(riccati.K, "K")},
               {"S", internal::matrix_to_json(riccati.X, "S")}};
  json.update(evidence_json(riccati));
  json["margins"] = to_json(report.margins);
  return json;
}

std::string to_text(const LqrReport& report) {
  const RiccatiResult& riccati = report.riccati;
  return section("gain K", plain(riccati.K)) + section("cost S", plain(riccati.X)) +
         section("poles", pole_table(riccati.poles, report.dt)) +
         section("margins", to_text(report.margins)) + section("evidence", riccati_text(riccati));
}

Json to_json(const VehicleLqrReport& report) {
  const StateFeedback& feedback = report.feedback;
  Json json = {{"status", to_string(feedback.riccati.status)},
               {"plant", "ideal"},
               {"K", internal::matrix_to_json(feedback.K, "K")},
               {"K_int", internal::matrix_to_json(feedback.K_int, "K_int")},
               {"S", internal::matrix_to_json(feedback.riccati.X, "S")}};
  json.update(evidence_json(feedback.riccati));
  json["states"] = internal::signals_to_json(report.plant.model.plant.states);
  json["inputs"] = internal::signals_to_json(report.plant.model.plant.inputs);
  json["integrals"] = report.design.integrals;
  json["margins"] = to_json(report.margins);
  json["flown"] = Json();
  if (report.flown) {
    json["flown"] = to_json(*report.flown);
    json["flown"]["margins"] = to_json(report.flown->margins);
  }
  add_export(json, report.plant.vehicle, report.gains, {});
  return json;
}

std::string to_text(const VehicleLqrReport& report) {
  const LqrDesign& design = report.design;
  std::string text = section("gain K", table(report.feedback.K, design.inputs, design.states));
  if (!design.integrals.empty())
    text += section("integral K", table(report.feedback.K_int, design.inputs, design.integrals));
  text += section("poles", pole_table(report.poles, design.dt)) +
          section("margins", to_text(report.margins));
  if (report.flown)
    text += section("flown loop", to_text(*report.flown)) +
            section("margins of the flown loop", to_text(report.flown->margins));
  return text + section("evidence", riccati_text(report.feedback.riccati));
}

}  // namespace quadtune::report
