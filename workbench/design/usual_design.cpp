// SPDX-License-Identifier: Apache-2.0
#include "quadtune/workbench/design/usual_design.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <filesystem>
#include <vector>

#include "quadtune/workbench/files/file_kind.hpp"

namespace quadtune {
namespace {

/// A basic string of TOML.
std::string quoted(const std::string& text) {
  std::string out = "\"";
  for (const char c : text) {
    if (c == '"' || c == '\\') out += '\\';
    out += c;
  }
  return out + '"';
}

}  // namespace

Design usual_design(const std::string& vehicle) {
  const std::string name = load_vehicle(vehicle).name;
  const std::filesystem::path path = vehicle;
  return parse_design(
      fmt::format("name = \"{}-flight\"\n"
                  "description = \"PID cascade of {}, designed on the plant that flies\"\n"
                  "vehicle = {}\n\n[cascade]\ndt_s = 0.005\n\n[cascade.design]\n\n"
                  "[[mission]]\nname = \"hover\"\n\n[[mission]]\nname = \"step-north\"\n\n"
                  "[[mission]]\nname = \"take-off-and-land\"\n\n"
                  "[[export]]\nto = \"json\"\n\n[[export]]\nto = \"c\"\n",
                  name, name, quoted(path.filename().string())),
      "the usual design of " + vehicle, path.parent_path());
}

bool names_vehicle(const std::string& word) {
  if (file_kind(word) == FileKind::vehicle) return true;
  const std::vector<std::string> known = built_in_vehicles();
  std::error_code ignored;
  return std::find(known.begin(), known.end(), word) != known.end() &&
         !std::filesystem::exists(word, ignored);
}

}  // namespace quadtune
