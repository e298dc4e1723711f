// SPDX-License-Identifier: Apache-2.0
#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>
#include <filesystem>

#include "quadtune/flight_condition.hpp"
#include "quadtune/internal/joined.hpp"
#include "quadtune/internal/json.hpp"
#include "quadtune/internal/text_file.hpp"
#include "quadtune/model/vehicle.hpp"
#include "quadtune/tuning/match_gains.hpp"
#include "report/gains/gains.hpp"
#include "report/text/print.hpp"
#include "report/text/rows.hpp"

namespace quadtune::report {
namespace {

using internal::Json;

/// Longest command or path that is quoted in full in a file [characters].
constexpr std::size_t kCommentLength = 4096;
/// Tolerance for a weighted sensitivity above 1.
constexpr double kRounding = 1e-6;

Json weights_json(const GainMatch& match) {
  Json rows = Json::array();
  for (const MatchedWeight& weight : match.weights)
    rows.push_back({{"name", weight.name},
                    {"before", weight.before},
                    {"value", weight.value},
                    {"low", weight.low},
                    {"high", weight.high},
                    {"verdict", to_string(weight.verdict)}});
  return rows;
}

std::string weight_table(const GainMatch& match) {
  Json rows = weights_json(match);
  for (std::size_t i = 0; i < rows.size(); ++i) {
    const WeightVerdict verdict = match.weights[i].verdict;
    rows[i]["verdict"] =
        verdict == WeightVerdict::seen ? "" : fmt::format("({})", to_string(verdict));
  }
  return table(rows, {{"name", "weight"},
                      {"before", "start", "", ".6g"},
                      {"value", "found", "", ".8g"},
                      {"low", "from", "", ".5g"},
                      {"high", "to", "", ".5g"},
                      {"verdict"}});
}

bool can_be_lqr(const GainMatch& match) { return match.weighted_sensitivity <= 1 + kRounding; }

std::string kalman_line(const GainMatch& match) {
  // Only for a continuous plant does the inequality not depend on Q.
  const char* why = can_be_lqr(match) ? "at most 1, as for every LQR gain"
                    : match.design.method == LqrMethod::continuous
                        ? "more than 1, so no weights of the states, diagonal or not, give this "
                          "gain with this R"
                        : "more than 1, so the gain is not optimal for these weights";
  return fmt::format("weighted sensitivity {:.6g} at {:.4g} rad/s: {}", match.weighted_sensitivity,
                     match.weighted_sensitivity_at, why);
}

std::string problem_line(const LqrDesign& design) {
  return fmt::format(
      "LQR, {} weights{}, convention {}, inputs {}{}", to_string(design.method),
      design.dt > 0 ? fmt::format(", {:.6g} ms", 1e3 * design.dt) : "", design.convention,
      internal::joined(design.inputs, " "),
      design.integrals.empty()
          ? ""
          : fmt::format(", integral of {}", internal::joined(design.integrals, " ")));
}

// --- TOML ----------------------------------------------------------------------------------------

/// A JSON string is a valid TOML string.
std::string toml_text(const std::string& text) { return internal::json_text(internal::Json(text)); }

std::string words(const std::vector<std::string>& names) {
  std::vector<std::string> all;
  all.reserve(names.size());
  for (const std::string& name : names) all.push_back(toml_text(name));
  return fmt::format("[{}]", internal::joined(all, ", "));
}

std::string row_of(const Eigen::Ref<const Eigen::RowVectorXd>& row) {
  return fmt::format("[{}]", fmt::join(row.begin(), row.end(), ", "));
}

std::string diagonal_of(const Eigen::MatrixXd& M) { return row_of(M.diagonal().transpose()); }

std::string rows_of(const Eigen::MatrixXd& M) {
  std::vector<std::string> rows;
  for (Eigen::Index i = 0; i < M.rows(); ++i) rows.push_back("\n  " + row_of(M.row(i)));
  return fmt::format("[{}\n]", internal::joined(rows, ","));
}

/// The name of a built-in vehicle, or the path of the vehicle file relative to the design file.
std::string vehicle_word(const std::string& vehicle, const std::string& path) {
  const std::vector<std::string> known = built_in_vehicles();
  if (std::find(known.begin(), known.end(), vehicle) != known.end()) return vehicle;
  const std::filesystem::path folder = std::filesystem::absolute(path).parent_path();
  return std::filesystem::absolute(vehicle).lexically_proximate(folder).string();
}

/// A valid name of a design: letters, digits, '.', '_', '-', at most 64 characters.
std::string name_of(const std::string& vehicle) {
  std::string name = vehicle.substr(0, 56);
  for (char& c : name)
    if (!((c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || (c >= '0' && c <= '9'))) c = '-';
  return name + "-matched";
}

std::string trim_table(const FlightCondition& flight) {
  std::string text =
      fmt::format("[trim]\nat = {}\nyaw_rad = {}\n", toml_text(to_string(flight.kind)), flight.yaw);
  const bool circle = flight.kind == FlightKind::circle;
  if (circle || flight.kind == FlightKind::line)
    text += fmt::format("speed_m_per_s = {}\n", flight.speed);
  if (flight.kind != FlightKind::hover) text += fmt::format("climb_m_per_s = {}\n", flight.climb);
  if (circle) text += fmt::format("radius_m = {}\n", flight.radius);
  if (flight.kind == FlightKind::spin)
    text += fmt::format("yaw_rate_rad_per_s = {}\n", flight.yaw_rate);
  return text;
}

}  // namespace

Json to_json(const GainMatchReport& report) {
  const GainMatch& match = report.match;
  Json json;
  json["vehicle"] = report.vehicle.name;
  json["gains"] = report.file;
  json["status"] = to_string(match.status);
  json["convention"] = match.design.convention;
  json["method"] = to_string(match.design.method);
  json["dt"] = match.design.dt;
  json["states"] = match.design.states;
  json["integrals"] = match.design.integrals;
  json["inputs"] = match.design.inputs;
  json["Q"] = internal::matrix_to_json(match.design.Q, "Q");
  json["Q_integral"] = internal::matrix_to_json(match.design.Q_integral, "Q_integral");
  json["R"] = internal::matrix_to_json(match.design.R, "R");
  json["weights"] = weights_json(match);
  json["unseen"] = match.unseen;
  json["K"] = internal::matrix_to_json(match.feedback.K, "K");
  json["K_int"] = internal::matrix_to_json(match.feedback.K_int, "K_int");
  json["difference"] = {{"before", match.before},     {"after", match.after},
                        {"entry", match.worst},       {"entry_given", match.given},
                        {"entry_found", match.found}, {"tolerance", report.tolerance}};
  json["evaluations"] = match.evaluations;
  json["searches"] = {{"made", match.starts}, {"agreeing", match.agreeing}};
  json["weighted_sensitivity"] = {{"value", match.weighted_sensitivity},
                                  {"at", match.weighted_sensitivity_at},
                                  {"can_be_lqr", can_be_lqr(match)}};
  json["excess_cost"] = {{"value", match.excess_cost}, {"state", match.excess_state}};
  json["residual"] = internal::number_to_json(match.feedback.riccati.residual, "residual");
  json["rcond"] = internal::number_to_json(match.feedback.riccati.rcond, "rcond");
  return json;
}

std::string to_text(const GainMatchReport& report) {
  const GainMatch& match = report.match;
  const RiccatiResult& riccati = match.feedback.riccati;
  std::string text =
      section("gains", fmt::format("{}, of {}", report.file, report.vehicle.name)) +
      section("problem", problem_line(match.design)) +
      section("weights", weight_table(match) +
                             fmt::format("\nfrom, to: where the gain would differ by {:.3g}; the "
                                         "geometric mean of R is that of the start",
                                         report.tolerance));
  if (!match.unseen.empty())
    text += section("not determined", fmt::format("{}", internal::joined(match.unseen, "\n")));
  text += section(
      "difference",
      fmt::format(
          "{} at the start, {} at the end, at {}: given {:.8g}, found {:.8g}; tolerance {:.3g}\n"
          "difference of an entry, relative to the largest of its row or column",
          figure(match.before, ".3g"), figure(match.after, ".3g"), match.worst, match.given,
          match.found, report.tolerance));
  text += section("search", fmt::format("{} equations solved; {} of {} searches agree",
                                        match.evaluations, match.agreeing, match.starts));
  text += section(
      "optimality",
      kalman_line(match) +
          (std::isnan(match.excess_cost)
               ? "\nthe additional cost of the given gain is unknown: " + match.excess_culprit
               : fmt::format("\nthe cost of the given gain is {:.2g} % higher than that of the "
                             "found one, for a deviation of {}",
                             100 * match.excess_cost, match.excess_state)));
  text += section("evidence", fmt::format("Riccati residual {:.2g}, reciprocal condition {:.2g}",
                                          riccati.residual, riccati.rcond));
  return text + section("verdict", to_string(match.status));
}

std::string design_file(const GainMatchReport& report, const std::string& path,
                        const std::string& command) {
  const GainMatch& match = report.match;
  const LqrDesign& design = match.design;
  std::string text = fmt::format(
      "# By {}\n# {}: largest difference {:.3g}, relative to the largest of its row or column, at "
      "{}\n"
      "name = {}\ndescription = {}\nvehicle = {}\n\n",
      internal::printable(command, kCommentLength), to_string(match.status), match.after,
      match.worst, toml_text(name_of(report.vehicle.name)),
      toml_text("Weights whose gain is that of " + report.file),
      toml_text(vehicle_word(report.vehicle_word, path)));
  text += trim_table(report.flight);
  text += fmt::format("\n[lqr]\nconvention = {}\ninputs = {}\nstates = {}\nQ = {}\nR = {}\n",
                      toml_text(design.convention), toml_text(to_string(design.input_kind)),
                      words(design.states), diagonal_of(design.Q), diagonal_of(design.R));
  if (!design.integrals.empty())
    text += fmt::format("integral = {}\nQ_integral = {}\n", words(design.integrals),
                        diagonal_of(design.Q_integral));
  text += fmt::format("method = {}\n", toml_text(to_string(design.method)));
  if (design.dt > 0) text += fmt::format("dt_s = {}\n", design.dt);
  text += fmt::format("\n[published]\nsource = {}\nK = {}\n", toml_text(report.file),
                      rows_of(report.K));
  if (!design.integrals.empty()) text += fmt::format("K_int = {}\n", rows_of(report.K_int));
  return text;
}

}  // namespace quadtune::report
