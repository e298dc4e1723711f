// SPDX-License-Identifier: Apache-2.0
#include "built_in_exporters.hpp"
#include "export_text.hpp"
#include "quadtune/exports/mambo.hpp"

namespace quadtune::exports {
namespace {

namespace fs = std::filesystem;

StoredLaws laws_of_m_text(const std::string& text, const std::string& origin) {
  StoredLaws laws;
  laws.cascade = parse_cascade_vars(text, origin);
  if (has_state_feedback(text, origin)) laws.gains = parse_controller_vars(text, origin);
  return laws;
}

StoredLaws read(const fs::path& directory, const Manifest& manifest) {
  const fs::path path = directory / kControllerVars;
  StoredLaws laws = laws_of_m_text(export_text(path), path.string());
  laws.vehicle = manifest.vehicle;
  if (laws.gains) laws.gains->vehicle = manifest.vehicle;
  return laws;
}

std::optional<StoredLaws> read_plain(const fs::path& path) {
  const bool is_directory = fs::is_directory(path);
  const fs::path file = is_directory ? path / kControllerVars : path;
  if (is_directory && !fs::exists(file)) return {};
  const std::string text = export_text(file);
  if (!is_directory && first_mark(text) != '%' && file.extension() != ".m") return {};
  return laws_of_m_text(text, file.string());
}

}  // namespace

Exporter mambo_exporter() {
  Exporter exporter;
  exporter.target = export_target("mambo", "exporter");
  exporter.convention = "mambo";
  exporter.gain_files = {"vehicleVars.m", kControllerVars, "estimatorVars.m"};
  exporter.always_has_cascade = true;
  exporter.files = mambo_files;
  exporter.numbers = [](const FileContent& file) { return parse_m_file(file.bytes, file.name); };
  exporter.read = read;
  exporter.read_plain = read_plain;
  return exporter;
}

}  // namespace quadtune::exports
