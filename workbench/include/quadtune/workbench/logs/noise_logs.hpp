// SPDX-License-Identifier: Apache-2.0
/// Logs as the samples of a filter model whose noise is to be tuned.
#pragma once

#include <string>
#include <utility>
#include <vector>

#include "quadtune/estimation/filter_model.hpp"
#include "quadtune/estimation/filter_record.hpp"
#include "quadtune/logs/log_reader.hpp"
#include "quadtune/workbench/logs/log_notes.hpp"

namespace quadtune {

struct TunedFile {
  std::string path;
  std::string sha256;
};

/// What fed a signal of the model, or was taken for the truth of a state.
struct TunedChannel {
  std::string signal;   ///< e.g. "height", "truth of vz"
  std::string channel;  ///< in full, with its unit: "sensor_baro.height [m]"
  std::string file;
};

/// The log of a flight, in one file or several, and what was taken of it.
struct TunedLog {
  std::vector<TunedFile> files;
  std::vector<TunedChannel> channels;
  std::vector<FilterRecord> records;
  std::vector<std::string> warnings = {};  ///< of the files' readers

  [[nodiscard]] Eigen::Index samples() const;  ///< of all records
  [[nodiscard]] double seconds() const;        ///< of all records, without what lies between
};

/// A signal or a state of the model, and the channel that feeds it: "px", or "px@FILE" of another
/// log of the same flight.
using NamedChannel = std::pair<std::string, std::string>;

struct NoiseLogOptions {
  std::vector<std::string> logs;  ///< one of each flight; files, as they are read twice
  /// Inputs and outputs of the model. Of the others an input is fed by the channel of its name; so
  /// are the outputs, where none is named here.
  std::vector<NamedChannel> channels = {};
  std::vector<NamedChannel> truths = {};  ///< what states truly were, as records_of_log() takes it
  LogOptions reading = {};
  LogNote note = {};  ///< takes warnings, and what is left as it is
};

/// A model and its samples.
struct NoiseLogs {
  FilterModel model;  ///< parameters of sensors that no log measures are fixed
  std::vector<TunedLog> logs;
  std::vector<LeftOutRecord> left_out;  ///< of the logs
};

/// @param model  as chosen_filter() gives it
/// @throws InvalidInput  as read_signals_by_name(), read_channels() and records_of_log()
/// @throws FileError     for a file that cannot be read
[[nodiscard]] NoiseLogs read_noise_logs(FilterModel model, const NoiseLogOptions& options);

}  // namespace quadtune
