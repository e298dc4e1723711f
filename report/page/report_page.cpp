// SPDX-License-Identifier: Apache-2.0
#include "report/page/report_page.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <stdexcept>

#include "report/page/assets.hpp"
#include "report/page/page_text.hpp"

namespace quadtune::report {
namespace {

std::string asset(std::string_view name) {
  for (const Asset& file : assets())
    if (file.name == name) return std::string(file.text);
  throw std::logic_error(fmt::format("report: no asset {}", name));
}

/// The template with each {{name}} replaced. Inserted text is not searched again.
std::string filled(std::string_view page,
                   const std::vector<std::pair<std::string, std::string>>& parts) {
  std::string result;
  while (true) {
    const std::size_t open = page.find("{{");
    result += page.substr(0, open);
    if (open == std::string_view::npos) return result;
    const std::size_t close = page.find("}}", open);
    const std::string_view name = page.substr(open + 2, close - open - 2);
    const auto part =
        std::find_if(parts.begin(), parts.end(), [&](const auto& p) { return p.first == name; });
    if (part == parts.end()) throw std::logic_error(fmt::format("template: no part {}", name));
    result += part->second;
    page.remove_prefix(close + 2);
  }
}

}  // namespace

std::string verdict_text(ReportVerdict verdict) {
  if (verdict == ReportVerdict::pass) return "pass";
  return verdict == ReportVerdict::fail ? "fail" : "none";
}

std::string page_html(const ReportPage& page) {
  const std::string style = asset("vendor/uplot.min.css") + "\n" + asset("report.css");
  std::string hashes, libraries, licences;
  for (const auto& [file, licence] : page.libraries) {
    const std::string text = asset(file);
    hashes += policy_hash(text) + " ";
    libraries += fmt::format("<script>{}</script>\n", text);
    licences += "\n" + asset(licence);
  }
  std::string script;
  for (const std::string_view name : page.scripts) script += asset(name);
  const std::string policy = fmt::format(
      "default-src 'none'; script-src {}{}; style-src {}; img-src data:; base-uri 'none'; "
      "form-action 'none'",
      hashes, policy_hash(script), policy_hash(style));
  return filled(asset("template.html"), {{"policy", policy},
                                         {"title", html_text(page.title)},
                                         {"style", style},
                                         {"licences", licences},
                                         {"data", page.data},
                                         {"libraries", libraries},
                                         {"script", script}});
}

}  // namespace quadtune::report
