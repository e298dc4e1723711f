// SPDX-License-Identifier: Apache-2.0
/// An export read back as the flight program would, and everything in it checked.
#pragma once

#include <string>
#include <vector>

#include "quadtune/exports/flight_code_check.hpp"
#include "quadtune/exports/verify.hpp"
#include "quadtune/model/vehicle.hpp"
#include "quadtune/workbench/flown/flown_check.hpp"

namespace quadtune {

/// The check that an export which was written by --force fails.
inline constexpr char kForcedCheck[] = "the design holds what it is asked for";

/// Re-reads the export with the vehicle that its manifest names.
/// @param vehicle  another vehicle or its file; empty: that of the manifest
/// @param design   the design file that it was made from, which is solved again and compared, or
///                 another of the manifest's inputs, whose hash is; empty: only the hashes of files
///                 of these names where they are likely to lie
/// @throws FileError, InvalidInput  for what is no export, or a vehicle that is not built in
/// @param arm      runs flight code under an emulator of ARM as well
/// @throws OptionError              for a design that is none of the manifest's inputs, and for
///                                  `arm` with what is no flight code
[[nodiscard]] VerifyReport verify_directory(const std::string& directory,
                                            const std::string& vehicle,
                                            const std::string& design = "", bool arm = false);

/// The same with a vehicle and inputs in memory.
/// @param flown    flown loops of these laws that are known; none: they are computed
/// @param targets  for which flight code is compiled
[[nodiscard]] VerifyReport verify_with(const std::string& directory, const Vehicle& vehicle,
                                       const std::vector<InputAtHand>& inputs,
                                       const std::vector<FlownLaw>* flown = nullptr,
                                       const std::vector<FlightCodeTarget>& targets = {
                                           FlightCodeTarget::host});

}  // namespace quadtune
