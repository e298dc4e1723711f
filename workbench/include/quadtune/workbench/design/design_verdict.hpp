// SPDX-License-Identifier: Apache-2.0
/// Whether a design may be flown, and what its user should know.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "quadtune/workbench/design/design.hpp"
#include "quadtune/workbench/export/written_exports.hpp"
#include "quadtune/workbench/flight/diagnosis.hpp"

namespace quadtune {

/// Why a design failed; if there are several reasons, the first in this order.
enum class DesignFailure {
  none,
  unstable_cascade,     ///< with the ideal plant
  unstable_flown_loop,  ///< with rotor lag, sensors and estimator
  mission,              ///< a flight failed
  firmware_margins,     ///< written by force although the margins on a firmware are too small
  verification,         ///< the written files do not verify
};

/// For example "the cascade does not hold the vehicle"; "" for none.
[[nodiscard]] std::string to_string(DesignFailure failure);

/// @param outcome  of design()
/// @param written  the exports of the design; if empty, nothing was written and none can fail
[[nodiscard]] DesignFailure failure_of(const DesignOutcome& outcome,
                                       const std::vector<WrittenExport>& written);

/// Reasons against exporting a design, one sentence each: covariances that the logs do not support,
/// and the failed flights and loops (failure_of()). Empty: no objection.
[[nodiscard]] std::vector<std::string> reasons_against_export(const DesignOutcome& outcome);

/// Warnings to consider before a flight, about weights, covariances, margins, cascade and flown
/// loops; one sentence each.
[[nodiscard]] std::vector<std::string> design_warnings(const DesignOutcome& outcome);

/// Notes about the model and the flights, e.g. about assumed sensors; each occurs once.
[[nodiscard]] std::vector<std::string> design_notes(const DesignOutcome& outcome);

/// Why flights of a design failed; no value for flights that passed.
struct MissionDiagnoses {
  std::vector<std::optional<Diagnosis>> flights;    ///< corresponds to DesignOutcome::flights
  std::vector<std::optional<Diagnosis>> disturbed;  ///< corresponds to DesignOutcome::disturbed
};

/// Diagnoses every failed flight with diagnose().
/// @throws InvalidInput, Interrupted  as diagnose()
[[nodiscard]] MissionDiagnoses diagnose_missions(const DesignOutcome& outcome);

}  // namespace quadtune
