// SPDX-License-Identifier: Apache-2.0
// gains.json as a MAT v5 file: each of its members becomes a variable.
#include "built_in_exporters.hpp"
#include "json/to_json.hpp"
#include "quadtune/exports/export.hpp"
#include "quadtune/internal/mat_values.hpp"

namespace quadtune::exports {
namespace {

namespace fs = std::filesystem;

constexpr char kGainsMatName[] = "gains.mat";

/// A variable must be a struct; the texts and numbers at the top level become fields of one.
std::string mat_of(const std::string& gains_json) {
  const Json json = parse_json(gains_json, kGainsJsonName, kGainsFormat, kGainsVersion);
  std::string bytes = internal::mat_header("MATLAB 5.0 MAT-file, quadtune");
  Json about = Json::object();
  for (const std::string& key : json.keys()) {
    const Json& value = json[key];
    if (value.is_object())
      bytes += internal::mat_of_json(value, key);
    else
      about[key] = value;
  }
  return bytes + internal::mat_of_json(about, "quadtune");
}

std::vector<FileContent> with_mat(std::vector<FileContent> files) {
  files.insert(files.begin(), {kGainsMatName, mat_of(files.front().bytes)});
  return files;
}

}  // namespace

Exporter mat_exporter() {
  // The laws are read from the gains.json next to it, which has the same numbers.
  const Exporter json = json_exporter();
  Exporter exporter = json;
  exporter.target = export_target("mat", "exporter");
  exporter.gain_files = {};  // no flight program reads a MAT file
  exporter.files = [json](const ExportContent& content) { return with_mat(json.files(content)); };
  exporter.read_plain = {};
  exporter.written_again = [json](const fs::path& directory, const Manifest& manifest,
                                  const Vehicle& vehicle) {
    return with_mat(json.written_again(directory, manifest, vehicle));
  };
  return exporter;
}

}  // namespace quadtune::exports
