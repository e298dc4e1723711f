// SPDX-License-Identifier: Apache-2.0
/// Reads channels of a sensor from one log or several.
#pragma once

#include <Eigen/Core>
#include <string>
#include <vector>

#include "quadtune/logs/log_channels.hpp"
#include "quadtune/workbench/logs/log_notes.hpp"

namespace quadtune {

/// The name of a file in messages: "standard input" for "-", otherwise the path.
[[nodiscard]] std::string log_name(const std::string& path);

/// Requires that no two files have the same content, whose samples would count twice.
/// @param paths  files that exist
/// @throws OptionError  naming the two
/// @throws FileError
void require_different_logs(const std::vector<std::string>& paths);

/// Channels of a sensor, and the warnings of the logs' readers.
struct SensorLog {
  std::vector<LogSeries> series;      ///< in the order of the names
  std::vector<std::string> warnings;  ///< as noted_log_warnings()
};

/// Reads series with increasing times: `names`, then those of `optional`; optional series that the
/// log lacks are empty. A name `CHANNEL@FILE` refers to another file, whose times have the same
/// epoch; the series keeps this name.
/// @param path      of the log
/// @param names     channels that the log must have
/// @param optional  names of channels of the log itself
/// @param options   how the log is read
/// @param note      receives the warnings
/// @throws MissingOption  if a log has no times and neither a rate nor a clock is given
/// @throws InvalidInput, FileError  as read_channels() and require_usable()
[[nodiscard]] SensorLog read_sensors(const std::string& path, const std::vector<std::string>& names,
                                     const std::vector<std::string>& optional, LogOptions options,
                                     const LogNote& note);

/// Samples of several series that were taken at the same times.
struct JoinedSeries {
  Eigen::VectorXd t;       ///< (n) [s]
  Eigen::MatrixXd values;  ///< (number of series × n)
};

/// Selects the instants at which all series have a sample.
/// @param series  at least one
/// @param where   for messages
/// @throws InvalidInput  if they are fewer than half of the samples of the first series
[[nodiscard]] JoinedSeries join(const std::vector<const LogSeries*>& series,
                                const std::string& where);

/// The sample period of evenly spaced times [s].
/// @param series  at least two samples with increasing times
/// @param where   for messages
/// @throws InvalidInput  if there is a gap: a step of at least 1.5 times the median
[[nodiscard]] double even_period(const LogSeries& series, const std::string& where);

}  // namespace quadtune
