// SPDX-License-Identifier: Apache-2.0
#include <fmt/format.h>

#include <cmath>
#include <numbers>

#include "quadtune/version.hpp"
#include "quadtune/workbench/flight/diagnosis.hpp"
#include "quadtune/workbench/flight/fly.hpp"
#include "report/flights/flights.hpp"
#include "report/page/flight_report.hpp"
#include "report/text/print.hpp"

namespace quadtune::report {
namespace {

/// The names of the position columns of a group.
std::array<std::string, 3> columns(const std::string& group) {
  return {group + ".px", group + ".py", group + ".pz"};
}

constexpr double kDegrees = 180 / std::numbers::pi;

/// The true value, the set point and the estimate of some states.
ReportPlot state_plot(const std::string& title, const std::string& unit,
                      const std::vector<std::string>& states, bool referred, double factor = 1) {
  ReportPlot plot;
  plot.title = title;
  plot.unit = unit;
  plot.factor = factor;
  for (const std::string& state : states) {
    plot.series.push_back({state, "x." + state, SeriesStyle::value});
    if (referred)
      plot.series.push_back({state + " set point", "reference." + state, SeriesStyle::reference});
    plot.series.push_back({state + " estimate", "estimate." + state, SeriesStyle::estimate});
  }
  return plot;
}

ReportPlot plot_of(const LogTable& log, const std::string& title, const std::string& unit,
                   const std::string& group, const std::vector<std::string>& names,
                   SeriesStyle style) {
  ReportPlot plot;
  plot.title = title;
  plot.unit = unit;
  for (const std::string& name : names) {
    const std::string column = group.empty() ? name : fmt::format("{}.{}", group, name);
    if (log.find(column) != nullptr) plot.series.push_back({name, column, style});
  }
  return plot;
}

std::vector<ReportPlot> plots_of(const FlownFlight& flight) {
  const LogTable& log = flight.result.log;
  std::vector<std::string> rotors;
  for (std::size_t i = 1; i <= flight.plan.setup.vehicle.rotors.size(); ++i)
    rotors.push_back(fmt::format("w{}", i));
  std::vector<ReportPlot> plots = {
      state_plot("Horizontal position", "m", {"px", "py"}, true),
      state_plot("Height, downward", "m", {"pz"}, true),
      state_plot("Roll and pitch", "deg", {"roll", "pitch"}, false, kDegrees),
      state_plot("Yaw", "deg", {"yaw"}, true, kDegrees),
      state_plot("Body velocity", "m/s", {"u", "v", "w"}, false),
      state_plot("Body rates", "deg/s", {"p", "q", "r"}, false, kDegrees),
      plot_of(log, "Commanded thrust", "N", "command", {"T"}, SeriesStyle::value),
      plot_of(log, "Commanded torques", "N m", "command", {"tau_x", "tau_y", "tau_z"},
              SeriesStyle::value),
      plot_of(log, "Rotor speeds", "rad/s", "x", rotors, SeriesStyle::value),
      plot_of(log, "Accelerometer", "m/s^2", "accelerometer", {"x", "y", "z"},
              SeriesStyle::measurement),
      plot_of(log, "Gyroscope", "rad/s", "gyroscope", {"x", "y", "z"}, SeriesStyle::measurement),
      plot_of(log, "Sonar", "m", "", {"sonar"}, SeriesStyle::measurement),
      plot_of(log, "Optical flow", "rad/s", "flow", {"x", "y"}, SeriesStyle::measurement),
      plot_of(log, "Barometer", "Pa", "", {"barometer"}, SeriesStyle::measurement),
      plot_of(log, "Satellite position", "m", "gps", {"px", "py", "pz"}, SeriesStyle::measurement),
      plot_of(log, "Position from images", "m", "vision", {"px", "py", "pz"},
              SeriesStyle::measurement),
      plot_of(log, "Battery", "V", "battery", {"voltage"}, SeriesStyle::value),
      plot_of(log, "Wind", "m/s", "wind", {"north", "east", "down"}, SeriesStyle::value)};
  std::erase_if(plots, [](const ReportPlot& plot) { return plot.series.empty(); });
  return plots;
}

std::vector<GainTable> gains_of(const Controller& controller) {
  if (const auto* feedback = std::get_if<StateFeedbackController>(&controller)) {
    const Gains& gains = feedback->gains;
    const auto rows = names_or_numbers(gains.inputs, gains.K.rows());
    const std::string where = feedback->schedule ? " at hover, by a schedule elsewhere" : "";
    std::vector<GainTable> tables = {
        {"K" + where + ", on the states of convention " + gains.convention, rows,
         names_or_numbers(gains.states, gains.K.cols()), gains.K}};
    if (gains.K_int.cols() > 0)
      tables.push_back({"K_int, on their integrals", rows,
                        names_or_numbers(gains.integrals, gains.K_int.cols()), gains.K_int});
    return tables;
  }
  const auto* cascade = std::get_if<CascadeController>(&controller);
  if (cascade == nullptr) return {};  // a law of the user, whose gains are unknown
  const CascadeGains& gains = cascade->gains;
  GainTable table;
  table.title = "PID loops";
  table.columns = {"Kp", "Ki", "Kd"};
  table.values.resize(std::ssize(gains.loops), 3);
  for (std::size_t i = 0; i < gains.loops.size(); ++i) {
    const PidLoop& loop = gains.loops[i];
    table.rows.push_back(fmt::format("{} to {} [{}]", loop.name, loop.output, loop.unit));
    table.values.row(static_cast<Eigen::Index>(i)) << loop.Kp, loop.Ki, loop.Kd;
  }
  return {table};
}

ReportReplay replay_of(const Vehicle& vehicle) {
  ReportReplay replay;
  replay.position = columns("x");
  replay.attitude = {"x.qw", "x.qx", "x.qy", "x.qz"};
  replay.reference = columns("reference");
  replay.estimate = columns("estimate");
  for (std::size_t i = 0; i < vehicle.rotors.size(); ++i)
    replay.rotors.push_back({vehicle.rotors[i].position,
                             static_cast<int>(spin_sign(vehicle.rotors[i].spin)),
                             fmt::format("x.w{}", i + 1)});
  if (!vehicle.rotors.empty() && std::isfinite(vehicle.rotors[0].radius))
    replay.rotor_radius = vehicle.rotors[0].radius;
  return replay;
}

std::vector<MarginRow> margin_rows(const MarginsReport& margins) {
  std::vector<MarginRow> rows;
  for (std::size_t i = 0; i < margins.loops.size(); ++i) {
    const LoopMargins& loop = margins.loops[i];
    rows.push_back({i < margins.names.size() ? margins.names[i] : "loop",
                    {{"gain margin", "dB", decibels(loop.gain_margin)},
                     {"phase margin", "deg", degrees(loop.phase_margin)},
                     {"delay margin", "s", loop.delay_margin},
                     {"disk gain margin", "dB", decibels(loop.disk.gain_high)},
                     {"Ms", "", loop.Ms}}});
  }
  return rows;
}

std::vector<ReportMetric> metric_rows(const FlownFlight& flight) {
  std::vector<ReportMetric> rows;
  for (std::size_t i = 0; i < kMetrics; ++i) {
    const auto metric = static_cast<Metric>(i);
    ReportMetric row;
    row.name = name_of(metric);
    row.label = label_of(metric);
    row.value = flight.result.metrics[metric];
    row.unit = unit_of(metric);
    for (const LimitCheck& check : flight.verdict.checks)
      if (check.metric == metric) {
        row.limit = check.bound;
        row.limit_is_minimum = check.at_least;
        row.ok = check.ok;
      }
    if (!std::isnan(row.value) || row.limit) rows.push_back(row);
  }
  return rows;
}

}  // namespace

FlightReport flight_page(const FlownFlight& flight, const std::string& command,
                         const std::optional<Diagnosis>& diagnosis) {
  const FlightSetup& setup = flight.plan.setup;
  FlightReport report;
  report.title = fmt::format("{} flies {}", setup.vehicle.name, setup.mission.name);
  report.verdict = flight.passed ? ReportVerdict::pass : ReportVerdict::fail;
  report.reasons = reasons(flight);
  if (flight.passed) report.reasons.push_back("flown to the end");
  if (diagnosis && diagnosis->cause != FlightCause::none) {
    report.reasons.push_back("why: " + diagnosis->why);
    report.reasons.push_back("next: " + diagnosis->next);
  }
  report.metrics = metric_rows(flight);
  report.log = flight.result.log;
  auto& about = report.log.about;
  about.insert(about.begin() + 2, {"law", flight.plan.law});
  about.insert(about.begin() + 2, {"description", setup.mission.description});
  about.push_back({"wind", flight.plan.wind});
  for (const WidenedLimit& widened : flight.plan.widened)
    about.push_back({widened.label, describe(widened)});
  report.plots = plots_of(flight);
  report.replay = replay_of(setup.vehicle);
  report.gains = gains_of(setup.controller);
  if (flight.plan.margins) report.margins = margin_rows(*flight.plan.margins);
  report.command = command;
  report.version = std::string(kVersion);
  report.seed = fmt::format("{}", setup.seed);
  return report;
}

}  // namespace quadtune::report
