// SPDX-License-Identifier: Apache-2.0
/// Converts logs to the samples of a filter model whose noise is tuned.
#pragma once

#include <string>
#include <utility>
#include <vector>

#include "quadtune/estimation/filter_model.hpp"
#include "quadtune/estimation/filter_record.hpp"
#include "quadtune/logs/log_reader.hpp"
#include "quadtune/workbench/logs/log_notes.hpp"

namespace quadtune {

/// A file that the tuning read.
struct TunedFile {
  std::string path;    ///< as the user named it
  std::string sha256;  ///< of its bytes, 64 hexadecimal digits
};

/// The channel that was used as a signal of the model, or as the true value of a state.
struct TunedChannel {
  std::string signal;   ///< e.g. "height", "truth of vz"
  std::string channel;  ///< full name with unit: "sensor_baro.height [m]"
  std::string file;     ///< path of its log
};

/// The log of a flight, in one or more files, and the data that were used from it.
struct TunedLog {
  std::vector<TunedFile> files;            ///< at least one
  std::vector<TunedChannel> channels;      ///< that provide the signals
  std::vector<FilterRecord> records;       ///< samples of the signals
  std::vector<std::string> warnings = {};  ///< from the readers of the files

  [[nodiscard]] Eigen::Index samples() const;  ///< of all records
  [[nodiscard]] double seconds() const;        ///< of all records, without the gaps between them
};

/// A signal or a state of the model, and the channel that provides it: "px", or "px@FILE" in
/// another log of the same flight.
using NamedChannel = std::pair<std::string, std::string>;

/// Logs, and how their channels map to the model.
struct NoiseLogOptions {
  std::vector<std::string> logs;  ///< one per flight; files, because they are read twice
  /// Inputs and outputs of the model. Inputs that are not named here use the channel of their own
  /// name; so do the outputs if none is named here.
  std::vector<NamedChannel> channels = {};
  std::vector<NamedChannel> truths = {};  ///< true values of states, as in records_of_log()
  LogOptions reading = {};                ///< how the logs are read
  LogNote note = {};  ///< receives warnings, and notes about unchanged parameters
};

/// A model and its samples.
struct NoiseLogs {
  FilterModel model;                    ///< parameters of sensors that no log contains are fixed
  std::vector<TunedLog> logs;           ///< one for each flight
  std::vector<LeftOutRecord> left_out;  ///< records of the logs that are not used
};

/// @param model    from chosen_filter()
/// @param options  logs, channels and how they are read
/// @throws InvalidInput  as read_signals_by_name(), read_channels() and records_of_log()
/// @throws FileError     if a file cannot be read
[[nodiscard]] NoiseLogs read_noise_logs(FilterModel model, const NoiseLogOptions& options);

}  // namespace quadtune
