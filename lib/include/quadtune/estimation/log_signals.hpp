// SPDX-License-Identifier: Apache-2.0
/// Reads the signals of a filter model from a log without a channel mapping by the user.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "quadtune/estimation/filter_model.hpp"
#include "quadtune/estimation/record_of_log.hpp"
#include "quadtune/logs/log_channels.hpp"

namespace quadtune {

/// A signal of a model and the channel that feeds it.
struct FedSignal {
  ChannelUse use;  ///< the signal and the series that feeds it
  /// Full name of the channel, "sensor_baro.height", or a description if it is computed from
  /// several
  std::string from;
};

/// All signals that a log feeds.
struct FedSignals {
  std::vector<FedSignal> signals;  ///< one for each signal that the log feeds
  LogCondition condition;          ///< damage of the log
  std::int64_t epoch_s = 0;        ///< time 0 of the series in the clock of the file [s]
};

/// Reads inputs and outputs of a model from the channels of the same names. From a flight log of
/// `quadtune fly`, whose columns have other names, it reads the corresponding sensor columns;
/// outputs that the log does not contain are omitted.
///
/// @param path     of the log
/// @param model    names the inputs and outputs
/// @param signals  the inputs and outputs of the model that are read
/// @param options  how the log is read
/// @throws InvalidInput  if the log does not contain a signal, or contains it in several tables;
///                       for a signal without a unit whose name is a single letter, and therefore
///                       ambiguous, if the channel of that name is one of a table's channels, has a
///                       unit or is one axis of three; and as open_log()
/// @throws FileError     as open_log()
[[nodiscard]] FedSignals read_signals_by_name(const std::string& path, const FilterModel& model,
                                              const std::vector<Signal>& signals,
                                              const LogOptions& options = {});

/// Rejects a true value whose world axes differ from those of the model: in a flight log of
/// `quadtune fly` z points down. Measurements that read_signals_by_name() reads from such a log are
/// converted.
///
/// @param path    of the log, for messages
/// @param model   whose world axes are expected
/// @param state   the state that the value belongs to, or roll, pitch, yaw, qw, qx, qy, qz
/// @param groups  of the log that contains the value
/// @throws InvalidInput  if z points up in the model's world and the value depends on that
void require_same_world(const std::string& path, const FilterModel& model, const std::string& state,
                        const std::vector<LogGroup>& groups);

}  // namespace quadtune
