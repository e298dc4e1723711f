// SPDX-License-Identifier: Apache-2.0
/// What the exporters need of a design that is solved.
#pragma once

#include <string>
#include <utility>
#include <vector>

#include "quadtune/exports/content.hpp"
#include "quadtune/model/vehicle.hpp"
#include "quadtune/workbench/design/design.hpp"

namespace quadtune {

/// Libraries that the gains come through, beside those that the exporters name: for the manifest.
[[nodiscard]] std::vector<std::pair<std::string, std::string>> library_versions();

/// A vehicle's file by its name, as a manifest has it; also of a built-in one.
[[nodiscard]] std::string vehicle_file_name(const Vehicle& vehicle);

/// ExportEvidence::method of gains by flown_lqi().
inline constexpr char kFlownLqiMethod[] = "sampled LQI on the flown plant";

/// What the exporters need. Weights on changes of the commands have no place in a manifest: gains
/// with such weights come without weights and evidence.
[[nodiscard]] ExportContent export_content(const DesignOutcome& outcome);

}  // namespace quadtune
