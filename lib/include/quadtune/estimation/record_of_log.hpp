// SPDX-License-Identifier: Apache-2.0
/// From the channels of a log to what a filter model takes.
#pragma once

#include <string>
#include <vector>

#include "quadtune/estimation/filter_model.hpp"
#include "quadtune/estimation/filter_record.hpp"
#include "quadtune/logs/log_channels.hpp"

namespace quadtune {

/// Which of a log's channels is which input or output of a model.
struct ChannelUse {
  std::string signal;  ///< an input's, output's or, of a truth, a state's name, e.g. "height"
  LogSeries series;    ///< times increasing
};

/// The model's instants are all those at which something was measured, at the time that the sample
/// is of (Sensor::delay before it was logged), or an input changed. Before the first sample of
/// every input there is nothing; where an input stays away for more than ten of its typical periods
/// the record is parted, for what it was there is not known.
///
/// @param uses  every input of the model, and one output at least; an output that is not among them
///              was not measured
/// @param truths  what states truly were: between its samples a truth is interpolated, but not over
///                more than ten of its typical periods. Besides states, of a nonlinear model "qw",
///                "qx", "qy", "qz": the attitude's quaternion, body to world; of inertial
///                navigation also "roll", "pitch", "yaw", and its truth in place of the turn is the
///                rotation vector of the attitude. Degrees are taken for states in radians.
/// @param name  of the record, for messages
/// @param left_out  where not null, what was measured at single instants between two gaps is added:
///                  there is no step of time in such a stretch, and it is no record
/// @return      at least one record
/// @throws InvalidInput  "name: …" for a signal that is missing, unknown or given twice, a unit
/// that
///                       is not the model's, times that do not increase, two samples of one output
///                       in one period of a discrete model, nothing in common.
[[nodiscard]] std::vector<FilterRecord> records_of_log(
    const FilterModel& model, const std::vector<ChannelUse>& uses, const std::string& name,
    const std::vector<ChannelUse>& truths = {}, std::vector<LeftOutRecord>* left_out = nullptr);

}  // namespace quadtune
