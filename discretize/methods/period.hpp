// SPDX-License-Identifier: Apache-2.0
/// Checks of the sample period that all discretization methods share.
#pragma once

#include <string>

namespace quadtune::internal {

/// @throws InvalidInput  "zoh: dt is -0.01 s, expected a positive, finite number of seconds".
void require_period(double dt, const std::string& where);

/// @throws InvalidInput  always: an entry of the discrete model exceeds the range of a double.
[[noreturn]] void refuse_long_period(double dt, const std::string& where);

}  // namespace quadtune::internal
