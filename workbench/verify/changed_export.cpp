// SPDX-License-Identifier: Apache-2.0
#include "quadtune/workbench/verify/changed_export.hpp"

#include <fmt/format.h>

#include <filesystem>
#include <optional>

#include "quadtune/errors.hpp"
#include "quadtune/exports/file_set.hpp"
#include "quadtune/exports/manifest.hpp"
#include "quadtune/internal/text_file.hpp"

namespace quadtune {
namespace {

bool matches(const std::filesystem::path& path, const ManifestFile& listed) {
  std::error_code ignored;
  if (!std::filesystem::is_regular_file(path, ignored) ||
      std::filesystem::file_size(path, ignored) != listed.size)
    return false;
  return sha256(internal::read_file(path.string(), listed.size)) == listed.sha256;
}

/// The manifest of an export; none for anything else, or if it cannot be read, which the command
/// that reads the export reports.
std::optional<Manifest> manifest_of(const std::filesystem::path& folder) {
  std::error_code ignored;
  if (!std::filesystem::is_regular_file(folder / kManifestName, ignored)) return {};
  try {
    return read_manifest(folder);
  } catch (const InvalidInput&) {
    return {};
  } catch (const FileError&) {
    return {};
  }
}

}  // namespace

std::string changed_export(const std::string& directory) {
  const std::filesystem::path folder = directory;
  const std::optional<Manifest> manifest = manifest_of(folder);
  if (!manifest) return "";
  for (const ManifestFile& listed : manifest->files) {
    try {
      if (matches(folder / listed.path, listed)) continue;
    } catch (const FileError&) {
      return "";  // the command that reads the export reports it
    }
    return fmt::format(
        "{} does not match {}: it was changed after the export; `quadtune verify {}` reports more",
        (folder / listed.path).string(), kManifestName, directory);
  }
  return "";
}

std::string changed_vehicle(const std::string& directory, const Vehicle& vehicle) {
  if (vehicle.file.empty()) return "";
  const std::optional<Manifest> manifest = manifest_of(directory);
  if (!manifest || manifest->vehicle != vehicle.name) return "";
  for (const ManifestFile& input : manifest->inputs)
    if (input.path == vehicle.file.filename().string() && sha256(vehicle.text) != input.sha256)
      return fmt::format(
          "{} was changed after the export to {}, whose gains are for the earlier "
          "vehicle",
          vehicle.file.string(), directory);
  return "";
}

}  // namespace quadtune
