// SPDX-License-Identifier: Apache-2.0
/// A note for commands that use an export without verifying it.
#pragma once

#include <string>

#include "quadtune/model/vehicle.hpp"

namespace quadtune {

/// Names the first file of an export that is not the one that its manifest lists.
/// @param directory  of an export; anything else has no manifest and gives no note
/// @return  empty if all files match the manifest, or if there is none that can be read
[[nodiscard]] std::string changed_export(const std::string& directory);

/// The note on the file of a vehicle that was changed after an export for it.
/// @param directory  as for changed_export()
/// @param vehicle    the present one
/// @return  empty if the export was made from this file, from another one, or for a built-in vehicle
[[nodiscard]] std::string changed_vehicle(const std::string& directory, const Vehicle& vehicle);

}  // namespace quadtune
