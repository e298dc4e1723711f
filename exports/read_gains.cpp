// SPDX-License-Identifier: Apache-2.0
#include "quadtune/exports/read_gains.hpp"

#include <fmt/format.h>

#include <cerrno>
#include <cmath>
#include <cstring>
#include <utility>

#include "built_in_exporters.hpp"
#include "export_text.hpp"
#include "json/to_json.hpp"
#include "quadtune/errors.hpp"
#include "quadtune/exports/export.hpp"
#include "quadtune/exports/exports_below.hpp"
#include "quadtune/exports/uquad.hpp"
#include "quadtune/internal/joined.hpp"
#include "quadtune/internal/json.hpp"

namespace quadtune {
namespace {

namespace fs = std::filesystem;

StoredLaws laws_of_manifest(const Manifest& manifest) {
  return {manifest.vehicle, manifest.gains, manifest.cascade};
}

// Exporters that were added have priority over the built-in ones.
std::optional<StoredLaws> read_plain(const fs::path& path) {
  for (auto exporter = exporters().rbegin(); exporter != exporters().rend(); ++exporter)
    if (exporter->read_plain)
      if (std::optional<StoredLaws> laws = exporter->read_plain(path)) return laws;
  return {};
}

StoredLaws read_export(const fs::path& directory, const Manifest& manifest) {
  return exporter_of(manifest.kind, (directory / kManifestName).string()).read(directory, manifest);
}

std::string expected_in(const fs::path& directory) {
  const std::vector<std::string> below = exports_below(directory);
  if (!below.empty()) return "one of the exports in it: " + internal::joined(below, ", ");
  std::vector<std::string> names{kGainsJsonName, exports::kControllerVars};
  for (const UquadFileSet& set : uquad_file_sets()) names.push_back(set.proportional);
  return "an export or one of " + internal::joined(names, ", ");
}

StoredLaws read_directory(const fs::path& path) {
  if (fs::exists(path / kManifestName)) return read_export(path, read_manifest(path));
  if (std::optional<StoredLaws> laws = read_plain(path)) return *std::move(laws);
  throw InvalidInput(path.string(), fmt::format("has no {} and no gain file; expected {}",
                                                kManifestName, expected_in(path)));
}

std::optional<Manifest> manifest_of(const fs::path& path) {
  const std::string text = exports::export_text(path);
  if (!exports::is_json(path, text) ||
      exports::json_format(text, path.string()) != exports::kManifestFormat)
    return {};
  return parse_manifest(text, path.string());
}

StoredLaws read_file(const fs::path& path) {
  if (const std::optional<Manifest> manifest = manifest_of(path)) {
    // Its folder has more than the manifest, such as the estimator.
    if (path.filename() == kManifestName && manifest->kind == ExportKind::json &&
        fs::exists(path.parent_path() / kGainsJsonName))
      return read_export(path.parent_path(), *manifest);
    return laws_of_manifest(*manifest);
  }
  if (std::optional<StoredLaws> laws = read_plain(path)) return *std::move(laws);
  throw InvalidInput(
      path.string(),
      fmt::format(
          "is not a gain file; expected gains.json, manifest.json, {}, a gain file of uquad ({}, "
          "…), or the JSON output of `quadtune lqr`, `lqg`, `pid` or `import` (--json, or -o "
          "with a name that ends in .json); in some commands also a design file or a gain schedule",
          exports::kControllerVars, uquad_file_sets().front().proportional));
}

}  // namespace

StoredLaws read_laws(const fs::path& path) {
  std::error_code error;
  const fs::file_status status = fs::status(path, error);
  if (!fs::exists(status))
    throw FileError(path.string(), error ? error.message() : std::strerror(ENOENT));
  return fs::is_directory(status) ? read_directory(path) : read_file(path);
}

Gains read_gains(const fs::path& path) {
  StoredLaws laws = read_laws(path);
  if (!laws.gains)
    throw InvalidInput(path.string(), laws.cascade
                                          ? "has a PID cascade, but no state feedback"
                                          : "has no control law; expected a state feedback");
  return std::move(*laws.gains);
}

}  // namespace quadtune
