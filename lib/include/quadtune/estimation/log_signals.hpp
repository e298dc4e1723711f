// SPDX-License-Identifier: Apache-2.0
/// The signals of a filter model from a log in which nobody named their channels.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "quadtune/estimation/filter_model.hpp"
#include "quadtune/estimation/record_of_log.hpp"
#include "quadtune/logs/log_channels.hpp"

namespace quadtune {

/// A signal, and what feeds it.
struct FedSignal {
  ChannelUse use;
  std::string
      from;  ///< its channel in full, "sensor_baro.height", or in words what is made of some
};

struct FedSignals {
  std::vector<FedSignal> signals;
  LogCondition condition;
  std::int64_t epoch_s = 0;
};

/// Reads inputs and outputs of a model by their names. Of a flight log of `quadtune fly`, whose
/// columns have other names, what its sensors say to them; of its outputs those that there are.
///
/// @param signals  of the model
/// @throws InvalidInput  for a signal that the log does not have, or has in several tables; for one
///                       without a unit that is called by a single letter, and so may stand for
///                       anything, where the channel of its name is one of a table's, has a unit or
///                       is an axis of three; and as open_log().
/// @throws FileError     as open_log().
[[nodiscard]] FedSignals read_signals_by_name(const std::string& path, const FilterModel& model,
                                              const std::vector<Signal>& signals,
                                              const LogOptions& options = {});

/// Refuses a true value that counts in another world than the model's: a flight log of
/// `quadtune fly` has z down. Measurements that read_signals_by_name() takes from one are turned.
///
/// @param state   that the value is one of: a state, or roll, pitch, yaw, qw, qx, qy, qz
/// @param groups  of the log that it came from
/// @throws InvalidInput  where the model's world has z up and the value depends on that.
void require_same_world(const std::string& path, const FilterModel& model, const std::string& state,
                        const std::vector<LogGroup>& groups);

}  // namespace quadtune
