// SPDX-License-Identifier: Apache-2.0
/// Converts a solved design to the input of the exporters.
#pragma once

#include <string>
#include <utility>
#include <vector>

#include "quadtune/exports/content.hpp"
#include "quadtune/model/vehicle.hpp"
#include "quadtune/workbench/design/design.hpp"

namespace quadtune {

/// Libraries that the gains depend on and that the exporters do not list; for the manifest.
[[nodiscard]] std::vector<std::pair<std::string, std::string>> library_versions();

/// The file name of a vehicle for the manifest; also for a built-in vehicle.
[[nodiscard]] std::string vehicle_file_name(const Vehicle& vehicle);

/// ExportEvidence::method of gains that flown_lqi() computed.
inline constexpr char kFlownLqiMethod[] = "sampled LQI on the flown plant";

/// The input of the exporters. A manifest cannot hold weights on changes of the commands: gains
/// with such weights are exported without weights and evidence.
[[nodiscard]] ExportContent export_content(const DesignOutcome& outcome);

}  // namespace quadtune
