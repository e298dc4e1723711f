// SPDX-License-Identifier: Apache-2.0
/// Flights that differ in their seed alone, as text and as JSON.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "quadtune/internal/json_fwd.hpp"
#include "quadtune/workbench/flight/diagnosis.hpp"
#include "quadtune/workbench/flight/fly.hpp"

namespace quadtune::report {

/// An array of flights.
/// @param diagnosis  of the first that failed
[[nodiscard]] internal::Json to_json(const std::vector<FlownFlight>& flights,
                                     const std::optional<Diagnosis>& diagnosis);
/// One verdict, a table at most 80 columns wide, and the first flight that failed, or the first.
[[nodiscard]] std::string to_text(const std::vector<FlownFlight>& flights,
                                  const std::optional<Diagnosis>& diagnosis);

}  // namespace quadtune::report
