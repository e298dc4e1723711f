// SPDX-License-Identifier: Apache-2.0
/// The page around a report's data: one HTML file that loads nothing.
#pragma once

#include <string>
#include <string_view>
#include <utility>
#include <vector>

namespace quadtune::report {

enum class ReportVerdict { none, pass, fail };

/// "pass", "fail" or "none", as the page's scripts read it.
[[nodiscard]] std::string verdict_text(ReportVerdict verdict);

/// Parts of a page, by their names below page/assets.
struct ReportPage {
  std::string title = {};  ///< any bytes
  /// Scripts of others with their licences.
  std::vector<std::pair<std::string_view, std::string_view>> libraries = {};
  std::vector<std::string_view> scripts = {};  ///< run as one, in this order
  std::string data = {};                       ///< as script_json() gives it
};

/// The file's bytes. A content security policy in it allows its own scripts and style alone, by
/// their hashes.
[[nodiscard]] std::string page_html(const ReportPage& page);

}  // namespace quadtune::report
