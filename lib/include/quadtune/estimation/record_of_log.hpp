// SPDX-License-Identifier: Apache-2.0
/// Converts the channels of a log to records of a filter model.
#pragma once

#include <string>
#include <vector>

#include "quadtune/estimation/filter_model.hpp"
#include "quadtune/estimation/filter_record.hpp"
#include "quadtune/logs/log_channels.hpp"

namespace quadtune {

/// Assigns a channel of a log to an input or output of a model.
struct ChannelUse {
  std::string signal;  ///< name of an input or output or, for a truth, of a state, e.g. "height"
  LogSeries series;    ///< strictly increasing times
};

/// Converts the channels of a log to records. The instants of a record are all times at which a
/// sample was taken (FilterSensor::delay before it was logged) or an input changed. A record begins
/// when every input has a sample. It is split where an input is missing for more than ten of its
/// typical periods, since the value of the input is unknown there.
///
/// @param model  accepted by validate()
/// @param uses   every input of the model and at least one output; the other outputs count as not
///               measured
/// @param truths  true values of states. A truth is interpolated between its samples, but not over
///                more than ten of its typical periods. Nonlinear models also accept "qw", "qx",
///                "qy", "qz", the attitude quaternion from body to world, and inertial navigation
///                "roll", "pitch", "yaw"; its truth for the rotation states is the rotation vector
///                of the attitude. Degrees are converted for states in radians.
/// @param name   of the record, for messages
/// @param left_out  if not null, receives the measurements at single instants between two gaps:
///                  such an interval contains no time step and gives no record
/// @return       at least one record
/// @throws InvalidInput  "name: …" if a signal is missing, unknown or given twice, a unit is not
///                       that of the model, times do not increase, a period of a discrete model
///                       contains two samples of one output, or inputs and outputs do not overlap
///                       in time
[[nodiscard]] std::vector<FilterRecord> records_of_log(
    const FilterModel& model, const std::vector<ChannelUse>& uses, const std::string& name,
    const std::vector<ChannelUse>& truths = {}, std::vector<LeftOutRecord>* left_out = nullptr);

}  // namespace quadtune
