// SPDX-License-Identifier: Apache-2.0
#include "quadtune/exports/read_gains.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cctype>
#include <cerrno>
#include <cmath>
#include <cstring>
#include <utility>

#include "built_in_exporters.hpp"
#include "export_text.hpp"
#include "json/to_json.hpp"
#include "quadtune/errors.hpp"
#include "quadtune/exports/export.hpp"
#include "quadtune/exports/uquad.hpp"
#include "quadtune/internal/json.hpp"

namespace quadtune {
namespace {

namespace fs = std::filesystem;

StoredLaws laws_of_manifest(const Manifest& manifest) {
  return {manifest.vehicle, manifest.gains, manifest.cascade};
}

StoredLaws read_json(const fs::path& path) {
  return exports::laws_of_json_text(exports::export_text(path), path.string());
}

StoredLaws read_m(const fs::path& path) {
  return exports::laws_of_m_text(exports::export_text(path), path.string());
}

StoredLaws read_uquad(const fs::path& path) { return {"", read_uquad_gains(path), {}}; }

StoredLaws read_by_manifest(const fs::path& directory) {
  const Manifest manifest = read_manifest(directory);
  return exporter_of(manifest.kind, (directory / kManifestName).string()).read(directory, manifest);
}

StoredLaws read_directory(const fs::path& path) {
  if (fs::exists(path / kManifestName)) return read_by_manifest(path);
  if (fs::exists(path / kGainsJsonName)) return read_json(path / kGainsJsonName);
  if (fs::exists(path / exports::kControllerVars)) return read_m(path / exports::kControllerVars);
  return read_uquad(path);
}

bool is_uquad_name(const std::string& name) {
  const std::vector<UquadFileSet>& sets = uquad_file_sets();
  return std::any_of(sets.begin(), sets.end(), [&](const UquadFileSet& set) {
    return name == set.proportional || (!set.integral.empty() && name == set.integral);
  });
}

// A file by what is in it, so that any name may be given to it; only uquad's have no mark but
// theirs.
StoredLaws read_file(const fs::path& path) {
  if (is_uquad_name(path.filename().string())) return read_uquad(path);
  const std::string origin = path.string();
  const std::string text = exports::export_text(path);
  const std::size_t first = text.find_first_not_of(" \t\r\n");
  const char mark = first == std::string::npos ? '\0' : text[first];
  if (mark == '{' || path.extension() == ".json") {
    if (exports::json_format(text, origin) == exports::kManifestFormat) {
      // Its folder holds more than it does, such as the estimator.
      if (path.filename() == kManifestName &&
          parse_manifest(text, origin).kind == ExportKind::json &&
          fs::exists(path.parent_path() / kGainsJsonName))
        return read_json(path.parent_path() / kGainsJsonName);
      return laws_of_manifest(parse_manifest(text, origin));
    }
    return exports::laws_of_json_text(text, origin);
  }
  if (mark == '%' || path.extension() == ".m") return exports::laws_of_m_text(text, origin);
  if (std::isdigit(static_cast<unsigned char>(mark)) != 0 || mark == '-' || mark == '+')
    return read_uquad(path);  // which tells the names that it takes
  throw InvalidInput(
      origin, fmt::format("is no file of gains, expected gains.json, manifest.json, {}, one of "
                          "uquad ({}, …), or what `quadtune lqr` or `pid` writes as JSON: with "
                          "--json, or into a name that ends in .json",
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
    throw InvalidInput(path.string(),
                       laws.cascade
                           ? "holds a PID cascade and no state feedback, expected a state feedback"
                           : "holds no control law, expected a state feedback");
  return std::move(*laws.gains);
}

}  // namespace quadtune
