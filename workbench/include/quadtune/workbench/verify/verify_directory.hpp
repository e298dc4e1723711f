// SPDX-License-Identifier: Apache-2.0
/// Reads an export as the flight program would, and checks its contents.
#pragma once

#include <string>
#include <vector>

#include "quadtune/exports/flight_code_check.hpp"
#include "quadtune/exports/verify.hpp"
#include "quadtune/model/vehicle.hpp"
#include "quadtune/workbench/flown/flown_check.hpp"

namespace quadtune {

/// The check that fails for an export that was written with --force.
inline constexpr char kForcedCheck[] = "the design meets its requirements";

/// Verifies an export with the vehicle that its manifest names.
/// @param directory  of the export
/// @param vehicle  another vehicle or its file; empty: that of the manifest
/// @param design   the design file from which it was made, which is solved again and compared; or
///                 another input of the manifest, whose hash is compared; empty: only the hashes of
///                 files with these names in the likely places are compared
/// @param arm      also runs flight code under an emulator of ARM
/// @throws FileError, InvalidInput  if the directory is not an export, or the vehicle is unknown
/// @throws OptionError              if the design is not one of the manifest's inputs, or `arm` is
///                                  set and the export is not flight code
[[nodiscard]] VerifyReport verify_directory(const std::string& directory,
                                            const std::string& vehicle,
                                            const std::string& design = "", bool arm = false);

/// The same with a vehicle and inputs in memory.
/// @param directory  of the export
/// @param vehicle    valid
/// @param inputs     files from which the export may have been made
/// @param flown      known flown loops of these laws; null: they are computed
/// @param targets    for which flight code is compiled
[[nodiscard]] VerifyReport verify_with(const std::string& directory, const Vehicle& vehicle,
                                       const std::vector<InputAtHand>& inputs,
                                       const std::vector<FlownLaw>* flown = nullptr,
                                       const std::vector<FlightCodeTarget>& targets = {
                                           FlightCodeTarget::host});

}  // namespace quadtune
