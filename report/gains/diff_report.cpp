// SPDX-License-Identifier: Apache-2.0
#include <fmt/format.h>

#include <algorithm>

#include "quadtune/exports/diff.hpp"
#include "quadtune/internal/json.hpp"
#include "report/gains/gains.hpp"
#include "report/text/rows.hpp"

namespace quadtune::report {
namespace {

using internal::Json;

/// @param most  maximum number of entries; those that differ most come first
Json entries_json(const GainsDiff& difference, std::size_t max) {
  Json entries = Json::array();
  for (std::size_t i = 0; i < std::min(max, difference.entries.size()); ++i) {
    const DiffEntry& entry = difference.entries[i];
    entries.push_back({{"matrix", entry.matrix},
                       {"input", entry.input},
                       {"state", entry.state},
                       {"a", entry.a},
                       {"b", entry.b},
                       {"difference", entry.difference},
                       {"relative", entry.relative}});
  }
  return entries;
}

}  // namespace

Json to_json(const GainsDiff& difference) {
  return {{"max_relative", difference.max_relative},
          {"entries", entries_json(difference, difference.entries.size())}};
}

std::string to_text(const GainsDiff& difference) {
  if (difference.entries.empty()) return "equal in every entry\n";
  constexpr std::size_t kShown = 20;
  std::string text = fmt::format(
      "{} entries differ, by at most {:.3g} (relative to the largest of their row or column)\n{}\n",
      difference.entries.size(), difference.max_relative,
      table(entries_json(difference, kShown), {{"matrix", "matrix"},
                                               {"input", "input"},
                                               {"state", "state"},
                                               {"a", "A", "", ".8g"},
                                               {"b", "B", "", ".8g"},
                                               {"difference", "B - A", "", ".2g"},
                                               {"relative", "relative", "", ".2g"}}));
  if (difference.entries.size() > kShown)
    text += fmt::format("... and {} smaller ones; --json lists them all\n",
                        difference.entries.size() - kShown);
  return text;
}

}  // namespace quadtune::report
