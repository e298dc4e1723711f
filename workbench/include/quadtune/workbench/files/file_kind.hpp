// SPDX-License-Identifier: Apache-2.0
/// What a file is, by what is in it.
#pragma once

#include <filesystem>
#include <optional>
#include <string>

namespace quadtune {

/// Kinds of files and folders that are read or written here.
enum class FileKind {
  export_folder,
  gains,
  design,
  vehicle,
  mission,
  campaign,
  campaign_folder,
  requirements,
  filter_model,
  schedule,
  log,
  calibration,
  other_json,  ///< neither gains nor an export
  page,
};

/// With its article: "a design file", "an export".
[[nodiscard]] std::string to_string(FileKind kind);

/// The kind of a file or folder, by its keys and its name.
/// @return  none for what is not known, is no text, cannot be read, or is neither a regular file
/// nor
///          a folder
[[nodiscard]] std::optional<FileKind> file_kind(const std::filesystem::path& path);

}  // namespace quadtune
