// SPDX-License-Identifier: Apache-2.0
/// Prepares gains from files for export to another program.
#pragma once

#include <string>
#include <vector>

#include "quadtune/exports/content.hpp"
#include "quadtune/exports/manifest.hpp"
#include "quadtune/exports/read_gains.hpp"

namespace quadtune {

/// Rejects continuous gains, because a flight computer needs a sample period.
/// @param laws  that are to be exported
/// @param path  of the laws, for messages
/// @throws InvalidInput  if the gains are continuous
void require_sampled(const StoredLaws& laws, const std::string& path);

/// The export of laws from files: gains, cascade, estimator and vehicle; no weights and filters.
/// @param laws     accepted by require_sampled()
/// @param vehicle  name or file of the laws' vehicle; empty: the vehicle that the laws name, which
///                 is built in or, for an export, a file nearby with the hash in its manifest
/// @param path     of the laws
/// @throws OptionError  "vehicle", if `vehicle` is empty and no such vehicle is found
/// @throws InvalidInput, FileError  as load_vehicle()
/// @throws NoSolution               if the vehicle cannot hover
[[nodiscard]] ExportContent export_content(StoredLaws laws, const std::string& vehicle,
                                           const std::string& path);

/// The export of a gain schedule: the schedule, its vehicle, and the files of both.
/// @param path     of a table
/// @param vehicle  name or file; empty: the vehicle that the schedule names
/// @throws OptionError  "vehicle", if `vehicle` is empty and the schedule's vehicle is not built in
/// @throws InvalidInput, FileError  as read_schedule() and load_vehicle(), or if the schedule is
///                       for another vehicle
[[nodiscard]] ExportContent schedule_content(const std::string& path, const std::string& vehicle);

/// Converts the gains to the convention of the target program and adds the plant that they control.
/// Gains without a trim get that of the vehicle.
/// @return  notes for the user, one sentence each
/// @throws InvalidInput  if the convention lacks a state of the gains
/// @throws NoSolution    if the vehicle has no such trim
[[nodiscard]] std::vector<std::string> adapt_to_program(ExportContent& content, ExportKind kind);

/// The loops of roll, pitch and yaw whose margins are too small to fly with the filters and the
/// delay of the target firmware: a phase margin below 20 deg or Ms above 3. The filters have their
/// defaults, except those that content.board sets. Empty if all are sufficient, or if the target is no firmware. The content must have passed
/// adapt_to_program().
[[nodiscard]] std::string weak_loops(const ExportContent& content, ExportKind kind);

/// Describes the loop that makes the laws fail: "the loop of these gains with mambo is unstable
/// (spectral radius 1.2)"; empty if every known loop is stable.
[[nodiscard]] std::string unstable_loop(const ExportContent& content);

/// The same for the loop with sensors and estimator at hover, as `verify` analyses it; empty if none
/// that can be analysed is unstable.
/// @throws NoSolution  if the vehicle cannot fly the trim of the gains
[[nodiscard]] std::string unstable_flown_loop(const ExportContent& content);

}  // namespace quadtune
