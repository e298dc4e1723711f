// SPDX-License-Identifier: Apache-2.0
/// Sensors' columns of a log, by name or number: what allan and calibrate read.
#pragma once

#include <Eigen/Core>
#include <string>
#include <vector>

#include "arguments/log_arguments.hpp"
#include "program/program.hpp"
#include "quadtune/logs/log_channels.hpp"

namespace quadtune::cli {

class CommandLine;

struct SensorLogArguments {
  LogArguments log;
  std::string time;       ///< the column of a text that is its clock; empty: as the log says
  std::string time_unit;  ///< s, ms, us or ns; empty: of the log, or by its values

  [[nodiscard]] bool given() const;
};

/// Adds --format, --columns, --rate, --time and --time-unit.
void add_sensor_log_options(CommandLine& line, SensorLogArguments& arguments);

/// What messages call the file of that path.
[[nodiscard]] std::string log_name(const std::string& path);

/// Sensors of a log, and what its reader warns of.
struct SensorLog {
  std::vector<LogSeries> series;
  std::vector<std::string> warnings;  ///< as tell_log_warnings()
};

/// Series with times that increase: `names`, then those of `optional` that the log has, the others
/// being empty. A name CHANNEL@FILE is of another file, its times after the same epoch, and stays
/// the series' name. Warnings go to Context::note as well.
/// @param verb  for messages
/// @throws UsageError    for a log without times, or options that contradict each other
/// @throws InvalidInput, FileError  as read_channels() and require_usable()
[[nodiscard]] SensorLog read_sensors(const std::string& path, const std::vector<std::string>& names,
                                     const std::vector<std::string>& optional,
                                     const SensorLogArguments& arguments, const std::string& verb,
                                     Context& context);

/// Samples of several series that were taken at the same times.
struct JoinedSeries {
  Eigen::VectorXd t;       ///< (n) [s]
  Eigen::MatrixXd values;  ///< (number of series × n)
};

/// The instants at which all series have a sample.
/// @throws InvalidInput  where fewer than half of the first one's samples are among them
[[nodiscard]] JoinedSeries join(const std::vector<const LogSeries*>& series,
                                const std::string& where);

/// The sample period of evenly spaced times [s].
/// @throws InvalidInput  for a gap: a step half as long again as the median or more
[[nodiscard]] double even_period(const LogSeries& series, const std::string& where);

}  // namespace quadtune::cli
