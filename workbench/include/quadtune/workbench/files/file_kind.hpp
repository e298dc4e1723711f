// SPDX-License-Identifier: Apache-2.0
/// Detects the kind of a file from its contents.
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

/// The kind with its article: "a design file", "an export".
[[nodiscard]] std::string to_string(FileKind kind);

/// Detects the kind of a file or folder from its keys and its name.
/// @return  no value if the kind is unknown, the file is not text or cannot be read, or the path is
///          neither a regular file nor a folder
[[nodiscard]] std::optional<FileKind> file_kind(const std::filesystem::path& path);

}  // namespace quadtune
