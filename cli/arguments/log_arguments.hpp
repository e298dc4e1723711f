// SPDX-License-Identifier: Apache-2.0
/// Options that select how a log is read, shared by all commands that read one.
#pragma once

#include <optional>
#include <string>

#include "program/refusal.hpp"
#include "quadtune/logs/log_reader.hpp"
#include "quadtune/workbench/logs/log_notes.hpp"
#include "quadtune/workbench/logs/missing_option.hpp"

namespace quadtune::cli {

class CommandLine;
struct Context;

struct LogArguments {
  std::string format, columns;
  std::optional<double> rate_hz;
};

/// Adds --format, --columns and --rate.
void add_log_options(CommandLine& line, LogArguments& arguments);

/// @throws UsageError, InvalidInput  naming the option.
[[nodiscard]] LogOptions log_options(const LogArguments& arguments);

/// How the log of a sensor is read, including its clock.
struct SensorLogArguments {
  LogArguments log;
  std::string time;       ///< column of a text that holds the times; empty: the reader chooses
  std::string time_unit;  ///< s, ms, us or ns; empty: the unit of the header, or else estimated

  [[nodiscard]] bool given() const;
};

/// Adds --format, --columns, --rate, --time and --time-unit.
void add_sensor_log_options(CommandLine& line, SensorLogArguments& arguments);

/// @throws UsageError, InvalidInput  as log_options(), and for options that contradict each other
[[nodiscard]] LogOptions sensor_log_options(const SensorLogArguments& arguments);

/// Prints notes about logs by Context::note, with the name of the command in front.
[[nodiscard]] LogNote notes_of(const Context& context);

}  // namespace quadtune::cli
