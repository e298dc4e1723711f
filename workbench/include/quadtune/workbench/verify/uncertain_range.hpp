// SPDX-License-Identifier: Apache-2.0
/// Parses ranges of uncertain vehicle parameters: "LOW:HIGH", or one number.
#pragma once

#include <string>

#include "quadtune/tuning/uncertain_vehicle.hpp"

namespace quadtune {

/// Ratios to the value in the vehicle file: 0 < LOW ≤ 1 ≤ HIGH.
/// @param text  LOW:HIGH, or one number
/// @param key   of the option, e.g. "mass"
/// @throws OptionError  naming the key
[[nodiscard]] UncertainRange uncertain_ratios(const std::string& text, const std::string& key);

/// A delay [s]: 0 ≤ LOW ≤ HIGH.
/// @throws OptionError  naming the key
[[nodiscard]] UncertainRange uncertain_delay(const std::string& text, const std::string& key);

/// A motor lag [s]: 0 < LOW ≤ HIGH, or 0 for none.
/// @throws OptionError  naming the key
[[nodiscard]] UncertainRange uncertain_lag(const std::string& text, const std::string& key);

}  // namespace quadtune
