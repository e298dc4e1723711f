// SPDX-License-Identifier: Apache-2.0
/// Reads control laws back from whatever quadtune writes.
#pragma once

#include <filesystem>
#include <optional>
#include <string>

#include "quadtune/design.hpp"
#include "quadtune/exports/firmware_names.hpp"
#include "quadtune/exports/stored_estimator.hpp"
#include "quadtune/gains.hpp"

namespace quadtune {

/// What files hold of control laws: one, both, or none.
struct StoredLaws {
  std::string vehicle;                            ///< its name; empty where the files do not say it
  std::optional<Gains> gains;                     ///< a state feedback
  std::optional<CascadeDesign> cascade;           ///< with its gains, all six loops
  std::optional<StoredEstimator> estimator = {};  ///< that the laws were judged with
  /// Of an autopilot, whose loops `cascade` stands for: firmware_controller() flies them.
  std::optional<StoredParameters> parameters = {};
};

/// Reads the laws of an export or of a file.
///
/// @param path  a directory: with a manifest, what it lists, completed by the manifest's trim,
///              sample time and vehicle; without one, gains.json, controllerVars.m or the files of
///              one uquad build. Or a file: gains.json, manifest.json, what `quadtune lqr V` and
///              `quadtune pid V` write as JSON, controllerVars.m, or a uquad gain file, beside
///              which its second half lies. Files are known by what is in them, JSON by its first
///              character, but those of uquad by their names.
/// @throws InvalidInput  "file:line: …" or "file: json path: …" for what is wrong in a file, and
///                       for one that is no file of gains.
/// @throws FileError     if a file cannot be read.
[[nodiscard]] StoredLaws read_laws(const std::filesystem::path& path);

/// The state feedback of read_laws().
/// @throws InvalidInput  likewise, and where there is none.
[[nodiscard]] Gains read_gains(const std::filesystem::path& path);

}  // namespace quadtune
