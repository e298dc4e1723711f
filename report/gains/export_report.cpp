// SPDX-License-Identifier: Apache-2.0
#include <fmt/format.h>

#include "quadtune/exports/manifest.hpp"
#include "quadtune/exports/verify.hpp"
#include "quadtune/internal/json.hpp"
#include "report/gains/gains.hpp"

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

internal::Json to_json(const VerifyReport& report) {
  internal::Json checks = internal::Json::array();
  for (const VerifyCheck& check : report.checks)
    checks.push_back({{"name", check.name}, {"ok", check.ok}, {"detail", check.detail}});
  return {{"checks", checks}, {"verdict", report.ok() ? "pass" : "fail"}};
}

std::string to_text(const VerifyReport& report) {
  std::string text;
  for (const VerifyCheck& check : report.checks)
    text += fmt::format("{}{} {}: {}", text.empty() ? "" : "\n", check.ok ? "ok  " : "FAIL",
                        check.name, check.detail);
  return text;
}

}  // namespace quadtune::report
