// SPDX-License-Identifier: Apache-2.0
#include <fmt/format.h>

#include <numbers>

#include "quadtune/internal/json.hpp"
#include "quadtune/tuning/allan.hpp"
#include "quadtune/workbench/logs/allan_of_log.hpp"
#include "report/logs/logs.hpp"
#include "report/text/print.hpp"
#include "report/text/rows.hpp"

namespace quadtune::report {
namespace {

constexpr double kDegree = 180 / std::numbers::pi;
constexpr double kHour = 3600;    // [s]
constexpr double kRootHour = 60;  // [√s]
constexpr double kMilliG = 1e3 / 9.80665;

/// A noise component with its names and units.
struct AllanLine {
  std::string title;
  std::string key;  ///< in JSON
  AllanReading reading;
  std::string unit;
  double factor = 1;       ///< factor from `unit` to `other_unit`
  std::string other_unit;  ///< unit of data sheets; empty for none
};

/// The units of N, B, K and Q of a rate, and those of data sheets with the factors to them.
struct Units {
  std::string density, floor, walk, quantum;
  double to_density = 1, to_floor = 1, to_walk = 1, to_quantum = 1;
  std::string other_density, other_floor, other_walk, other_quantum;
};

Units units_of(const std::string& unit) {
  const bool degrees = unit == "deg/s";
  if (degrees || unit == "rad/s" || unit == "rad s^-1") {
    const double to_degrees = degrees ? 1 : kDegree;
    const std::string angle = degrees ? "deg" : "rad";
    return {angle + "/s/sqrt(Hz)",
            angle + "/s",
            angle + "/s^2/sqrt(Hz)",
            angle,
            to_degrees * kRootHour,
            to_degrees * kHour,
            to_degrees * kHour * kRootHour,
            to_degrees * kHour,
            "deg/sqrt(h)",
            "deg/h",
            "deg/h/sqrt(h)",
            "arcsec"};
  }
  if (unit == "m/s^2" || unit == "m/s2" || unit == "m s^-2")
    return {"m/s^2/sqrt(Hz)", "m/s^2", "m/s^3/sqrt(Hz)", "m/s", 1e3 * kMilliG,   kMilliG,
            kRootHour,        1e3,     "ug/sqrt(Hz)",    "mg",  "m/s^2/sqrt(h)", "mm/s"};
  const std::string name = unit.empty() ? "1" : unit;
  return {name + "/sqrt(Hz)", name, name + "/s/sqrt(Hz)", name + " s", 1, 1, 1, 1, "", "", "", ""};
}

/// Noise density, bias instability, random walk, quantization.
std::vector<AllanLine> allan_lines(const AllanAnalysis& a, const std::string& unit) {
  const Units u = units_of(unit);
  const bool angle = !u.other_floor.empty() && u.other_floor == "deg/h";
  return {{angle ? "noise density (angle random walk), slope -1/2, at tau = 1 s"
                 : "noise density, slope -1/2, at tau = 1 s",
           "noise_density", a.noise_density, u.density, u.to_density, u.other_density},
          {"bias instability, minimum deviation / 0.664", "bias_instability", a.bias_instability,
           u.floor, u.to_floor, u.other_floor},
          {"random walk, slope +1/2, at tau = 3 s", "random_walk", a.random_walk, u.walk, u.to_walk,
           u.other_walk},
          {"quantization, slope -1, at tau = sqrt(3) s", "quantization", a.quantization, u.quantum,
           u.to_quantum, u.other_quantum}};
}

using internal::Json;

Json reading_json(const AllanReading& reading, const std::string& unit) {
  Json json = {{"seen", reading.seen}, {"unit", unit}};
  if (reading.seen) {
    json["value"] = reading.value;
    json["low"] = reading.low;
    json["high"] = reading.high;
    json["tau_from"] = reading.tau_from;
    json["tau_to"] = reading.tau_to;
  } else {
    json["at_most"] = reading.at_most > 0 ? Json(reading.at_most) : Json(nullptr);
  }
  json["reason"] = reading.reason;
  return json;
}

std::string curve_table(const AllanAnalysis& analysis) {
  Cells cells = {{"tau [s]", "deviation", "95 % interval", "d.o.f.", "fit"}};
  for (const AllanCurvePoint& at : analysis.curve)
    cells.push_back({figure(at.point.tau, ".5g"), figure(at.point.deviation, ".4e"),
                     fmt::format("{:.4e} to {:.4e}", at.low, at.high), figure(at.edf, ".4g"),
                     figure(at.model, ".4e")});
  return aligned(cells, ">");
}

std::string span(double from, double to) {
  return from == to ? fmt::format("at tau = {:.4g} s", from)
                    : fmt::format("from tau = {:.4g} to {:.4g} s", from, to);
}

std::string line_text(const AllanLine& line) {
  const AllanReading& r = line.reading;
  if (!r.seen) {
    std::string text = "not visible in this log: " + r.reason;
    if (r.at_most > 0)
      text +=
          fmt::format("\nat most {:.4g} {}{}, 95 %", r.at_most, line.unit,
                      line.other_unit.empty()
                          ? ""
                          : fmt::format(" = {:.4g} {}", r.at_most * line.factor, line.other_unit));
    return text;
  }
  std::string text = fmt::format("{:.4g} {}  ({:.4g} to {:.4g}), {}", r.value, line.unit, r.low,
                                 r.high, span(r.tau_from, r.tau_to));
  if (!line.other_unit.empty())
    text += fmt::format("\n{:.4g} {}  ({:.4g} to {:.4g})", r.value * line.factor, line.other_unit,
                        r.low * line.factor, r.high * line.factor);
  if (!r.reason.empty()) text += "\n" + r.reason;
  return text;
}

std::string fit_text(const AllanAnalysis& analysis) {
  const std::string numbers = fmt::format(
      "chi-squared {:.1f} of {} degrees of freedom from {:.4g} s on, model error {:.0f} % of "
      "each variance",
      analysis.chi_squared, analysis.degrees, analysis.fitted_from, 100 * analysis.model_error);
  if (!analysis.explained)
    return numbers +
           "\nthe curve is not the sum of these noise components: the sensor moved, or a tone or a "
           "filter shapes it";
  const bool all = analysis.fitted_from <= analysis.curve.front().point.tau;
  return numbers + (all ? "" : "\nbelow that a filter shapes the curve");
}

}  // namespace

Json to_json(const SensorAllan& allan) {
  const auto& [record, analysis] = allan;
  Json json = {
      {"log", record.log},          {"column", record.column},       {"phase", record.phase},
      {"unit", record.unit},        {"samples", record.rate.size()}, {"dt", record.dt},
      {"warnings", record.warnings}};
  for (const char* key : {"tau", "adev", "low", "high", "edf", "model"}) json[key] = Json::array();
  for (const AllanCurvePoint& at : analysis.curve) {
    json["tau"].push_back(at.point.tau);
    json["adev"].push_back(at.point.deviation);
    json["low"].push_back(at.low);
    json["high"].push_back(at.high);
    json["edf"].push_back(at.edf);
    json["model"].push_back(at.model);
  }
  for (const AllanLine& line : allan_lines(analysis, record.unit))
    json[line.key] = reading_json(line.reading, line.unit);
  json["fit"] = {{"explained", analysis.explained},
                 {"model_error", analysis.model_error},
                 {"from_tau", analysis.fitted_from},
                 {"chi_squared", analysis.chi_squared},
                 {"degrees", analysis.degrees}};
  return json;
}

std::string to_text(const SensorAllan& allan) {
  const auto& [record, analysis] = allan;
  const auto samples = static_cast<double>(record.rate.size());
  const std::string unit = record.unit.empty() ? "" : " [" + record.unit + "]";
  std::string text =
      section("log", fmt::format("{}: {}{}, {} samples at {:.6g} Hz, {:.6g} s", record.log,
                                 (record.phase ? "the rate of " : "") + record.column, unit,
                                 record.rate.size(), 1 / record.dt, samples * record.dt)) +
      section("curve", "overlapping Allan deviation" + unit + "\n" + curve_table(analysis));
  for (const AllanLine& line : allan_lines(analysis, record.unit))
    text += line.title + "\n" + section("", line_text(line));
  return text + section("fit", fit_text(analysis));
}

}  // namespace quadtune::report
