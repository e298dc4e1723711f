// SPDX-License-Identifier: Apache-2.0
#include "report/gains/lqg_report.hpp"

#include <fmt/format.h>

#include "quadtune/internal/json.hpp"
#include "report/gains/lqi_report.hpp"
#include "report/loops/margins_report.hpp"
#include "report/text/print.hpp"
#include "report/text/text_table.hpp"

namespace quadtune::report {
namespace {

using internal::Json;

std::string recovery_text(const LqgReport& report) {
  TextTable table({{"factor", 8}, {"share of margins", 20}, {"command noise", 16}, {"", 0}});
  for (const Recovery& tried : report.recoveries)
    table.row({number(tried.factor), fmt::format("{:.3f}", tried.share),
               fmt::format("{:.3f}", tried.noise), tried.affordable ? "" : "  exceeds the budget"});
  return fmt::format("the filter's inertial noise times {}\n{}", number(report.recovery),
                     table.text());
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
  Json recoveries = Json::array();
  for (const Recovery& tried : report.recoveries)
    recoveries.push_back({{"factor", tried.factor},
                          {"share_of_margins", internal::finite_or_null(tried.share)},
                          {"command_noise", internal::finite_or_null(tried.noise)},
                          {"affordable", tried.affordable}});
  json["recovery"] = {{"factor", report.recovery}, {"tried", recoveries}};
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
