// SPDX-License-Identifier: Apache-2.0
/// Describes a set of sensors in one line.
#pragma once

#include <string>

#include "quadtune/model/sensors.hpp"

namespace quadtune {

/// For example "gyroscope 200 Hz 0.003 rad/s, sonar 20 Hz 0.01 m, GPS 1 Hz 1 m 0.1 m/s 0.2 s late":
/// for each sensor its rate, the largest noise of an axis, and the delay if there is one.
[[nodiscard]] std::string describe(const Sensors& sensors);

}  // namespace quadtune
