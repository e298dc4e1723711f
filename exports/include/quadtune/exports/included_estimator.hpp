// SPDX-License-Identifier: Apache-2.0
/// Selects the estimator that a flight code program includes.
#pragma once

#include <optional>
#include <string>

#include "quadtune/exports/stored_estimator.hpp"

namespace quadtune {

/// @param estimator  with which the law was evaluated
/// @param adapter    FlightCodeOptions::adapter
/// @return           "general", "mambo" or "uquad"; empty if the program expects the estimate from
///                   its caller, because there is no estimator or the firmware of the adapter has
///                   its own
[[nodiscard]] std::string included_estimator(const std::optional<StoredEstimator>& estimator,
                                             const std::string& adapter);

}  // namespace quadtune
