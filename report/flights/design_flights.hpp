// SPDX-License-Identifier: Apache-2.0
/// The missions by which a design proved itself, as text and JSON.
#pragma once

#include <string>

#include "quadtune/internal/json_fwd.hpp"
#include "quadtune/workbench/design/design_verdict.hpp"

namespace quadtune::report {

[[nodiscard]] internal::Json missions_json(const DesignOutcome& outcome,
                                           const MissionDiagnoses& diagnoses);
/// One line a mission, and why where it failed.
[[nodiscard]] std::string missions_text(const DesignOutcome& outcome,
                                        const MissionDiagnoses& diagnoses);

}  // namespace quadtune::report
