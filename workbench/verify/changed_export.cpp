// SPDX-License-Identifier: Apache-2.0
#include "quadtune/workbench/verify/changed_export.hpp"

#include <fmt/format.h>

#include <filesystem>

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

}  // namespace

std::string changed_export(const std::string& directory) {
  const std::filesystem::path folder = directory;
  std::error_code ignored;
  if (!std::filesystem::is_regular_file(folder / kManifestName, ignored)) return "";
  try {
    for (const ManifestFile& listed : read_manifest(folder).files)
      if (!matches(folder / listed.path, listed))
        return fmt::format(
            "{} does not match {}: it was changed after the export; `quadtune verify "
            "{}` reports more",
            (folder / listed.path).string(), kManifestName, directory);
  } catch (const InvalidInput&) {
    return "";  // the command that reads the export reports it
  } catch (const FileError&) {
    return "";
  }
  return "";
}

}  // namespace quadtune
