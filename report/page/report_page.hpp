// SPDX-License-Identifier: Apache-2.0
/// The HTML file around the data of a report. It loads nothing.
#pragma once

#include <string>
#include <string_view>
#include <utility>
#include <vector>

namespace quadtune::report {

enum class ReportVerdict { none, pass, fail };

/// "pass", "fail" or "none", as the page's scripts read it.
[[nodiscard]] std::string verdict_text(ReportVerdict verdict);

/// The parts of a page, by their names below page/assets.
struct ReportPage {
  std::string title = {};  ///< any bytes
  /// Third-party scripts and their licences.
  std::vector<std::pair<std::string_view, std::string_view>> libraries = {};
  std::vector<std::string_view> scripts = {};  ///< concatenated in this order
  std::string data = {};                       ///< the result of script_json()
};

/// The bytes of the file. Its content security policy allows only its own scripts and style, by
/// their hashes.
[[nodiscard]] std::string page_html(const ReportPage& page);

}  // namespace quadtune::report
