// SPDX-License-Identifier: Apache-2.0
#include "report/gains/diff_report.hpp"

#include <fmt/format.h>

#include <algorithm>

#include "quadtune/internal/json.hpp"
#include "report/text/text_table.hpp"

namespace quadtune::report {

internal::Json to_json(const GainsDiff& difference) {
  internal::Json entries = internal::Json::array();
  for (const DiffEntry& entry : difference.entries)
    entries.push_back({{"matrix", entry.matrix},
                       {"input", entry.input},
                       {"state", entry.state},
                       {"a", internal::finite_or_null(entry.a)},
                       {"b", internal::finite_or_null(entry.b)},
                       {"difference", internal::finite_or_null(entry.difference)},
                       {"relative", entry.relative}});
  return {{"max_relative", difference.max_relative}, {"entries", entries}};
}

std::string to_text(const GainsDiff& difference) {
  if (difference.entries.empty()) return "equal in every entry\n";
  std::size_t width = 7;  // of the first two columns; the names of a cascade's numbers are longer
  for (const DiffEntry& entry : difference.entries)
    width = std::max({width, entry.matrix.size(), entry.input.size()});
  ++width;
  TextTable table({{"matrix", width, TextColumn::Side::left},
                   {"input", width, TextColumn::Side::left},
                   {"state", 10, TextColumn::Side::left},
                   {"A", 16},
                   {"B", 16},
                   {"B - A", 12},
                   {"relative", 10}});
  constexpr std::size_t kShown = 20;
  for (std::size_t i = 0; i < std::min(kShown, difference.entries.size()); ++i) {
    const DiffEntry& entry = difference.entries[i];
    table.row({entry.matrix, entry.input, entry.state, fmt::format("{:.8g}", entry.a),
               fmt::format("{:.8g}", entry.b), fmt::format("{:.2g}", entry.difference),
               fmt::format("{:.2g}", entry.relative)});
  }
  std::string text = fmt::format(
      "{} entries differ, by {:.3g} at most (relative to their row's or column's largest)\n{}\n",
      difference.entries.size(), difference.max_relative, table.text());
  if (difference.entries.size() > kShown)
    text += fmt::format("... and {} smaller ones; --json lists them all\n",
                        difference.entries.size() - kShown);
  return text;
}

}  // namespace quadtune::report
