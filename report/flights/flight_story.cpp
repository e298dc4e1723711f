// SPDX-License-Identifier: Apache-2.0
#include "report/flights/flight_story.hpp"

#include <fmt/format.h>

#include <cmath>
#include <numbers>

#include "quadtune/internal/json.hpp"
#include "quadtune/version.hpp"
#include "report/loops/flown_report.hpp"
#include "report/text/print.hpp"

namespace quadtune::report {
namespace {

using internal::finite_or_null;
using internal::Json;

std::vector<std::string> state_names() { return names_or_numbers(ned_convention().states, 12); }

/// The k-th of the names of a group.
std::array<std::string, 3> columns(const std::string& group) {
  return {group + ".px", group + ".py", group + ".pz"};
}

constexpr double kDegrees = 180 / std::numbers::pi;

/// What was, what was asked for and what was believed of one state.
ReportPlot state_plot(const std::string& title, const std::string& unit,
                      const std::vector<std::string>& states, bool referred, double factor = 1) {
  ReportPlot plot;
  plot.title = title;
  plot.unit = unit;
  plot.factor = factor;
  for (const std::string& state : states) {
    plot.series.push_back({state, "x." + state, SeriesStyle::value});
    if (referred)
      plot.series.push_back({state + " asked for", "reference." + state, SeriesStyle::reference});
    plot.series.push_back({state + " believed", "estimate." + state, SeriesStyle::estimate});
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
      plot_of(log, "Thrust asked for", "N", "command", {"T"}, SeriesStyle::value),
      plot_of(log, "Torques asked for", "N m", "command", {"tau_x", "tau_y", "tau_z"},
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
  const CascadeGains& gains = std::get<CascadeController>(controller).gains;
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

const WidenedLimit* widened_of(const PlannedFlight& plan, Metric metric) {
  for (const WidenedLimit& widened : plan.widened)
    if (widened.what == name_of(metric)) return &widened;
  return nullptr;
}

Json bound_json(const PlannedFlight& plan) {
  const MissionBound& bound = *plan.bound;
  const auto size = [](const ErrorSize& error) {
    return Json{{"rms", finite_or_null(error.rms)},
                {"rms_rarely", finite_or_null(error.rms_rarely)},
                {"most_rarely", finite_or_null(error.most_rarely)}};
  };
  Json json = {{"sensors", bound.bound.used},
               {"height_m", bound.options.height},
               {"tracking_m", size(bound.tracking)},
               {"horizontal_rms_m", finite_or_null(bound.horizontal_rms)},
               {"vertical_m", size(bound.height)},
               {"yaw_rad", size(bound.heading)},
               {"estimate_m", size(bound.estimate)},
               {"at_the_end", Json{{"horizontal_rms_m", finite_or_null(bound.horizontal_end)},
                                   {"vertical_rms_m", finite_or_null(bound.height_end)},
                                   {"yaw_rms_rad", finite_or_null(bound.heading_end)}}}};
  json["widened"] = Json::array();
  for (const WidenedLimit& widened : plan.widened)
    json["widened"].push_back({{"what", widened.what},
                               {"unit", widened.unit},
                               {"asked", widened.asked},
                               {"sensors_rms", finite_or_null(widened.bound)},
                               {"judged_by", widened.judged}});
  return json;
}

/// What the sensors can know, and the limits that follow from it.
std::string bound_text(const PlannedFlight& plan) {
  if (!plan.bound) return "";
  const MissionBound& bound = *plan.bound;
  std::string text = "\nbound of the sensors, rms (best filter, whatever is flown)\n";
  text += fmt::format("  position {:.3g} m, height {:.3g} m, yaw {:.3g} rad; ", bound.tracking.rms,
                      bound.height.rms, bound.heading.rms);
  text += fmt::format("at the end {:.3g} m\n", std::hypot(bound.horizontal_end, bound.height_end));
  for (const WidenedLimit& widened : plan.widened) {
    const std::string unit = widened.unit == "1" ? "" : " " + widened.unit;
    text += fmt::format("  {:<34} judged by {:.4g}{} instead of {:.4g}{}\n", widened.label,
                        widened.judged, unit, widened.asked, unit);
  }
  return text;
}

Json to_json(const Diagnosis& diagnosis) {
  const FlightEvidence& evidence = diagnosis.evidence;
  return {{"cause", to_string(diagnosis.cause)},
          {"why", diagnosis.why},
          {"next", diagnosis.next},
          {"passes_with_true_states", evidence.passes_with_true_states},
          {"passes_with_ideal_sensors", evidence.passes_with_ideal_sensors},
          {"saturation", finite_or_null(evidence.saturation)},
          {"saturation_with_true_states", finite_or_null(evidence.saturation_with_true_states)},
          {"estimate_rms_m", finite_or_null(evidence.estimate_rms)},
          {"bound_rms_m", finite_or_null(evidence.bound_rms)},
          {"largest_pole", finite_or_null(evidence.largest_pole)}};
}

Json seeds_json(const std::vector<SeedVerdict>& seeds) {
  Json json = Json::array();
  for (const SeedVerdict& seed : seeds) {
    Json entry = {{"seed", seed.seed},
                  {"verdict", seed.passed ? "pass" : "fail"},
                  {"end", to_string(seed.end)}};
    if (!seed.reason.empty()) entry["reason"] = seed.reason;
    json.push_back(entry);
  }
  return json;
}

}  // namespace

std::string circumstances(const PlannedFlight& plan) {
  return fmt::format("{}; estimator {}, {} sensors, wind {}, seed {}", plan.law, plan.estimator,
                     plan.sensors, plan.wind, plan.setup.seed);
}

Json to_json(const FlownFlight& flight, const std::optional<Diagnosis>& diagnosis) {
  const FlightResult& result = flight.result;
  const FlightSetup& setup = flight.plan.setup;
  Json json = {{"vehicle", setup.vehicle.name},
               {"mission", setup.mission.name},
               {"law", flight.plan.law},
               {"estimator", flight.plan.estimator},
               {"sensors", flight.plan.sensors},
               {"flow", to_string(setup.flow)},
               {"wind", flight.plan.wind},
               {"seed", setup.seed},
               {"verdict", flight.passed ? "pass" : "fail"},
               {"end", to_string(result.end)},
               {"end_time_s", result.end_time}};
  if (!result.culprit.empty()) json["culprit"] = result.culprit;
  json["metrics"] = Json::object();
  for (std::size_t i = 0; i < kMetrics; ++i) {
    const auto metric = static_cast<Metric>(i);
    const std::string& unit = unit_of(metric);
    const std::string key = name_of(metric) + (unit == "1" ? "" : "_" + unit);
    json["metrics"][key] = finite_or_null(result.metrics[metric]);
  }
  json["limits"] = Json::array();
  for (const LimitCheck& check : flight.verdict.checks) {
    json["limits"].push_back({{"metric", name_of(check.metric)},
                              {"value", finite_or_null(check.value)},
                              {check.at_least ? "at_least" : "at_most", check.bound},
                              {"ok", check.ok}});
    if (const WidenedLimit* widened = widened_of(flight.plan, check.metric)) {
      json["limits"].back()["asked"] = widened->asked;
      json["limits"].back()["sensors_rms"] = widened->bound;
    }
  }
  if (flight.plan.bound) json["sensor_bound"] = bound_json(flight.plan);
  if (flight.loop) json["flown_loop"] = to_json(*flight.loop);
  json["reasons"] = reasons(flight);
  if (diagnosis && diagnosis->cause != FlightCause::none) json["diagnosis"] = to_json(*diagnosis);
  if (!flight.variant.empty()) json["disturbance"] = flight.variant;
  if (!flight.seeds.empty()) json["seeds"] = seeds_json(flight.seeds);
  json["events"] = Json::array();
  for (const LogEvent& event : result.events)
    json["events"].push_back({{"t", event.time}, {"name", event.name}, {"detail", event.detail}});
  json["final_state"] = Json::object();
  json["final_estimate"] = Json::object();
  const std::vector<std::string> names = state_names();
  for (std::size_t i = 0; i < 12; ++i) {
    json["final_state"][names[i]] = finite_or_null(result.final_state(static_cast<int>(i)));
    json["final_estimate"][names[i]] = finite_or_null(result.final_estimate(static_cast<int>(i)));
  }
  json["steps"] = result.steps;
  json["wall_s"] = flight.wall_s;
  return json;
}

std::string seeds_table(const std::vector<SeedVerdict>& seeds) {
  std::string text =
      fmt::format("{:>6} {:<8}{:>9}{:>9}{:>9}{:>9}{:>9}{:>9}{:>11}\n", "seed", "verdict", "rms",
                  "greatest", "end", "settled", "yaw", "tilt", "limited");
  text += fmt::format("{:>6} {:<8}{:>9}{:>9}{:>9}{:>9}{:>9}{:>9}{:>11}\n", "", "", "[m]", "[m]",
                      "[m]", "[s]", "[rad]", "[rad]", "motor [s]");
  for (const SeedVerdict& seed : seeds) {
    text += fmt::format("{:>6} {:<8}", seed.seed, seed.passed ? "pass" : "FAIL");
    for (const Metric metric :
         {Metric::tracking_rms, Metric::tracking_max, Metric::final_distance, Metric::settling_time,
          Metric::yaw_max, Metric::tilt_max, Metric::saturation_time}) {
      const double value = seed.metrics[metric];
      const int width = metric == Metric::saturation_time ? 11 : 9;
      text += std::isnan(value)   ? fmt::format("{:>{}}", "-", width)
              : std::isinf(value) ? fmt::format("{:>{}}", "never", width)
                                  : fmt::format("{:>{}.3g}", value, width);
    }
    text += "\n";
  }
  return text;
}

std::string to_text(const FlownFlight& flight, const std::optional<Diagnosis>& diagnosis) {
  const FlightResult& result = flight.result;
  const FlightSetup& setup = flight.plan.setup;
  std::string text =
      fmt::format("{} flies {}: {}\n  {}\n\n", setup.vehicle.name, setup.mission.name,
                  setup.mission.description, circumstances(flight.plan));
  const std::vector<std::string> why = reasons(flight);
  text += fmt::format("verdict: {}\n", flight.passed ? "pass" : "fail");
  for (const std::string& reason : why) text += "  " + reason + "\n";
  if (diagnosis && diagnosis->cause != FlightCause::none)
    text += fmt::format("why: {}\nnext: {}\n", diagnosis->why, diagnosis->next);
  text += "\n";
  const auto limit_of = [&](Metric metric) -> const LimitCheck* {
    for (const LimitCheck& check : flight.verdict.checks)
      if (check.metric == metric) return &check;
    return nullptr;
  };
  for (std::size_t i = 0; i < kMetrics; ++i) {
    const auto metric = static_cast<Metric>(i);
    const double value = result.metrics[metric];
    const LimitCheck* check = limit_of(metric);
    if (std::isnan(value) && check == nullptr) continue;
    std::string limit;
    if (check != nullptr)
      limit = fmt::format("{} {}{}{}", check->at_least ? "at least" : "at most",
                          in_words(metric, check->bound),
                          widened_of(flight.plan, metric) != nullptr ? " (widened)" : "",
                          check->ok ? "" : "  NOT KEPT");
    const std::string line =
        fmt::format("  {:<34} {:<14} {}", label_of(metric), in_words(metric, value), limit);
    text += line.substr(0, line.find_last_not_of(' ') + 1) + "\n";
  }
  text += bound_text(flight.plan);
  if (!result.events.empty()) text += "\nevents\n";
  for (const LogEvent& event : result.events)
    text += fmt::format("  {:>8.3f} s  {}{}\n", event.time, event.name,
                        event.detail.empty() ? "" : ": " + event.detail);
  text += fmt::format("\n{:.4g} s in {:.2g} s of computing, {} steps of {}\n", result.end_time,
                      flight.wall_s, result.steps, to_string(setup.integrator));
  return text;
}

FlightReport report_of(const FlownFlight& flight, const std::string& command,
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
        row.limit_is_least = check.at_least;
        row.ok = check.ok;
      }
    if (!std::isnan(row.value) || row.limit) report.metrics.push_back(row);
  }
  report.log = flight.result.log;
  auto& about = report.log.about;
  about.insert(about.begin() + 2, {"law", flight.plan.law});
  about.insert(about.begin() + 2, {"description", setup.mission.description});
  about.push_back({"wind", flight.plan.wind});
  for (const WidenedLimit& widened : flight.plan.widened)
    about.push_back({widened.label, in_words(widened)});
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
