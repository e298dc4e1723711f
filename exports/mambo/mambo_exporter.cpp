// SPDX-License-Identifier: Apache-2.0
#include <algorithm>

#include "built_in_exporters.hpp"
#include "export_text.hpp"
#include "filter_matrices.hpp"
#include "quadtune/errors.hpp"
#include "quadtune/exports/mambo.hpp"

namespace quadtune::exports {
namespace {

namespace fs = std::filesystem;

constexpr char kEstimatorVars[] = "estimatorVars.m";

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

/// Without estimatorVars.m: no other file has its filters, and its comments name their signals.
std::vector<FileContent> written_again(const fs::path& /*directory*/, const Manifest& manifest,
                                       const Vehicle& vehicle) {
  ExportContent content;
  content.vehicle = vehicle;
  content.gains = manifest.gains;
  content.cascade = manifest.cascade;
  std::vector<FileContent> files = mambo_files(content);
  std::erase_if(files, [](const FileContent& file) { return file.name == kEstimatorVars; });
  return files;
}

/// The filters with the numbers of estimatorVars.m, which does not name signals.
std::vector<KalmanFilter> filters_of(const fs::path& directory) {
  const fs::path path = directory / kEstimatorVars;
  const std::vector<NamedMatrix> all = parse_m_file(export_text(path), path.string());
  const auto find = [&](const std::string& name) {
    return std::find_if(all.begin(), all.end(),
                        [&](const NamedMatrix& number) { return number.name == name; });
  };
  std::vector<KalmanFilter> filters;
  for (const auto& [name, prefix] : {std::pair("altitude", "Estimator.alt.kf."),
                                     std::pair("velocity", "Estimator.pos.kfVelo.")}) {
    if (find(std::string(prefix) + "L") == all.end()) continue;
    const auto matrix = [&, prefix = std::string(prefix)](const char* key) -> Eigen::MatrixXd {
      const auto at = find(prefix + key);
      if (at == all.end()) throw InvalidInput(path.string(), "has no " + prefix + key);
      return at->value;
    };
    KalmanFilter filter;
    filter.name = name;
    const Eigen::MatrixXd dt = matrix("Ts");
    if (dt.size() != 1)
      throw InvalidInput(path.string(), std::string(prefix) + "Ts is not a number");
    filter.model.dt = dt(0, 0);
    each_matrix(filter, [&](const char* key, Eigen::MatrixXd& M) { M = matrix(key); });
    filters.push_back(std::move(filter));
  }
  return filters;
}

}  // namespace

Exporter mambo_exporter() {
  Exporter exporter;
  exporter.target = export_target("mambo", "exporter");
  exporter.convention = "mambo";
  exporter.gain_files = {"vehicleVars.m", kControllerVars, kEstimatorVars};
  exporter.always_has_cascade = true;
  exporter.files = mambo_files;
  exporter.numbers = [](const FileContent& file) { return parse_m_file(file.bytes, file.name); };
  exporter.read = read;
  exporter.read_plain = read_plain;
  exporter.written_again = written_again;
  exporter.filters = filters_of;
  return exporter;
}

}  // namespace quadtune::exports
