// SPDX-License-Identifier: Apache-2.0
#include "program/missing_file.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cerrno>
#include <cstring>
#include <vector>

#include "program/command_line.hpp"
#include "program/completion.hpp"
#include "quadtune/errors.hpp"
#include "quadtune/internal/joined.hpp"
#include "quadtune/internal/text_file.hpp"
#include "quadtune/workbench/files/nearby_files.hpp"

namespace quadtune::cli {
namespace {

/// The option whose value is the path or a folder that contains it.
const Option* option_of(const std::string& path, const CommandLine& line) {
  for (const Option* option : line.options())
    for (const std::string& value : option->values())
      if (value == path || path.starts_with(value + "/")) return option;
  return nullptr;
}

/// "; vehicles has mambo.toml, uquad.toml and 3 more", the most similar names first.
std::string what_is_there(const std::string& path) {
  const NearbyFiles nearby = nearby_files(path, 4);
  const std::string folder = nearby.folder.string();
  if (!nearby.exists)
    return fmt::format("; there is no folder {}", internal::printable(folder, 200));
  if (nearby.names.empty()) return "";
  std::vector<std::string> names;
  for (const std::string& name : nearby.names) names.push_back(internal::printable(name));
  return fmt::format("; {} has {}{}",
                     folder == "." ? "this folder" : internal::printable(folder, 100),
                     internal::joined(names, ", "),
                     nearby.more > 0 ? fmt::format(" and {} more", nearby.more) : "");
}

}  // namespace

bool is_missing(const FileError& error) {
  return std::string(error.what()) == error.path() + ": " + std::strerror(ENOENT);
}

FileError told_missing(const FileError& error, const CommandLine& line) {
  std::string message = std::strerror(ENOENT);
  std::vector<std::string> known;
  if (const Option* option = option_of(error.path(), line)) {
    // "with V: an export" is an export here.
    std::string kind = option->description();
    if (const std::size_t colon = kind.find(": ");
        kind.starts_with("with ") && colon != std::string::npos)
      kind.erase(0, colon + 2);
    kind.erase(std::min(kind.find("; with "), kind.size()));  // what it is in another use
    const bool is_noun =
        kind.starts_with("a ") || kind.starts_with("an ") || kind.starts_with("the ");
    message += is_noun ? fmt::format(", expected {} ({})", kind, option->name())
                       : fmt::format(", expected for {}: {}", option->name(), kind);
    known = built_in_names(option->description());
  }
  if (!known.empty()) message += fmt::format("; built in: {}", internal::joined(known, ", "));
  return {error.path(), message + what_is_there(error.path())};
}

}  // namespace quadtune::cli
