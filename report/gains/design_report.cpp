// SPDX-License-Identifier: Apache-2.0
#include <fmt/format.h>

#include <algorithm>

#include "quadtune/internal/joined.hpp"
#include "quadtune/internal/json.hpp"
#include "quadtune/internal/text_file.hpp"
#include "quadtune/model/mixer.hpp"
#include "quadtune/workbench/design/design_verdict.hpp"
#include "report/flights/flights.hpp"
#include "report/gains/gains.hpp"
#include "report/loops/loops.hpp"
#include "report/loops/margins_report.hpp"
#include "report/text/print.hpp"

namespace quadtune::report {
namespace {

using internal::Json;

// --- JSON ----------------------------------------------------------------------------------------

Json lqr_json(const DesignOutcome& outcome) {
  if (outcome.lqi) return to_json(*outcome.lqi, outcome.design.vehicle);
  if (outcome.matrix) return to_json(*outcome.matrix, outcome.design.vehicle);
  const RiccatiResult& riccati = outcome.feedback->riccati;
  const Gains& gains = *outcome.gains;
  return {{"status", to_string(riccati.status)},
          {"method", to_string(outcome.design.lqr->method)},
          {"convention", gains.convention},
          {"sign_law", to_string(gains.sign_law)},
          {"states", internal::signals_to_json(gains.states)},
          {"inputs", internal::signals_to_json(gains.inputs)},
          {"integrals", internal::signals_to_json(gains.integrals)},
          {"K", internal::matrix_to_json(gains.K, "K")},
          {"K_int", internal::matrix_to_json(gains.K_int, "K_int")},
          {"poles", internal::poles_to_json(outcome.poles, "poles")},
          {"residual", internal::number_to_json(riccati.residual, "residual")},
          {"rcond", internal::number_to_json(riccati.rcond, "rcond")},
          {"iterations", riccati.iterations},
          {"margins", to_json(*outcome.margins)}};
}

Json filter_json(const DesignedFilter& designed) {
  const KalmanFilter& filter = designed.filter;
  return {{"name", filter.name},
          {"dt", filter.model.dt},
          {"M", internal::matrix_to_json(filter.M, "M")},
          {"L", internal::matrix_to_json(filter.L, "L")},
          {"P", internal::matrix_to_json(filter.P, "P")},
          {"Z", internal::matrix_to_json(filter.Z, "Z")},
          {"poles", internal::poles_to_json(designed.evidence.poles, "poles")},
          {"residual", internal::number_to_json(designed.evidence.residual, "residual")}};
}

Json published_json(const PublishedDifference& difference, const PublishedGains& published) {
  return {{"source", published.source},
          {"note", published.note},
          {"max_relative", difference.max_relative},
          {"max_relative_entry", difference.max_entry},
          {"entry", difference.worst},
          {"entry_published", difference.published},
          {"entry_here", difference.converged}};
}

// --- text ----------------------------------------------------------------------------------------

std::string flight_text(const FlightCondition& condition) {
  std::string text = to_string(condition.kind);
  if (condition.kind == FlightKind::spin)
    text += fmt::format(" at {} rad/s, climb {} m/s", number(condition.yaw_rate),
                        number(condition.climb));
  else if (condition.kind != FlightKind::hover)
    text +=
        fmt::format(" at {} m/s, climb {} m/s", number(condition.speed), number(condition.climb));
  if (condition.kind == FlightKind::circle)
    text += fmt::format(", radius {} m", number(condition.radius));
  return text + fmt::format(", yaw {} deg", number(degrees(condition.yaw)));
}

std::string trim_text(const DesignOutcome& outcome) {
  const Vehicle& vehicle = outcome.design.vehicle;
  const TrimResult& trim = outcome.model.trim;
  const double min = trim.u.minCoeff();
  const double max = trim.u.maxCoeff();
  const std::string speeds =
      max - min < 1e-9 * max ? number(max) : number(min) + " ... " + number(max);
  return fmt::format(
      "{}: rotors at {} rad/s (limits {} ... {}), command {} {}\nthrust-to-weight {:.3f}, tilt "
      "{:.3g} deg, residual {:.2g}",
      flight_text(outcome.design.condition), speeds, number(min_speed(vehicle)),
      number(max_speed(vehicle)), number(command_of_speed(vehicle.motor, max)), vehicle.motor.unit,
      thrust_to_weight(vehicle), degrees(trim.tilt), trim.residual);
}

std::string problem_text(const DesignOutcome& outcome) {
  const LqrDesign& lqr = *outcome.design.lqr;
  return fmt::format(
      "LQR, {} weights{}, convention {}, inputs {}\nlaw u = u0 {} K (x_sp - x){}",
      to_string(lqr.method), lqr.dt > 0 ? fmt::format(", {} ms", number(lqr.dt * 1e3)) : "",
      lqr.convention, names(outcome.gains->inputs),
      outcome.gains->sign_law == SignLaw::set_point_minus_state ? "+" : "-",
      lqr.integrals.empty()
          ? ""
          : fmt::format(" + K_int integral(x_sp - x) of {}", internal::joined(lqr.integrals, " ")));
}

std::string evidence_text(const RiccatiResult& riccati) {
  return fmt::format("Riccati residual {:.2g}, reciprocal condition {:.2g}, {}", riccati.residual,
                     riccati.rcond,
                     riccati.used_extended ? "in 50 digits"
                     : riccati.used_schur  ? "by the ordered Schur method"
                                           : fmt::format("{} doubling steps", riccati.iterations));
}

std::string published_text(const PublishedDifference& difference, const PublishedGains& published) {
  std::string text = fmt::format(
      "{}\nlargest difference {:.2g}, relative to its row's largest entry; {:.2g} relative to the "
      "entry itself, at {}: published {:.8g}, here {:.8g}",
      published.source, difference.max_relative, difference.max_entry, difference.worst,
      difference.published, difference.converged);
  if (!published.note.empty()) text += "\nwhy: " + published.note;
  return text;
}

std::string filter_text(const DesignedFilter& designed) {
  const KalmanFilter& filter = designed.filter;
  return fmt::format(
      "{}, {} ms, residual {:.2g}{}; filter gain M\n{}", filter.name, number(filter.model.dt * 1e3),
      designed.evidence.residual,
      filter.noise_source.empty() ? "" : ", noise from " + internal::printable(filter.noise_source),
      table(filter.M, names_of(filter.model.states), names_of(filter.model.outputs)));
}

std::string estimator_text(const EstimatorDesign& estimator) {
  const std::string& verdict = estimator.model.verdict;
  return fmt::format("uquad, noise from {}{}", internal::printable(estimator.tuned),
                     verdict.empty() ? "" : ", verdict " + internal::printable(verdict));
}

std::string feedback_text(const DesignOutcome& outcome) {
  if (outcome.lqi) return to_text(*outcome.lqi);
  if (outcome.matrix) return to_text(*outcome.matrix);
  const Gains& gains = *outcome.gains;
  const std::vector<std::string> inputs = names_of(gains.inputs);
  std::string text = section("problem", problem_text(outcome));
  text += section("K", table(gains.K, inputs, names_of(gains.states)));
  if (gains.K_int.size())
    text += section("K_int", table(gains.K_int, inputs, names_of(gains.integrals)));
  const double measure = stability_measure(outcome.poles, gains.dt);
  text += section("closed loop",
                  fmt::format("{} = {:.6g}: {}\n", gains.dt > 0 ? "largest |z|" : "largest Re s",
                              measure, measure < (gains.dt > 0 ? 1 : 0) ? "stable" : "UNSTABLE") +
                      pole_table(outcome.poles, gains.dt));
  text += section("margins", to_text(*outcome.margins));
  text += section("evidence", evidence_text(outcome.feedback->riccati));
  if (outcome.published)
    text += section("published", published_text(*outcome.published, *outcome.design.published));
  return text;
}

Json flown_json(const FlownLaw& law) {
  Json json = {{"law", law.name}, {"loop", law.loop ? to_json(*law.loop) : Json(nullptr)}};
  if (law.loop && !law.loop->margins.loops.empty()) json["margins"] = to_json(law.loop->margins);
  if (!law.problem.empty()) json["problem"] = law.problem;
  return json;
}

std::string flown_text(const FlownLaw& law) {
  std::string what = law.name + ": ";
  if (law.loop) what += to_text(*law.loop);
  if (!law.problem.empty()) what += (law.loop ? "\n" : "") + law.problem;
  std::string text = section("flown loop", what);
  if (law.loop && !law.loop->margins.loops.empty())
    text += section("margins of the flown loop", to_text(law.loop->margins));
  return text;
}

/// Whether the gains were designed on the flown plant, whose report has already shown this loop.
bool told_with_the_gains(const DesignOutcome& outcome, const FlownLaw& law) {
  return (outcome.lqi || outcome.matrix) && law.name == "state feedback" && law.problem.empty();
}

/// "pass", "pass with warnings" or "fail".
std::string verdict(const DesignOutcome& outcome, const std::vector<WrittenExport>& written) {
  if (failure_of(outcome, written) != DesignFailure::none) return "fail";
  return design_warnings(outcome).empty() ? "pass" : "pass with warnings";
}

/// All failed checks, and the number of passed ones.
std::string verification_text(const VerifyReport& report) {
  const auto ok = std::count_if(report.checks.begin(), report.checks.end(),
                                [](const VerifyCheck& check) { return check.ok; });
  if (report.ok()) return fmt::format("{} checks passed", ok);
  return fmt::format("{} of {} checks passed\n", ok, report.checks.size()) + to_text(report);
}

std::string written_text(const WrittenExport& written) {
  std::string files;
  for (const ManifestFile& file : written.files) files += (files.empty() ? "" : " ") + file.path;
  return fmt::format("{} for {}: {}\nread back: {}", written.directory, to_string(written.kind),
                     files, verification_text(written.verification));
}

}  // namespace

Json design_json(const DesignOutcome& outcome, const MissionDiagnoses& diagnoses,
                 const std::vector<WrittenExport>& written) {
  const Design& design = outcome.design;
  const TrimResult& trim = outcome.model.trim;
  Json json;
  json["design"] = design.name;
  json["vehicle"] = {{"name", design.vehicle.name},
                     {"mass_kg", design.vehicle.mass},
                     {"thrust_to_weight", thrust_to_weight(design.vehicle)}};
  json["trim"] = {{"at", to_string(design.condition.kind)},
                  {"x", internal::vector_to_json(outcome.model.x0, "x")},
                  {"u", internal::vector_to_json(outcome.model.u0, "u")},
                  {"rotor_speed_rad_s", internal::vector_to_json(trim.u, "u")},
                  {"residual", internal::number_to_json(trim.residual, "residual")}};
  if (outcome.gains) json["lqr"] = lqr_json(outcome);
  if (outcome.cascade) json["pid"] = to_json(*outcome.cascade);
  json["kalman"] = Json::array();
  for (const DesignedFilter& filter : outcome.filters)
    json["kalman"].push_back(filter_json(filter));
  if (design.estimator)
    json["estimator"] = {{"filter", "uquad"},
                         {"tuned", design.estimator->tuned},
                         {"verdict", design.estimator->model.verdict}};
  if (outcome.sampled) json["discretization"] = {{"method", "zoh"}, {"dt", outcome.sampled->dt}};
  if (outcome.published) json["published"] = published_json(*outcome.published, *design.published);
  json["flown"] = Json::array();
  for (const FlownLaw& law : outcome.flown) json["flown"].push_back(flown_json(law));
  json["missions"] = missions_json(outcome, diagnoses);
  json["exports"] = Json::array();
  for (const WrittenExport& one : written) {
    Json entry = {
        {"to", to_string(one.kind)}, {"directory", one.directory}, {"files", to_json(one.files)}};
    entry["verification"] = to_json(one.verification);
    json["exports"].push_back(entry);
  }
  json["warnings"] = design_warnings(outcome);
  json["verdict"] = verdict(outcome, written);
  return json;
}

std::string design_text(const DesignOutcome& outcome, const MissionDiagnoses& diagnoses,
                        const std::vector<WrittenExport>& written) {
  const Design& design = outcome.design;
  std::string text = section(
      "design", design.description.empty() ? design.name : design.name + ": " + design.description);
  text += section("vehicle", design.vehicle.description);
  text += section("trim", trim_text(outcome));
  if (outcome.gains) text += feedback_text(outcome);
  if (outcome.cascade) text += to_text(*outcome.cascade);
  for (const DesignedFilter& filter : outcome.filters)
    text += section("filter", filter_text(filter));
  if (design.estimator) text += section("estimator", estimator_text(*design.estimator));
  for (const FlownLaw& law : outcome.flown)
    if (!told_with_the_gains(outcome, law)) text += flown_text(law);
  if (!outcome.flights.empty()) text += section("missions", missions_text(outcome, diagnoses));
  for (const WrittenExport& one : written) text += section("written", written_text(one));
  for (const std::string& warning : design_warnings(outcome)) text += section("warning", warning);
  return text + section("verdict", verdict(outcome, written));
}

}  // namespace quadtune::report
