// SPDX-License-Identifier: Apache-2.0
/// Channels of a sensor, from one log or several.
#pragma once

#include <Eigen/Core>
#include <string>
#include <vector>

#include "quadtune/logs/log_channels.hpp"
#include "quadtune/workbench/logs/log_notes.hpp"

namespace quadtune {

/// What messages call the file of that path: "standard input" for "-".
[[nodiscard]] std::string log_name(const std::string& path);

/// Channels of a sensor, and what the logs' readers warn of.
struct SensorLog {
  std::vector<LogSeries> series;
  std::vector<std::string> warnings;  ///< as noted_log_warnings()
};

/// Series with times that increase: `names`, then those of `optional` that the log has, the others
/// being empty. A name CHANNEL@FILE is of another file, its times after the same epoch, and stays
/// the series' name.
/// @param optional  names of channels of the log itself
/// @param note      takes the warnings
/// @throws MissingOption  for a log without times where neither a rate nor a clock came
/// @throws InvalidInput, FileError  as read_channels() and require_usable()
[[nodiscard]] SensorLog read_sensors(const std::string& path, const std::vector<std::string>& names,
                                     const std::vector<std::string>& optional, LogOptions options,
                                     const LogNote& note);

/// Samples of several series that were taken at the same times.
struct JoinedSeries {
  Eigen::VectorXd t;       ///< (n) [s]
  Eigen::MatrixXd values;  ///< (number of series × n)
};

/// The instants at which all series have a sample.
/// @param series  at least one
/// @param where   for messages
/// @throws InvalidInput  where fewer than half of the first one's samples are among them
[[nodiscard]] JoinedSeries join(const std::vector<const LogSeries*>& series,
                                const std::string& where);

/// The sample period of evenly spaced times [s].
/// @param series  of two samples or more, its times increasing
/// @param where   for messages
/// @throws InvalidInput  for a gap: a step half as long again as the median or more
[[nodiscard]] double even_period(const LogSeries& series, const std::string& where);

}  // namespace quadtune
