// SPDX-License-Identifier: Apache-2.0
/// An export read back as the flight program would, and everything in it checked.
#pragma once

#include <string>
#include <vector>

#include "quadtune/exports/verify.hpp"
#include "quadtune/model/vehicle.hpp"
#include "quadtune/workbench/flown/flown_check.hpp"

namespace quadtune {

/// Re-reads the export with the vehicle that its manifest names.
/// @param vehicle  another vehicle or its file; empty: that of the manifest
/// @param design   the design file that it was made from; empty: one of that name where it is
///                 likely to lie
/// @throws FileError, InvalidInput  for what is no export, or a vehicle that is not built in
/// @throws OptionError              for a design that is none of the manifest's inputs
[[nodiscard]] VerifyReport verify_directory(const std::string& directory,
                                            const std::string& vehicle,
                                            const std::string& design = "");

/// The same with a vehicle and inputs in memory.
/// @param flown  flown loops of these laws that are known; none: they are computed
[[nodiscard]] VerifyReport verify_with(const std::string& directory, const Vehicle& vehicle,
                                       const std::vector<InputAtHand>& inputs,
                                       const std::vector<FlownLaw>* flown = nullptr);

}  // namespace quadtune
