// SPDX-License-Identifier: Apache-2.0
/// Reads gains back from whatever quadtune exports.
#pragma once

#include <filesystem>

#include "quadtune/gains.hpp"

namespace quadtune {

/// Reads a state feedback.
///
/// @param path  a directory: with a manifest, what it lists, completed by the manifest's trim,
///              sample time and vehicle; without one, gains.json, controllerVars.m or the files of
///              one uquad build. Or a file: gains.json, manifest.json, controllerVars.m, or a
///              uquad gain file, beside which its second half lies.
/// @throws InvalidInput  "file:line: …" or "file: json path: …" for what is wrong in a file, and
///                       for a path that holds no gains.
/// @throws FileError     if a file cannot be read.
[[nodiscard]] Gains read_gains(const std::filesystem::path& path);

}  // namespace quadtune
