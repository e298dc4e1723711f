// SPDX-License-Identifier: Apache-2.0
#include "arguments/log_arguments.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <vector>

#include "program/command_line.hpp"
#include "program/program.hpp"
#include "program/refusal.hpp"
#include "quadtune/internal/joined.hpp"
#include "quadtune/internal/suggest.hpp"
#include "quadtune/internal/text_file.hpp"

namespace quadtune::cli {
namespace {

void require_format(const std::string& format) {
  std::vector<std::string> known;
  for (const LogFormat& one : log_formats()) known.push_back(one.name);
  if (std::find(known.begin(), known.end(), format) == known.end())
    refuse("--format", "--format is '{}', expected one of {}{}", format,
           internal::joined(known, ", "), internal::did_you_mean(format, known));
}

/// Rejects an option that applies to text only.
void refuse_with_format(const std::string& format, const char* option) {
  if (!format.empty() && format != "text")
    refuse(option,
           "{} cannot be combined with --format {}, which defines its own columns and times",
           option, format);
}

std::optional<double> ticks_of(const std::string& unit) {
  if (unit == "s") return 1;
  if (unit == "ms") return 1e3;
  if (unit == "us") return 1e6;
  if (unit == "ns") return 1e9;
  return std::nullopt;
}

}  // namespace

void add_log_options(CommandLine& line, LogArguments& arguments) {
  line.add_option(
      "--format NAME", arguments.format,
      "text, replay, ulog, mat, uquad-frames or uquad-log; default: detected from the content");
  line.add_option("--columns LIST", arguments.columns,
                  "columns of a text, such as 't_s:1, t_us:2, height[m]:19'; * selects all others");
  line.add_positive("--rate HZ", arguments.rate_hz, "rows per second of a text without times");
}

LogOptions log_options(const LogArguments& arguments) {
  LogOptions options;
  if (!arguments.format.empty()) require_format(arguments.format);
  options.format = arguments.format;
  if (!arguments.columns.empty())
    options.columns = parse_log_columns(arguments.columns, "--columns");
  options.rate_hz = arguments.rate_hz.value_or(0);
  if (arguments.rate_hz) refuse_with_format(options.format, "--rate");
  if (!arguments.columns.empty()) refuse_with_format(options.format, "--columns");
  return options;
}

bool SensorLogArguments::given() const {
  return log.rate_hz.has_value() ||
         !(log.format.empty() && log.columns.empty() && time.empty() && time_unit.empty());
}

void add_sensor_log_options(CommandLine& line, SensorLogArguments& arguments) {
  add_log_options(line, arguments.log);
  line.add_option(
      "--time COLUMN", arguments.time,
      "column of the times in a text, by name or number; default: the one that is named "
      "like a clock, such as t, time, timestamp, stamp or TimeUS");
  line.add_option(
      "--time-unit U", arguments.time_unit,
      "s, ms, us or ns; default: that of the header, or else estimated from the values");
}

LogOptions sensor_log_options(const SensorLogArguments& arguments) {
  LogOptions options = log_options(arguments.log);
  const std::string& unit = arguments.time_unit;
  const std::optional<double> ticks = ticks_of(unit.empty() ? "s" : unit);
  if (!ticks)
    refuse("--time-unit", "--time-unit is '{}', expected s, ms, us or ns",
           internal::printable(unit));
  if (arguments.time.empty()) {
    if (!unit.empty()) refuse("--time-unit", "--time-unit requires --time");
    return options;
  }
  if (options.rate_hz > 0)
    refuse("--rate", "--rate and --time cannot be combined; expected --rate HZ or --time COLUMN");
  if (!options.columns.empty())
    refuse(
        "--columns",
        "--columns and --time cannot be combined; --columns 't_us:2, *' selects the times as well");
  refuse_with_format(options.format, "--time");
  options.columns = {{"t", unit, arguments.time, *ticks}, {}};
  return options;
}

LogNote notes_of(const Context& context) {
  return [&context](const std::string& line) { context.note(line); };
}

}  // namespace quadtune::cli
