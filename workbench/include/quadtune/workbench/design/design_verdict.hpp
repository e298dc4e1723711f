// SPDX-License-Identifier: Apache-2.0
/// Whether a design may be flown, and what its user has to know.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "quadtune/workbench/design/design.hpp"
#include "quadtune/workbench/design/written_exports.hpp"
#include "quadtune/workbench/flight/diagnosis.hpp"

namespace quadtune {

/// Why a design failed; of several reasons the first of these.
enum class DesignFailure {
  none,
  unstable_cascade,     ///< with the ideal plant
  unstable_flown_loop,  ///< with rotor lag, sensors and estimator
  mission,              ///< a flight did not pass
  verification,         ///< what was written does not read back right
};

/// "the cascade does not hold the vehicle", …; "" of none.
[[nodiscard]] std::string to_string(DesignFailure failure);

/// @param written  the design's exports; none: nothing was written, which has nothing to fail
[[nodiscard]] DesignFailure failure_of(const DesignOutcome& outcome,
                                       const std::vector<WrittenExport>& written);

/// Why a design should not be exported, a sentence each: covariances that logs did not prove, and
/// failure_of() what was flown of it. Empty: nothing stands against it.
[[nodiscard]] std::vector<std::string> reasons_against_export(const DesignOutcome& outcome);

/// What a careful engineer would look at before flying: of weights, covariances, margins, cascade
/// and flown loops, a sentence each.
[[nodiscard]] std::vector<std::string> design_warnings(const DesignOutcome& outcome);

/// What a reader must know of the model and of the flights, e.g. of sensors that were assumed: each
/// once.
[[nodiscard]] std::vector<std::string> design_notes(const DesignOutcome& outcome);

/// Why flights of a design failed; none of one that passed.
struct MissionDiagnoses {
  std::vector<std::optional<Diagnosis>> flights;    ///< of each in DesignOutcome::flights
  std::vector<std::optional<Diagnosis>> disturbed;  ///< likewise
};

/// Flies every flight that failed again, as diagnose() does.
/// @throws InvalidInput, Interrupted  as diagnose()
[[nodiscard]] MissionDiagnoses diagnose_missions(const DesignOutcome& outcome);

}  // namespace quadtune
