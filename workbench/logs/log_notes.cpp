// SPDX-License-Identifier: Apache-2.0
#include "quadtune/workbench/logs/log_notes.hpp"

#include <fmt/format.h>

#include "quadtune/internal/text_file.hpp"

namespace quadtune {

std::vector<std::string> log_warnings(const LogCondition& condition) {
  std::vector<std::string> lines;
  if (!condition.torn.empty()) lines.push_back("partial: " + condition.torn);
  if (condition.skipped > 0)
    lines.push_back(fmt::format("{} {} skipped, the first: {}", condition.skipped,
                                condition.skipped == 1 ? "record" : "records",
                                condition.first_skipped));
  if (condition.dropouts > 0)
    lines.push_back(fmt::format("the logger itself lost records {} {}, {:.4g} s in total",
                                condition.dropouts, condition.dropouts == 1 ? "time" : "times",
                                condition.dropout_s));
  lines.insert(lines.end(), condition.notes.begin(), condition.notes.end());
  return lines;
}

std::vector<std::string> noted_log_warnings(const LogCondition& condition, const std::string& file,
                                            const LogNote& note) {
  std::vector<std::string> lines = log_warnings(condition);
  for (std::string& line : lines) {
    const std::string start = internal::printable(file) + ": ";
    if (!line.starts_with(start)) line.insert(0, start);
    if (note) note("warning: " + line);
  }
  return lines;
}

}  // namespace quadtune
