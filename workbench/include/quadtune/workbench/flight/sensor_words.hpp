// SPDX-License-Identifier: Apache-2.0
/// A suite of sensors in one line.
#pragma once

#include <string>

#include "quadtune/model/sensors.hpp"

namespace quadtune {

/// "gyroscope 200 Hz 0.003 rad/s, sonar 20 Hz 0.01 m, GPS 1 Hz 1 m 0.1 m/s 0.2 s late": rate, the
/// largest noise of an axis, and the delay if there is one, of each sensor.
[[nodiscard]] std::string in_words(const Sensors& sensors);

}  // namespace quadtune
