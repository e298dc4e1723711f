// SPDX-License-Identifier: Apache-2.0
/// Maps the flight logs of `quadtune fly` to signals of filter models, which have other names: the
/// vehicle's sensors, or quantities that a flight program computes from them.
#pragma once

#include <functional>
#include <string>
#include <vector>

#include "quadtune/estimation/filter_model.hpp"
#include "quadtune/logs/log_reader.hpp"
#include "quadtune/lti.hpp"

namespace quadtune::internal {

/// A signal computed from columns of such a log.
struct OwnSignal {
  std::string from;  ///< description, e.g. "gyroscope.x", "-gps.py"
  /// Full names; the signal has a value when all of them have one
  std::vector<std::string> channels;
  std::string unit;
  std::function<double(const std::vector<double>&)> value;  ///< of the channels, in their order
};

/// Whether the log is a flight log of quadtune.
[[nodiscard]] bool is_own_log(const std::vector<LogGroup>& groups);

/// Whether z points up in the model's world; in that of a flight log it points down.
[[nodiscard]] bool has_z_up(const FilterModel& model);

/// Possible sources of a signal with this name and unit, the best first; empty if a flight log does
/// not contain any, in particular for a signal that can be any quantity.
/// @param z_up  whether z points up in the model's world: its y and z then have the opposite sign
[[nodiscard]] std::vector<OwnSignal> own_signals(const Signal& signal, bool z_up);

/// The first of them whose channels the log has; nullptr if there is none.
[[nodiscard]] const OwnSignal* first_that_is_there(const std::vector<OwnSignal>& signals,
                                                   const std::vector<LogGroup>& groups);

/// Whether a signal without a unit and with a name of one letter is ambiguous: a channel of that
/// name may belong to a magnetometer, for example. Such a signal is fed by its name only if the log
/// has one unnamed table whose channel has no unit and is not one of three axes.
[[nodiscard]] bool may_be_anything(const Signal& signal, const LogChannel& channel,
                                   const LogGroup& group);

}  // namespace quadtune::internal
