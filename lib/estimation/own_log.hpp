// SPDX-License-Identifier: Apache-2.0
/// What the flight logs of `quadtune fly` say to the signals of filter models, which have other
/// names: the vehicle's sensors as they are, or what a flight program makes of them.
#pragma once

#include <functional>
#include <string>
#include <vector>

#include "quadtune/estimation/filter_model.hpp"
#include "quadtune/logs/log_reader.hpp"
#include "quadtune/lti.hpp"

namespace quadtune::internal {

/// A signal made of columns of such a log.
struct OwnSignal {
  std::string from;                   ///< in words, e.g. "gyroscope.x", "-gps.py"
  std::vector<std::string> channels;  ///< full names; a value is made where all have one
  std::string unit;
  std::function<double(const std::vector<double>&)> value;  ///< of the channels, in their order
};

/// Whether a table is that of such a flight log.
[[nodiscard]] bool is_own_log(const std::vector<LogGroup>& groups);

/// Whether heights count upwards in the model's world; in that of such a log they count downwards.
[[nodiscard]] bool has_z_up(const FilterModel& model);

/// What may feed a signal of this name and unit, the best first; none where nothing in a flight log
/// does, as of one that stands for anything.
/// @param z_up  whether the model's world has z up: its y and z are then the log's, turned about x
[[nodiscard]] std::vector<OwnSignal> own_signals(const Signal& signal, bool z_up);

/// The first of them whose channels the log has; nullptr without.
[[nodiscard]] const OwnSignal* first_that_is_there(const std::vector<OwnSignal>& signals,
                                                   const std::vector<LogGroup>& groups);

/// A signal without a unit, called by one letter, stands for anything: a channel of that name may
/// be of a magnetometer. It is fed by its name only where the log has it in one table without a
/// name and without a unit, and not as an axis beside the two others.
[[nodiscard]] bool may_be_anything(const Signal& signal, const LogChannel& channel,
                                   const LogGroup& group);

}  // namespace quadtune::internal
