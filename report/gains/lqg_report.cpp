// SPDX-License-Identifier: Apache-2.0
#include "report/gains/lqg_report.hpp"

#include <fmt/format.h>

#include "quadtune/internal/json.hpp"
#include "report/gains/lqi_report.hpp"
#include "report/loops/margins_report.hpp"
#include "report/text/print.hpp"
#include "report/text/rows.hpp"

namespace quadtune::report {
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
      table[signals[i].name] = internal::finite_or_null(values(static_cast<Eigen::Index>(i)));
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
              table(rms, {"true", "estimate's error"}, names_of(gains.states)) + "\n" +
                  table(report.rms.command.transpose(), {"command"}, names_of(gains.inputs)));
  if (!report.recoveries.empty()) text += section("recovery", recovery_text(report));
  return text;
}

}  // namespace quadtune::report
