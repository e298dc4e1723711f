// SPDX-License-Identifier: Apache-2.0
#include "quadtune/exports/read_gains.hpp"

#include <cerrno>
#include <cstring>

#include "export_text.hpp"
#include "quadtune/errors.hpp"
#include "quadtune/exports/export.hpp"
#include "quadtune/exports/mambo.hpp"
#include "quadtune/exports/uquad.hpp"
#include "to_json.hpp"

namespace quadtune {
namespace {

namespace fs = std::filesystem;

constexpr char kControllerVars[] = "controllerVars.m";

Gains read_gains_json(const fs::path& path) {
  const internal::Json json =
      exports::parse_json(exports::export_text(path), path.string(), "quadtune-gains");
  return exports::gains_from_json(internal::member(json, "gains", path.string()),
                                  path.string() + ": gains");
}

Gains read_controller_vars(const fs::path& path) {
  return parse_controller_vars(exports::export_text(path), path.string());
}

Gains read_manifest_gains(const fs::path& path) {
  const Manifest manifest = parse_manifest(exports::export_text(path), path.string());
  if (!manifest.gains) throw InvalidInput(path.string(), "has no gains");
  return *manifest.gains;
}

// A uquad directory may hold other builds' files that the manifest does not list.
fs::path listed_uquad_file(const fs::path& directory, const Manifest& manifest) {
  for (const UquadFileSet& set : uquad_file_sets())
    for (const ManifestFile& file : manifest.files)
      if (file.path == set.proportional) return directory / file.path;
  throw InvalidInput((directory / kManifestName).string(), "lists no gain file of uquad");
}

Gains read_by_manifest(const fs::path& directory) {
  const Manifest manifest = read_manifest(directory);
  Gains gains;
  switch (manifest.kind) {
    case ExportKind::json:
      return read_gains_json(directory / kGainsJsonName);
    case ExportKind::mambo:
      gains = read_controller_vars(directory / kControllerVars);
      break;
    case ExportKind::uquad:
      gains = read_uquad_gains(listed_uquad_file(directory, manifest));
      break;
  }
  gains.vehicle = manifest.vehicle;
  if (!manifest.gains) return gains;
  // What the files cannot say; the columns are compared by name, so the order may differ.
  gains.dt = manifest.gains->dt;
  if (manifest.kind == ExportKind::uquad) {
    gains.sign_law = manifest.gains->sign_law;
    gains.u0 = manifest.gains->u0;
    for (std::size_t i = 0; i < gains.states.size(); ++i)
      for (std::size_t j = 0; j < manifest.gains->states.size(); ++j)
        if (gains.states[i].name == manifest.gains->states[j].name)
          gains.x0(static_cast<Eigen::Index>(i)) = manifest.gains->x0(static_cast<Eigen::Index>(j));
  }
  return gains;
}

}  // namespace

Gains read_gains(const fs::path& path) {
  std::error_code error;
  const fs::file_status status = fs::status(path, error);
  if (!fs::exists(status))
    throw FileError(path.string(), error ? error.message() : std::strerror(ENOENT));
  if (fs::is_directory(status)) {
    if (fs::exists(path / kManifestName)) return read_by_manifest(path);
    if (fs::exists(path / kGainsJsonName)) return read_gains_json(path / kGainsJsonName);
    if (fs::exists(path / kControllerVars)) return read_controller_vars(path / kControllerVars);
    return read_uquad_gains(path);
  }
  if (path.filename() == kManifestName) return read_manifest_gains(path);
  if (path.extension() == ".json") return read_gains_json(path);
  if (path.extension() == ".m") return read_controller_vars(path);
  return read_uquad_gains(path);
}

}  // namespace quadtune
