// SPDX-License-Identifier: Apache-2.0
/// Writes an export: the files of a flight program and their manifest, whole or not at all.
#pragma once

#include <filesystem>
#include <functional>
#include <string>
#include <vector>

#include "quadtune/exports/content.hpp"
#include "quadtune/exports/manifest.hpp"

namespace quadtune {

/// The files of `kind` in memory, the manifest last. The same content gives the same bytes.
///
/// @throws InvalidInput  for content that the kind cannot express, and for any number that is not
///                       finite.
[[nodiscard]] std::vector<FileContent> export_files(const ExportKind& kind,
                                                    const ExportContent& content);

/// Writes them into `directory` as write_files does, and takes away what an earlier manifest there
/// lists and this export does not write, so that no old gain stays beside the new ones.
///
/// @return  the files written, the manifest last
/// @throws InvalidInput  as export_files; nothing is written then.
/// @throws FileError     with the path and the system's reason.
/// @throws Interrupted   when `interrupted` says so.
std::vector<ManifestFile> write_export(const std::filesystem::path& directory,
                                       const ExportKind& kind, const ExportContent& content,
                                       const std::function<bool()>& interrupted = {});

/// gains.json: gains with trim and law, vehicle, filters, cascade and weights, in SI with units.
[[nodiscard]] std::string gains_json_text(const ExportContent& content);

/// A vehicle as JSON with the tables and keys of a vehicle file, as it stands in gains.json. What
/// is not known, and what a file without the key would mean, is left out; the environment and the
/// curves of thrust and torque always stand.
[[nodiscard]] std::string vehicle_json_text(const Vehicle& vehicle);

inline constexpr char kGainsJsonName[] = "gains.json";

}  // namespace quadtune
