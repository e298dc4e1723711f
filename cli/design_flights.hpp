// SPDX-License-Identifier: Apache-2.0
/// The missions by which a design proves itself.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "design_flow.hpp"

namespace quadtune::cli {

/// Flies every mission that the design asks for with the gains of the outcome.
/// @param keep_logs  for reports
/// @throws InvalidInput  "file:line: …" for a mission that cannot be flown
/// @throws FileError     for a mission file that cannot be read
[[nodiscard]] std::vector<FlownFlight> fly_missions(const DesignOutcome& outcome,
                                                    std::uint64_t seed, bool keep_logs);

/// Whether every mission passed.
[[nodiscard]] bool missions_passed(const DesignOutcome& outcome);

[[nodiscard]] internal::Json missions_json(const DesignOutcome& outcome);
/// One line a mission, and why where it failed.
[[nodiscard]] std::string missions_text(const DesignOutcome& outcome);

}  // namespace quadtune::cli
