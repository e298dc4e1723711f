// SPDX-License-Identifier: Apache-2.0
#include "quadtune/workbench/design/lqi_report.hpp"

#include <fmt/format.h>

#include "quadtune/exports/content.hpp"
#include "quadtune/exports/export.hpp"
#include "quadtune/exports/stored_estimator.hpp"
#include "quadtune/gains.hpp"
#include "quadtune/internal/json.hpp"
#include "quadtune/model/vehicle.hpp"
#include "quadtune/workbench/design/lqg_report.hpp"
#include "quadtune/workbench/design/margins_report.hpp"
#include "quadtune/workbench/flown/flown_loop.hpp"
#include "report/gains/gains.hpp"
#include "report/loops/loops.hpp"
#include "report/loops/margins_report.hpp"
#include "report/text/print.hpp"
#include "report/text/rows.hpp"

namespace quadtune::report {
namespace {

using internal::Json;

/// "T[k-1]", "tau_x[k-1]", …
std::vector<std::string> past_names(const std::vector<Signal>& inputs, int past) {
  std::vector<std::string> result;
  for (int j = 1; j <= past; ++j)
    for (const Signal& input : inputs) result.push_back(fmt::format("{}[k-{}]", input.name, j));
  return result;
}

Eigen::RowVectorXd row(const Eigen::MatrixXd& M) { return M.diagonal().transpose(); }

std::string weights_text(const LqiReport& report) {
  const ActuatorLqiWeights& weights = report.design.weights;
  const Gains& gains = report.design.lqi.gains;
  std::string text = table(row(weights.Q), {"Q"}, names_of(gains.states));
  if (!gains.integrals.empty())
    text += "\n" + table(row(weights.Q_integral), {"Q_int"}, names_of(gains.integrals));
  text += "\n" + table(row(weights.R), {"R"}, names_of(gains.inputs));
  if (weights.R_change.size() > 0)
    text += "\n" + table(row(weights.R_change), {"change"}, names_of(gains.inputs));
  return text;
}

std::string law_text(const LqiReport& report) {
  const Gains& gains = report.design.lqi.gains;
  std::string text = fmt::format("LQI sampled every {} s", number(gains.dt));
  if (!gains.memory) return text;
  if (gains.memory->K_lag.cwiseAbs().maxCoeff() > 0)
    text += fmt::format(", with the rotors' lag of {} s", number(gains.memory->lag(0)));
  if (gains.memory->past > 0)
    text += fmt::format(", with {} past command{}", gains.memory->past,
                        gains.memory->past == 1 ? "" : "s");
  return text;
}

}  // namespace

void add_gains(Json& json, const Gains& gains) {
  json["K"] = internal::matrix_to_json(gains.K, "K");
  json["K_int"] = internal::matrix_to_json(gains.K_int, "K_int");
  json["states"] = internal::signals_to_json(gains.states);
  json["inputs"] = internal::signals_to_json(gains.inputs);
  json["integrals"] = names_of(gains.integrals);
  json["dt_s"] = gains.dt;
}

void add_loops(Json& json, const FlownLoop& flown, const MarginsReport& ideal) {
  json["flown"] = to_json(flown);
  json["margins"] = to_json(flown.margins);
  json["ideal"] = to_json(ideal);
}

void add_export(Json& json, const Vehicle& vehicle, const Gains& gains,
                const std::optional<StoredEstimator>& estimator) {
  ExportContent content;
  content.vehicle = vehicle;
  content.gains = gains;
  content.estimator = estimator;
  add_laws(json, content);
}

Json to_json(const LqiReport& report, const Vehicle& vehicle) {
  const FlownLqi& design = report.design;
  const Gains& gains = design.lqi.gains;
  Json json = {{"status", to_string(design.lqi.riccati.status)}, {"plant", "flown"}};
  add_gains(json, gains);
  if (gains.memory)
    json["memory"] = {{"lag_s", internal::vector_to_json(gains.memory->lag, "lag")},
                      {"K_lag", internal::matrix_to_json(gains.memory->K_lag, "K_lag")},
                      {"past", gains.memory->past},
                      {"K_past", internal::matrix_to_json(gains.memory->K_past, "K_past")}};
  else
    json["memory"] = nullptr;
  Json& weights = json["weights"];
  weights["Q"] = internal::vector_to_json(design.weights.Q.diagonal(), "Q");
  weights["Q_integral"] = internal::vector_to_json(design.weights.Q_integral.diagonal(), "Q_int");
  weights["R"] = internal::vector_to_json(design.weights.R.diagonal(), "R");
  weights["R_change"] =
      design.weights.R_change.size() > 0
          ? internal::vector_to_json(design.weights.R_change.diagonal(), "R_change")
          : Json();
  weights["softened"] = design.softened;
  weights["lowered"] = design.lowered;
  weights["margins_met"] = design.met;
  json["poles"] = internal::poles_to_json(design.lqi.riccati.poles, "poles");
  json["residual"] = internal::number_to_json(design.lqi.riccati.residual, "residual");
  json["rcond"] = internal::number_to_json(design.lqi.riccati.rcond, "rcond");
  json["notes"] = design.notes;
  add_loops(json, report.flown, report.ideal);
  add_export(json, vehicle, gains, report.estimator);
  return json;
}

std::string to_text(const LqiReport& report) {
  const Gains& gains = report.design.lqi.gains;
  const std::vector<std::string> inputs = names_of(gains.inputs);
  std::string text = section("law", law_text(report)) + section("weights", weights_text(report)) +
                     section("gain K", table(gains.K, inputs, names_of(gains.states)));
  if (!gains.integrals.empty())
    text += section("integral K", table(gains.K_int, inputs, names_of(gains.integrals)));
  if (gains.memory) {
    if (gains.memory->K_lag.cwiseAbs().maxCoeff() > 0)
      text += section("lag K", table(gains.memory->K_lag, inputs, inputs));
    if (gains.memory->past > 0)
      text += section("past K", table(gains.memory->K_past, inputs,
                                      past_names(gains.inputs, gains.memory->past)));
  }
  return text + section("flown loop", to_text(report.flown)) +
         section("margins of the flown loop", to_text(report.flown.margins)) +
         section("margins of the ideal plant", to_text(report.ideal));
}

namespace {

using internal::Json;

Json recoveries_json(const LqgReport& report) {
  Json rows = Json::array();
  for (const Recovery& tried : report.recoveries)
    rows.push_back({{"factor", tried.factor},
                    {"share_of_margins", tried.share},
                    {"command_noise", tried.noise},
                    {"affordable", tried.affordable}});
  return rows;
}

std::string recovery_text(const LqgReport& report) {
  return fmt::format(
      "the filter's inertial noise times {}\n{}", number(report.recovery),
      table(recoveries_json(report), {{"factor", "factor", "", ".6g"},
                                      {"share_of_margins", "share of margins", "", ".3f"},
                                      {"command_noise", "command noise", "", ".3f"},
                                      {.key = "affordable", .no = "exceeds the budget"}}));
}

}  // namespace

Json to_json(const LqgReport& report, const Vehicle& vehicle) {
  Json json = to_json(report.lqi, vehicle);
  json["margins_at_estimates"] = to_json(report.at_estimates);
  const auto by_name = [](const std::vector<Signal>& signals, const Eigen::VectorXd& values) {
    Json table = Json::object();
    for (std::size_t i = 0; i < signals.size(); ++i)
      table[signals[i].name] = values(static_cast<Eigen::Index>(i));
    return table;
  };
  const Gains& gains = report.lqi.design.lqi.gains;
  json["predicted_rms"] = {{"time_s", report.rms.time},
                           {"state", by_name(gains.states, report.rms.state)},
                           {"estimate_error", by_name(gains.states, report.rms.error)},
                           {"command", by_name(gains.inputs, report.rms.command)}};
  json["recovery"] = {{"factor", report.recovery}, {"tried", recoveries_json(report)}};
  return json;
}

std::string to_text(const LqgReport& report) {
  const Gains& gains = report.lqi.design.lqi.gains;
  Eigen::MatrixXd rms(2, 12);
  rms << report.rms.state.transpose(), report.rms.error.transpose();
  std::string text =
      to_text(report.lqi) + section("margins at the estimates", to_text(report.at_estimates)) +
      section(fmt::format("rms after {} s", number(report.rms.time)),
              !rms.allFinite()
                  ? "infinite, because the flown loop is unstable"
                  : table(rms, {"true", "estimate's error"}, names_of(gains.states)) + "\n" +
                        table(report.rms.command.transpose(), {"command"}, names_of(gains.inputs)));
  if (!report.recoveries.empty()) text += section("recovery", recovery_text(report));
  return text;
}

void add_laws(internal::Json& json, const ExportContent& content) {
  const internal::Json stored = internal::Json::parse(gains_json_text(content));
  for (const char* key :
       {"format", "format_version", "gains", "cascade", "estimator", "parameters"})
    if (stored.contains(key)) json[key] = stored[key];
}

}  // namespace quadtune::report
