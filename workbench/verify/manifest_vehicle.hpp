// SPDX-License-Identifier: Apache-2.0
// The vehicle of an export, and where the files are from which the export was made.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "quadtune/exports/manifest.hpp"
#include "quadtune/model/vehicle.hpp"

namespace quadtune::internal {

/// The folders in which the inputs of an export are searched: its parent and the folder above, the
/// working directory, and `designs` and `vehicles` there.
[[nodiscard]] std::vector<std::filesystem::path> folders_of_inputs(const std::string& directory);

/// @param name  value of --vehicle; empty: the vehicle of the manifest, which is built in, or an
///              input of the manifest that is in one of these folders with the same bytes
/// @throws OptionError  "vehicle", if `name` is empty and there is no such vehicle, or if it is
///                      another vehicle than that of the manifest
/// @throws InvalidInput, FileError  if `name` is not a vehicle
[[nodiscard]] Vehicle vehicle_of_manifest(const std::string& directory, const Manifest& manifest,
                                          const std::string& name);

}  // namespace quadtune::internal
