// SPDX-License-Identifier: Apache-2.0
#include "report/gains/verify_report.hpp"

#include <fmt/format.h>

#include "quadtune/internal/json.hpp"

namespace quadtune::report {

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
