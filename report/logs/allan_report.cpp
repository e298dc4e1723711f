// SPDX-License-Identifier: Apache-2.0
#include "report/logs/allan_report.hpp"

#include <fmt/format.h>

#include "quadtune/internal/json.hpp"
#include "report/logs/allan_units.hpp"
#include "report/text/print.hpp"
#include "report/text/rows.hpp"

namespace quadtune::report {
namespace {

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
  Cells cells = {{"tau [s]", "deviation", "95 % interval", "degrees", "fit"}};
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
    std::string text = "not seen in this record: " + r.reason;
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
      "chi-squared {:.1f} of {} degrees of freedom from {:.4g} s on, {:.0f} % of a variance "
      "allowed",
      analysis.chi_squared, analysis.degrees, analysis.fitted_from, 100 * analysis.model_error);
  if (!analysis.explained)
    return numbers +
           "\nthe curve is not the sum of these noises: the sensor moved, or a tone or a filter "
           "shapes it";
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
