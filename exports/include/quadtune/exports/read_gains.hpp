// SPDX-License-Identifier: Apache-2.0
/// Reads control laws from any file format that quadtune writes.
#pragma once

#include <filesystem>
#include <optional>
#include <string>

#include "quadtune/design.hpp"
#include "quadtune/exports/firmware_names.hpp"
#include "quadtune/exports/stored_estimator.hpp"
#include "quadtune/gains.hpp"

namespace quadtune {

/// The control laws of a file or directory: a state feedback, a cascade, both or none.
struct StoredLaws {
  std::string vehicle;                            ///< name; empty if the files do not contain it
  std::optional<Gains> gains;                     ///< a state feedback
  std::optional<CascadeDesign> cascade;           ///< with its gains, all six loops
  std::optional<StoredEstimator> estimator = {};  ///< with which the laws were evaluated
  /// Of an autopilot, whose loops `cascade` represents; firmware_controller() flies them.
  std::optional<StoredParameters> parameters = {};
};

/// Reads the laws of an export or of a file.
///
/// @param path  A directory. With a manifest: the listed files, completed by the trim, sample time
///              and vehicle of the manifest; without: gains.json, controllerVars.m or the files of
///              one uquad build. Or a file: gains.json, manifest.json, the JSON output of `quadtune
///              lqr V` or `quadtune pid V`, controllerVars.m, or a uquad gain file, next to which
///              its other half must be. The format is detected from the contents (JSON from its
///              first character); only uquad files are recognized by their names.
/// @throws InvalidInput  "file:line: …" or "file: json path: …" if a file is malformed or is not a
///                       gain file
/// @throws FileError     if a file cannot be read
[[nodiscard]] StoredLaws read_laws(const std::filesystem::path& path);

/// The state feedback of read_laws().
/// @throws InvalidInput  as read_laws(), or if there is none
[[nodiscard]] Gains read_gains(const std::filesystem::path& path);

}  // namespace quadtune
