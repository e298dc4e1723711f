// SPDX-License-Identifier: Apache-2.0
#include "quadtune/exports/export.hpp"

#include <fmt/format.h>
#include <openssl/opensslv.h>

#include <algorithm>
#include <nlohmann/json_fwd.hpp>  // its version

#include "json/to_json.hpp"
#include "quadtune/errors.hpp"
#include "quadtune/exports/exporter.hpp"
#include "quadtune/exports/verify.hpp"
#include "quadtune/internal/json.hpp"
#include "quadtune/version.hpp"

namespace quadtune {
namespace {

using internal::Json;

ManifestFile listed(const FileContent& file) {
  return {file.name, sha256(file.bytes), file.bytes.size()};
}

std::vector<std::pair<std::string, std::string>> own_versions() {
  return {{"quadtune", kVersion},
          {"Eigen",
           fmt::format("{}.{}.{}", EIGEN_WORLD_VERSION, EIGEN_MAJOR_VERSION, EIGEN_MINOR_VERSION)},
          {"nlohmann-json", fmt::format("{}.{}.{}", NLOHMANN_JSON_VERSION_MAJOR,
                                        NLOHMANN_JSON_VERSION_MINOR, NLOHMANN_JSON_VERSION_PATCH)},
          {"fmt", fmt::format("{}.{}.{}", FMT_VERSION / 10000, FMT_VERSION / 100 % 100,
                              FMT_VERSION % 100)},
          {"OpenSSL", OPENSSL_VERSION_STR}};
}

Manifest make_manifest(const Exporter& exporter, const ExportContent& content,
                       const std::vector<FileContent>& files) {
  Manifest manifest;
  manifest.kind = ExportKind(exporter.target.name);
  manifest.vehicle = content.vehicle.name;
  manifest.versions = own_versions();
  manifest.versions.insert(manifest.versions.end(), content.versions.begin(),
                           content.versions.end());
  manifest.made_at = content.made_at;
  manifest.forced = content.forced;
  for (const FileContent& file : content.inputs) manifest.inputs.push_back(listed(file));
  for (const FileContent& file : files) manifest.files.push_back(listed(file));
  manifest.gains = content.gains;
  if (exporter.writes_cascade) manifest.cascade = content.cascade;
  manifest.Q = content.Q;
  manifest.R = content.R;
  manifest.evidence = content.evidence;
  if (content.gains && content.plant)
    manifest.closed_loop_poles = closed_loop_poles(*content.plant, *content.gains);
  if (manifest.cascade && content.cascade_plant)
    manifest.cascade_poles = closed_loop_poles(*content.cascade_plant, *content.cascade);
  if (exporter.numbers)
    for (const FileContent& file : files)
      for (NamedMatrix& number : exporter.numbers(file))
        manifest.numbers.push_back(std::move(number));
  return manifest;
}

// Files that an earlier export of ours left in the directory. Files in no manifest are not ours.
std::vector<std::string> left_behind(const std::filesystem::path& directory,
                                     const std::vector<FileContent>& files) {
  std::vector<std::string> stale;
  std::error_code ignored;
  if (!std::filesystem::is_regular_file(directory / kManifestName, ignored)) return stale;
  try {
    for (const ManifestFile& old : read_manifest(directory).files)
      if (std::none_of(files.begin(), files.end(),
                       [&](const FileContent& file) { return file.name == old.path; }))
        stale.push_back(old.path);
  } catch (const InvalidInput&) {
    // A malformed manifest lists no file of ours; it is replaced.
  }
  return stale;
}

/// Puts the loops into their usual order and gives them the units and outputs of their names: the
/// readers of the files assume both.
ExportContent in_usual_words(ExportContent content) {
  if (!content.cascade) return content;
  std::vector<PidLoop>& loops = content.cascade->gains.loops;
  std::vector<PidLoop> usual;
  for (const CascadeAxis axis : kAllCascadeAxes)
    for (const PidLoop& loop : loops) {
      if (loop.name != to_string(axis)) continue;
      usual.push_back(loop);
      usual.back().unit = cascade_loop(axis).unit;
      usual.back().output = cascade_loop(axis).output;
    }
  if (usual.size() == loops.size()) loops = std::move(usual);
  return content;
}

std::vector<FileContent> with_manifest(const Exporter& exporter, const ExportContent& content) {
  std::vector<FileContent> files = exporter.files(content);
  const Manifest manifest = make_manifest(exporter, content, files);
  files.push_back({kManifestName, manifest_text(manifest)});
  return files;
}

}  // namespace

std::vector<FileContent> export_files(const ExportKind& kind, const ExportContent& content) {
  const Exporter& exporter = exporter_of(kind, "export");
  if (content.schedule && exporter.target.name != kFlightCodeTarget)
    throw InvalidInput("export", fmt::format("'{}' cannot hold a gain schedule, expected '{}', the "
                                             "only export that can",
                                             exporter.target.name, kFlightCodeTarget));
  const ExportContent usual = in_usual_words(content);
  return with_manifest(exporter, exporter.fit ? exporter.fit(usual) : usual);
}

std::vector<ManifestFile> write_export(const std::filesystem::path& directory,
                                       const ExportKind& kind, const ExportContent& content,
                                       const std::function<bool()>& interrupted) {
  const std::vector<FileContent> files = export_files(kind, content);
  write_files(directory, files, left_behind(directory, files), interrupted);
  std::vector<ManifestFile> written;
  written.reserve(files.size());
  for (const FileContent& file : files) written.push_back(listed(file));
  return written;
}

std::string vehicle_json_text(const Vehicle& vehicle) {
  return internal::readable(exports::vehicle_to_json(vehicle)) + "\n";
}

std::string gains_json_text(const ExportContent& content) {
  Json json;
  json["format"] = "quadtune-gains";
  const bool dynamic = content.gains && exports::has_dynamic_parts(*content.gains);
  const int version = dynamic || content.estimator ? 2 : 1;
  json["format_version"] = version;
  if (content.gains) json["gains"] = exports::gains_to_json(*content.gains, version);
  json["vehicle"] = exports::vehicle_to_json(content.vehicle);
  json["filters"] = Json::array();
  for (const KalmanFilter& filter : content.filters)
    json["filters"].push_back(exports::filter_to_json(filter));
  if (content.cascade) json["cascade"] = exports::cascade_to_json(*content.cascade);
  if (version >= 2)
    json["estimator"] =
        content.estimator ? exports::estimator_to_json(*content.estimator) : Json(nullptr);
  if (content.parameters) json["parameters"] = exports::parameters_to_json(*content.parameters);
  exports::add_weights(json, content.Q, content.R);
  return internal::readable(json) + "\n";
}

}  // namespace quadtune
