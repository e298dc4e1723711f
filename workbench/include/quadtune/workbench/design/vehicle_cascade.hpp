// SPDX-License-Identifier: Apache-2.0
/// A vehicle's PID cascade, designed as by `quadtune pid V`, and its flown loop.
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

/// A cascade with its evidence.
struct VehicleCascade {
  bool ideal = false;               ///< whether it was designed on the textbook plant
  CascadeReport report;             ///< its gains, and its loops at hover
  std::optional<FlownGains> flown;  ///< if all gains were designed at once on the flown plant
  ExportContent content;            ///< the cascade and the estimator for an export
  std::optional<FlownLoop> loop;    ///< flown loop at hover; none if it is not analysed
  std::string not_analysed;         ///< reason if `loop` is empty
  std::string advice;               ///< an option that would improve the gains; empty if none
};

/// @param vehicle  valid
/// @param options  requirements, and where the loops are designed and analysed
/// @param where    file or vehicle, for messages
/// @throws OptionError   if a value is invalid, or options exclude each other
/// @throws InvalidInput  as flown_gains()
/// @throws NoSolution    naming the loop that cannot be designed
[[nodiscard]] VehicleCascade vehicle_cascade(const Vehicle& vehicle, const CascadeOptions& options,
                                             const std::string& where);

/// Notes for the designer, one sentence each: "note: …" or "warning: …".
[[nodiscard]] std::vector<std::string> notes_of(const VehicleCascade& cascade);

}  // namespace quadtune
