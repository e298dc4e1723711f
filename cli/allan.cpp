// SPDX-License-Identifier: Apache-2.0
/// quadtune allan: the noises of a still sensor.
#include "quadtune/tuning/allan.hpp"

#include <fmt/format.h>

#include <cmath>
#include <memory>
#include <numbers>
#include <optional>
#include <ostream>
#include <utility>

#include "arguments/plot_argument.hpp"
#include "arguments/sensor_log.hpp"
#include "program/command_line.hpp"
#include "program/program.hpp"
#include "quadtune/internal/json.hpp"
#include "quadtune/internal/suggest.hpp"
#include "quadtune/internal/text_file.hpp"
#include "quadtune/tuning/made_up_imu.hpp"
#include "report/logs/allan_units.hpp"
#include "report/plots/allan_figure.hpp"
#include "report/text/print.hpp"

namespace quadtune::cli {
namespace {

using internal::Json;

struct Options {
  std::string log, column, unit;
  std::string taus = "octaves";
  SensorLogArguments sensors;
  bool simulate = false, phase = false;
  PlotArgument plot;
};

[[noreturn]] void refuse(const char* option, const std::string& why) {
  throw UsageError(fmt::format("quadtune allan: {}", why), option);
}

AllanTaus taus_of(const std::string& name) {
  if (name == "octaves") return AllanTaus::octaves;
  if (name == "decades") return AllanTaus::decades;
  if (name == "all") return AllanTaus::all;
  refuse("--taus", fmt::format("--taus is '{}', expected octaves, decades or all{}", name,
                               internal::did_you_mean(name, {"octaves", "decades", "all"})));
}

AllanRecord made_up(const Options& options, const Context& context) {
  if (!options.log.empty() || !options.column.empty() || options.sensors.given() || options.phase)
    refuse("--simulate",
           "--simulate came with a log or its options, expected it alone, because it "
           "makes the record up");
  MadeUpGyroscope made = make_up_gyroscope(context.seed);
  return {fmt::format("made up with seed {}", context.seed), "wz",
          options.unit.empty() ? "rad/s" : options.unit, std::move(made.rate),
          1 / made.sample_rate};
}

/// Of the rate whose integral is in `unit`.
std::string unit_of_rate(const std::string& unit) {
  if (unit.empty()) return "";
  if (unit == "s") return "1";
  return unit.ends_with("/s") ? unit + "^2" : unit + "/s";
}

/// A whole turn in the unit of an angle; 0 of anything else.
double turn_in(const std::string& unit) {
  if (unit == "rad") return 2 * std::numbers::pi;
  return unit == "deg" ? 360 : 0;
}

/// Takes out the jumps of an angle that is kept within a turn: a still sensor's never changes by
/// half a turn from one sample to the next.
/// @return  how many there were
Eigen::Index unwrap(Eigen::VectorXd& angle, double turn) {
  Eigen::Index jumps = 0;
  double added = 0;
  for (Eigen::Index k = 1; k < angle.size(); ++k) {
    const double change = angle(k) + added - angle(k - 1);
    if (std::abs(change) > turn / 2) {
      added -= turn * std::round(change / turn);
      ++jumps;
    }
    angle(k) += added;
  }
  return jumps;
}

AllanRecord read(const Options& options, Context& context) {
  if (options.simulate) return made_up(options, context);
  if (options.log.empty()) refuse("--log", "--log is missing, expected the log of a still sensor");
  if (options.column.empty())
    refuse("--column", "--column is missing, expected the name or number of a column");
  SensorLog log =
      read_sensors(options.log, {options.column}, {}, options.sensors, "allan", context);
  const LogSeries& series = log.series.front();
  const std::string name = log_name(channel_place(options.column, options.log).file);
  const Eigen::Map<const Eigen::VectorXd> values(series.values.data(), std::ssize(series.values));
  const std::string unit = options.unit.empty() ? series.unit : options.unit;
  const double dt = even_period(series, name);
  AllanRecord record{name, series.name, unit, values, dt, std::move(log.warnings)};
  if (options.phase) {
    record.phase = true;
    record.unit = unit_of_rate(unit);
    Eigen::VectorXd phase = values;
    if (const double turn = turn_in(unit); turn > 0)
      if (const Eigen::Index jumps = unwrap(phase, turn); jumps > 0) {
        record.warnings.push_back(fmt::format(
            "{}: '{}' jumps by more than half a turn {} times: the angle is kept within a turn, "
            "and whole turns are added where it jumps",
            name, internal::printable(series.name), jumps));
        context.note("allan: " + record.warnings.back());
      }
    record.rate = rate_of_phase(phase, dt);
  }
  return record;
}

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

Json to_json(const AllanRecord& record, const AllanAnalysis& analysis) {
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

std::string curve_table(const AllanAnalysis& analysis) {
  std::string text = fmt::format("{:>11}{:>13}{:>26}{:>12}{:>13}", "tau [s]", "deviation",
                                 "95 % interval", "degrees", "fit");
  for (const AllanCurvePoint& at : analysis.curve)
    text += fmt::format("\n{:>11.5g}{:>13.4e}{:>26}{:>12.4g}{:>13.4e}", at.point.tau,
                        at.point.deviation, fmt::format("{:.4e} to {:.4e}", at.low, at.high),
                        at.edf, at.model);
  return text;
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

void print(const AllanRecord& record, const AllanAnalysis& analysis, Context& context) {
  if (context.json) {
    context.out << internal::readable(to_json(record, analysis)) << "\n";
    return;
  }
  const auto samples = static_cast<double>(record.rate.size());
  context.out << section("log",
                         fmt::format("{}: {}{}, {} samples at {:.6g} Hz, {:.6g} s", record.log,
                                     (record.phase ? "the rate of " : "") + record.column,
                                     record.unit.empty() ? "" : " [" + record.unit + "]",
                                     record.rate.size(), 1 / record.dt, samples * record.dt))
              << section("curve", "overlapping Allan deviation" +
                                      (record.unit.empty() ? "" : " [" + record.unit + "]") + "\n" +
                                      curve_table(analysis));
  for (const AllanLine& line : allan_lines(analysis, record.unit))
    context.out << line.title << "\n" << section("", line_text(line));
  context.out << section("fit", fit_text(analysis));
}

}  // namespace

Verb allan_verb() {
  return {"allan", "--log FILE --column NAME|N (--rate HZ | --time COLUMN) [--unit U] [--phase]",
          "read a still sensor's noises off its Allan deviation",
          "quadtune allan --simulate --taus decades", [](CommandLine& line) -> Action {
            auto options = std::make_shared<Options>();
            line.add_option("--log", options->log,
                            "log of a still sensor, of any format that quadtune log reads")
                ->type_name("FILE");
            line.add_option("--column", options->column,
                            "its channel, by name, or by number from 1 of a text")
                ->type_name("NAME|N");
            add_sensor_log_options(line, options->sensors);
            line.add_option("--unit", options->unit,
                            "of the column, e.g. rad/s, deg/s, m/s^2; the header's")
                ->type_name("U");
            line.add_flag("--phase", options->phase,
                          "the column is a phase, the rate's integral: an angle, a clock's error");
            line.add_option("--taus", options->taus, "octaves (default), decades or all")
                ->type_name("WHICH");
            line.add_flag("--simulate", options->simulate,
                          "a made-up gyroscope of 1e-4 rad/s/sqrt(Hz) and 2e-5 rad/s^2/sqrt(Hz) "
                          "instead of a log");
            add_plot_option(line, options->plot);
            return [options](Context& context) {
              require_picture(options->plot, "allan");
              const AllanTaus taus = taus_of(options->taus);
              const AllanRecord record = read(*options, context);
              const auto samples = static_cast<std::size_t>(record.rate.size());
              const AllanAnalysis analysis =
                  analyse_allan(record.rate, record.dt, allan_factors(samples, taus));
              draw(
                  options->plot, [&] { return allan_figure(record, analysis); }, context);
              print(record, analysis, context);
            };
          }};
}

}  // namespace quadtune::cli
