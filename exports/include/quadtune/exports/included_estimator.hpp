// SPDX-License-Identifier: Apache-2.0
/// Which estimator a program of flight code includes.
#pragma once

#include <optional>
#include <string>

#include "quadtune/exports/stored_estimator.hpp"

namespace quadtune {

/// @param estimator  that the law was judged with
/// @param adapter    FlightCodeOptions::adapter
/// @return           "general", "mambo" or "uquad"; empty if the program takes the estimate from
///                   its caller: where there is none, and for adapters whose firmware has its own
[[nodiscard]] std::string included_estimator(const std::optional<StoredEstimator>& estimator,
                                             const std::string& adapter);

}  // namespace quadtune
