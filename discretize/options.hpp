// SPDX-License-Identifier: Apache-2.0
/// What both directions refuse about their options.
#pragma once

#include <optional>

#include "quadtune/discretize/discretize.hpp"

namespace quadtune::internal {

/// @throws InvalidInput  "zoh: prewarp is 10 rad/s, expected none because …"
void refuse_prewarp(DiscretizationMethod method, const std::optional<double>& prewarp);

}  // namespace quadtune::internal
