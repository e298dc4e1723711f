// SPDX-License-Identifier: Apache-2.0
/// A vehicle's PID cascade, designed as `quadtune pid V` does, and how it flies.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "quadtune/exports/content.hpp"
#include "quadtune/model/vehicle.hpp"
#include "quadtune/workbench/design/cascade_options.hpp"
#include "quadtune/workbench/design/cascade_report.hpp"
#include "quadtune/workbench/flown/flown_gains.hpp"
#include "quadtune/workbench/flown/flown_loop.hpp"

namespace quadtune {

struct VehicleCascade {
  bool ideal = false;               ///< whether it was designed on the textbook plant
  CascadeReport report;             ///< its gains, and its loops about a hover
  std::optional<FlownGains> flown;  ///< where all gains were designed at once on the flown plant
  ExportContent content;            ///< the cascade and the estimator, as they are exported
  std::optional<FlownLoop> loop;    ///< as it flies about a hover; none where it is not analysed
  std::string not_analysed;         ///< then why
};

/// @param where  the file or vehicle that asked for it, for messages
/// @throws OptionError   for a wrong value, and for options that exclude each other
/// @throws InvalidInput  as flown_gains()
/// @throws NoSolution    naming the loop that cannot be had
[[nodiscard]] VehicleCascade vehicle_cascade(const Vehicle& vehicle, const CascadeOptions& options,
                                             const std::string& where);

/// What the designer should know, a sentence each: "note: …" or "warning: …".
[[nodiscard]] std::vector<std::string> notes_of(const VehicleCascade& cascade);

}  // namespace quadtune
