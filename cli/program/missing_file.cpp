// SPDX-License-Identifier: Apache-2.0
#include "program/missing_file.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cerrno>
#include <cstring>

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

bool has_article(const std::string& words) {
  return words.starts_with("a ") || words.starts_with("an ") || words.starts_with("the ");
}

/// Whether the path is that of a file or directory to write, a folder above it or a file below it.
bool is_output(const std::string& path, const CommandLine& line,
               const std::vector<std::string>& outputs) {
  bool found = false;
  for (const Option* option : line.options()) {
    const bool writes = std::find(outputs.begin(), outputs.end(), option->name()) != outputs.end();
    for (const std::string& value : option->values()) {
      if (!writes && value == path) return false;
      found = found || (writes && (value == path || path.starts_with(value + "/") ||
                                   value.starts_with(path + "/")));
    }
  }
  return found;
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

FileError told_missing(const FileError& error, const CommandLine& line,
                       const std::vector<std::string>& outputs) {
  if (is_output(error.path(), line, outputs)) return error;
  std::string message = std::strerror(ENOENT);
  std::vector<std::string> known;
  if (const Option* option = option_of(error.path(), line)) {
    std::string kind = option->description();
    kind.erase(std::min(kind.find("; "), kind.size()));  // what it is in another use, its default
    // "compute weights that give this gain: an export" expects what follows the colon.
    if (const std::size_t colon = kind.find(": ");
        colon != std::string::npos && has_article(kind.substr(colon + 2)))
      kind.erase(0, colon + 2);
    message += has_article(kind)
                   ? fmt::format(", expected {} ({})", kind, option->name())
                   : fmt::format(", expected the file of {}: {}", option->name(), kind);
    known = built_in_names(option->description());
  }
  if (!known.empty()) message += fmt::format("; built in: {}", internal::joined(known, ", "));
  return {error.path(), message + what_is_there(error.path())};
}

}  // namespace quadtune::cli
