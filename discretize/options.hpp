// SPDX-License-Identifier: Apache-2.0
/// Checks of options that both directions of conversion share.
#pragma once

#include <optional>

#include "quadtune/discretize/discretize.hpp"

namespace quadtune::internal {

/// @throws InvalidInput  "zoh: prewarp is 10 rad/s, expected none because …"
void refuse_prewarp(DiscretizationMethod method, const std::optional<double>& prewarp);

}  // namespace quadtune::internal
