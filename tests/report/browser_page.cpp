// SPDX-License-Identifier: Apache-2.0
#include "browser_page.hpp"

#include <fmt/format.h>

#include <nlohmann/json.hpp>
#include <regex>

namespace quadtune::testing {

nlohmann::json data_of(const std::string& page) {
  const std::string open = "<script type=\"application/json\" id=\"data\">";
  const std::size_t start = page.find(open) + open.size();
  return nlohmann::json::parse(page.substr(start, page.find("</script>", start) - start));
}

std::string root_data(const std::string& page, const std::string& name) {
  const std::string root = page.substr(0, page.find("<head"));
  std::smatch match;
  const std::regex attribute("data-" + name + "=\"([^\"]*)\"");
  return std::regex_search(root, match, attribute) ? match[1].str() : "(none)";
}

std::string with_script(const std::string& html, const std::string& script) {
  static const std::string kPolicy = "<meta http-equiv=\"Content-Security-Policy\"";
  std::string page = html;
  const std::size_t start = page.find(kPolicy);
  page.erase(start, page.find('>', start) + 1 - start);
  const std::string body_end = "</body>";
  page.insert(page.rfind(body_end), "<script>setTimeout(() => {" + script + "}, 500);</script>");
  return page;
}

std::set<std::string> requests(const std::string& log) {
  std::set<std::string> urls;
  const nlohmann::json all = nlohmann::json::parse(log);
  for (const auto& event : all.at("events")) {
    if (!event.contains("params") || !event["params"].contains("url")) continue;
    const auto& params = event["params"];
    if (params.value("initiator", "not an origin") != "not an origin")
      urls.insert(params["url"].get<std::string>());
  }
  return urls;
}

std::string in_frame(const std::string& name, int width, int height) {
  return fmt::format(
      "<!DOCTYPE html><body style='margin:0'><iframe src='{}' style='width:{}px;height:{}px;"
      "border:0'></iframe><script>addEventListener('message', (e) => "
      "{{ document.documentElement.dataset.inside = e.data; }});</script></body>",
      name, width, height);
}

}  // namespace quadtune::testing
