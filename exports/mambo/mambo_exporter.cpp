// SPDX-License-Identifier: Apache-2.0
#include "built_in_exporters.hpp"
#include "export_text.hpp"
#include "quadtune/exports/mambo.hpp"

namespace quadtune::exports {
namespace {

StoredLaws read(const std::filesystem::path& directory, const Manifest& manifest) {
  const std::filesystem::path path = directory / kControllerVars;
  StoredLaws laws = laws_of_m_text(export_text(path), path.string());
  laws.vehicle = manifest.vehicle;
  if (laws.gains) laws.gains->vehicle = manifest.vehicle;
  return laws;
}

}  // namespace

StoredLaws laws_of_m_text(const std::string& text, const std::string& origin) {
  StoredLaws laws;
  laws.cascade = parse_cascade_vars(text, origin);
  if (has_state_feedback(text, origin)) laws.gains = parse_controller_vars(text, origin);
  return laws;
}

Exporter mambo_exporter() {
  Exporter exporter;
  exporter.target = export_target("mambo", "exporter");
  exporter.convention = "mambo";
  exporter.gain_files = {"vehicleVars.m", kControllerVars, "estimatorVars.m"};
  exporter.always_has_cascade = true;
  exporter.files = mambo_files;
  exporter.numbers = [](const FileContent& file) { return parse_m_file(file.bytes, file.name); };
  exporter.read = read;
  return exporter;
}

}  // namespace quadtune::exports
