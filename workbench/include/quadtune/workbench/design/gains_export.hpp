// SPDX-License-Identifier: Apache-2.0
/// Gains from files, made ready to be exported for another program.
#pragma once

#include <string>
#include <vector>

#include "quadtune/exports/content.hpp"
#include "quadtune/exports/manifest.hpp"
#include "quadtune/exports/read_gains.hpp"

namespace quadtune {

/// Refuses continuous gains, because a computer flies them in a sample period.
/// @param path  of the laws, for messages
/// @throws InvalidInput
void require_sampled(const StoredLaws& laws, const std::string& path);

/// What is exported of laws from files: gains, cascade, estimator and vehicle; no weights, no
/// filters.
/// @param laws     as require_sampled() takes them
/// @param vehicle  name or file of the vehicle that the laws are for
/// @param path     of the laws, for messages
/// @throws InvalidInput, FileError  as load_vehicle()
/// @throws NoSolution               if the vehicle cannot hover
[[nodiscard]] ExportContent export_content(StoredLaws laws, const std::string& vehicle,
                                           const std::string& path);

/// What is exported of a gain schedule: it, its vehicle, and the files of both.
/// @param path     of a table
/// @param vehicle  name or file; empty: the vehicle that the schedule names
/// @throws InvalidInput, FileError  as read_schedule() and load_vehicle(), and for another vehicle
[[nodiscard]] ExportContent schedule_content(const std::string& path, const std::string& vehicle);

/// Turns the gains into the convention of the program that they are for, and adds the plant that
/// they fly with. Gains without a trim get that of the vehicle.
/// @return  what the user should know of this, a sentence each
/// @throws InvalidInput  for gains whose states the convention does not have
/// @throws NoSolution    if the vehicle has no such trim
[[nodiscard]] std::vector<std::string> adapt_to_program(ExportContent& content, ExportKind kind);

/// Why the laws do not hold the vehicle: "the loop of these gains with mambo is unstable (spectral
/// radius 1.2)"; empty if every loop that is known is stable.
[[nodiscard]] std::string unstable_loop(const ExportContent& content);

}  // namespace quadtune
