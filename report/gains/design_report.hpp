// SPDX-License-Identifier: Apache-2.0
/// What a controls engineer wants to see first of a design, as text and as JSON.
#pragma once

#include <string>
#include <vector>

#include "quadtune/internal/json_fwd.hpp"
#include "quadtune/workbench/design/design_verdict.hpp"

namespace quadtune::report {

[[nodiscard]] internal::Json design_json(const DesignOutcome& outcome,
                                         const MissionDiagnoses& diagnoses,
                                         const std::vector<WrittenExport>& written);
[[nodiscard]] std::string design_text(const DesignOutcome& outcome,
                                      const MissionDiagnoses& diagnoses,
                                      const std::vector<WrittenExport>& written);

}  // namespace quadtune::report
