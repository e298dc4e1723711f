// SPDX-License-Identifier: Apache-2.0
/// What the exporters need of a design that is solved.
#pragma once

#include <string>
#include <utility>
#include <vector>

#include "quadtune/exports/content.hpp"
#include "quadtune/model/vehicle.hpp"
#include "quadtune/workbench/design.hpp"

namespace quadtune {

/// Libraries that the gains come through, beside those that the exporters name: for the manifest.
[[nodiscard]] std::vector<std::pair<std::string, std::string>> library_versions();

/// A vehicle's file by its name, as a manifest has it; also of a built-in one.
[[nodiscard]] std::string vehicle_file_name(const Vehicle& vehicle);

/// What the exporters need.
[[nodiscard]] ExportContent export_content(const DesignOutcome& outcome);

}  // namespace quadtune
