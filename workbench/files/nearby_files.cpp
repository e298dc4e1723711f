// SPDX-License-Identifier: Apache-2.0
#include "quadtune/workbench/files/nearby_files.hpp"

#include <algorithm>
#include <compare>
#include <system_error>

#include "quadtune/internal/suggest.hpp"

namespace quadtune {

namespace fs = std::filesystem;

NearbyFiles nearby_files(const fs::path& path, std::size_t max) {
  constexpr std::size_t kLooked = 10000;
  std::error_code error;
  NearbyFiles nearby;
  nearby.folder = path.has_filename() ? path.parent_path() : path.parent_path().parent_path();
  const fs::path wanted = path.has_filename() ? path.filename() : path.parent_path().filename();
  if (nearby.folder.empty()) nearby.folder = ".";
  nearby.exists = fs::exists(nearby.folder, error);
  if (!nearby.exists) return nearby;
  struct Entry {
    bool other_kind;
    std::size_t distance;
    std::string name;
    auto operator<=>(const Entry&) const = default;
  };
  // A word without an extension may be the name of a directory, or of a file whose extension was
  // forgotten.
  const auto is_wanted = [&](const fs::path& name) {
    return wanted.extension().empty() && name.stem() == wanted;
  };
  std::vector<Entry> entries;
  for (fs::directory_iterator entry(nearby.folder, error), end;
       !error && entry != end && entries.size() < kLooked; entry.increment(error)) {
    const std::string name = entry->path().filename().string();
    if (name.starts_with('.')) continue;
    if (is_wanted(name)) {
      entries.push_back({false, 0, name});
      continue;
    }
    entries.push_back({entry->path().extension() != wanted.extension(),
                       name.size() > 255 ? 255 : internal::edit_distance(name, wanted.string()),
                       name});
  }
  std::sort(entries.begin(), entries.end());
  // Names of another kind would only distract.
  if (!entries.empty() && !entries.front().other_kind)
    std::erase_if(entries, [](const Entry& entry) { return entry.other_kind; });
  nearby.more = entries.size() > max ? entries.size() - max : 0;
  for (std::size_t i = 0; i + nearby.more < entries.size(); ++i)
    nearby.names.push_back(entries[i].name);
  return nearby;
}

}  // namespace quadtune
