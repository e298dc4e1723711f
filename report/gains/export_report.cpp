// SPDX-License-Identifier: Apache-2.0
#include "report/gains/export_report.hpp"

#include <fmt/format.h>

#include "quadtune/internal/json.hpp"

namespace quadtune::report {

internal::Json to_json(const std::vector<ManifestFile>& files) {
  internal::Json json = internal::Json::array();
  for (const ManifestFile& file : files)
    json.push_back({{"path", file.path}, {"sha256", file.sha256}});
  return json;
}

std::string to_text(const std::vector<ManifestFile>& files, const std::string& directory) {
  std::string text;
  for (const ManifestFile& file : files)
    text += fmt::format("{}  {}/{}\n", file.sha256, directory, file.path);
  return text;
}

}  // namespace quadtune::report
