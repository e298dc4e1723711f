// SPDX-License-Identifier: Apache-2.0
/// Writes an export, that is the files for a flight program and their manifest, atomically.
#pragma once

#include <filesystem>
#include <functional>
#include <string>
#include <vector>

#include "quadtune/exports/content.hpp"
#include "quadtune/exports/manifest.hpp"

namespace quadtune {

/// Creates the files of `kind` in memory, the manifest last. Equal content gives equal bytes.
///
/// @throws InvalidInput  if the kind cannot represent the content, or a number is not finite
[[nodiscard]] std::vector<FileContent> export_files(const ExportKind& kind,
                                                    const ExportContent& content);

/// Writes the files into `directory` as write_files() does. Files that an earlier manifest in
/// `directory` lists and this export does not write are deleted, so that no outdated gains remain.
///
/// @return  the files written, the manifest last
/// @throws InvalidInput  as export_files(); nothing is written then
/// @throws FileError     with the path and the system's reason
/// @throws Interrupted   if `interrupted` returns true
std::vector<ManifestFile> write_export(const std::filesystem::path& directory,
                                       const ExportKind& kind, const ExportContent& content,
                                       const std::function<bool()>& interrupted = {});

/// Text of gains.json: gains with trim and law, vehicle, filters, cascade and weights, in SI units.
[[nodiscard]] std::string gains_json_text(const ExportContent& content);

/// A vehicle as JSON with the tables and keys of a vehicle file, as in gains.json. Unknown values
/// and values equal to the default of a missing key are omitted; the environment and the thrust and
/// torque curves are always included.
[[nodiscard]] std::string vehicle_json_text(const Vehicle& vehicle);

/// Name of the file of an export that holds gains_json_text()
inline constexpr char kGainsJsonName[] = "gains.json";

}  // namespace quadtune
