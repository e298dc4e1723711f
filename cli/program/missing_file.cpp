// SPDX-License-Identifier: Apache-2.0
#include "program/missing_file.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cerrno>
#include <cstring>
#include <filesystem>
#include <vector>

#include "program/command_line.hpp"
#include "quadtune/errors.hpp"
#include "quadtune/estimation/filter_file.hpp"
#include "quadtune/internal/joined.hpp"
#include "quadtune/internal/suggest.hpp"
#include "quadtune/internal/text_file.hpp"
#include "quadtune/model/vehicle.hpp"
#include "quadtune/simulation/mission.hpp"

namespace quadtune::cli {
namespace {

namespace fs = std::filesystem;

/// The option that gave the path, or the folder in which it lies.
const Option* option_of(const std::string& path, const CommandLine& line) {
  for (const Option* option : line.options())
    for (const std::string& value : option->values())
      if (value == path || path.starts_with(value + "/")) return option;
  return nullptr;
}

std::vector<std::string> built_in_names(const std::string& description) {
  if (description.find("built-in") == std::string::npos) return {};
  if (description.find("mission") != std::string::npos) return built_in_missions();
  if (description.find("vehicle") != std::string::npos) return built_in_vehicles();
  std::vector<std::string> names;
  for (const FilterModelTitle& title : built_in_filter_models()) names.push_back(title.name);
  return names;
}

/// ": vehicles has mambo.toml, uquad.toml and 3 more", the nearest names first.
std::string what_is_there(const fs::path& path) {
  constexpr std::size_t kLooked = 10000, kNamed = 4;
  std::error_code error;
  fs::path folder = path.has_filename() ? path.parent_path() : path.parent_path().parent_path();
  const fs::path wanted = path.has_filename() ? path.filename() : path.parent_path().filename();
  if (folder.empty()) folder = ".";
  if (!fs::exists(folder, error))
    return fmt::format("; there is no folder {}", internal::printable(folder.string(), 200));
  struct Entry {
    bool other_kind;
    std::size_t distance;
    std::string name;
    auto operator<=>(const Entry&) const = default;
  };
  std::vector<Entry> entries;
  for (fs::directory_iterator entry(folder, error), end;
       !error && entry != end && entries.size() < kLooked; entry.increment(error)) {
    const std::string name = entry->path().filename().string();
    if (name.starts_with('.')) continue;
    entries.push_back({entry->path().extension() != wanted.extension(),
                       name.size() > 255 ? 255 : internal::edit_distance(name, wanted.string()),
                       name});
  }
  if (entries.empty()) return "";
  std::sort(entries.begin(), entries.end());
  // Of another kind they would be noise.
  if (!entries.front().other_kind)
    std::erase_if(entries, [](const Entry& entry) { return entry.other_kind; });
  const std::size_t more = entries.size() > kNamed ? entries.size() - kNamed : 0;
  std::vector<std::string> names;
  for (const Entry& entry : entries)
    if (names.size() < kNamed) names.push_back(internal::printable(entry.name));
  return fmt::format(
      "; {} has {}{}", folder == "." ? "this folder" : internal::printable(folder.string(), 100),
      internal::joined(names, ", "), more > 0 ? fmt::format(" and {} more", more) : "");
}

}  // namespace

bool is_missing(const FileError& error) {
  return std::string(error.what()) == error.path() + ": " + std::strerror(ENOENT);
}

FileError told_missing(const FileError& error, const CommandLine& line) {
  std::string message = std::strerror(ENOENT);
  std::vector<std::string> known;
  if (const Option* option = option_of(error.path(), line)) {
    message += fmt::format(", expected for {}: {}", option->name(), option->description());
    known = built_in_names(option->description());
  }
  if (!known.empty()) message += fmt::format("; built in: {}", internal::joined(known, ", "));
  return {error.path(), message + what_is_there(error.path())};
}

}  // namespace quadtune::cli
