// SPDX-License-Identifier: Apache-2.0
#include "quadtune/logs/flight_log.hpp"

#include <fmt/format.h>

#include <filesystem>
#include <string_view>
#include <unordered_set>

#include "logs/formats/unicode.hpp"
#include "logs/log_checks.hpp"
#include "quadtune/errors.hpp"
#include "quadtune/internal/counted.hpp"
#include "quadtune/internal/text_file.hpp"

namespace quadtune {
namespace {

constexpr std::string_view kCsv = ".csv";
constexpr std::string_view kMat = ".mat";

bool is_mat(const std::string& path) { return std::filesystem::path(path).extension() == kMat; }

}  // namespace

void require_log_name(const std::string& path, const std::string& where) {
  const std::filesystem::path extension = std::filesystem::path(path).extension();
  if (extension != kCsv && extension != kMat)
    throw InvalidInput(
        where, fmt::format("cannot tell the log format from '{}': use a file name that ends in {} "
                           "or {}",
                           internal::printable(path), kCsv, kMat));
}

std::string log_bytes(const LogTable& table, const std::string& path) {
  require_log_name(path, "log");
  return is_mat(path) ? bytes_of_mat(table) : csv_of(table);
}

LogTable read_log(const std::string& path) {
  require_log_name(path, "log");
  const std::string bytes = internal::read_file(path, kLogLimit);
  return is_mat(path) ? table_of_mat(bytes, path) : table_of_csv(bytes, path);
}

namespace internal {

void require_log(const LogTable& table, const std::string& where) {
  const auto require_utf8 = [&](const std::string& text, const char* what) {
    if (!utf16_of(text))
      throw InvalidInput(where, fmt::format("{} '{}' is not valid UTF-8", what, printable(text)));
  };
  std::unordered_set<std::string_view> names;
  for (const LogColumn& column : table.columns) {
    if (column.name.empty())
      throw InvalidInput(where,
                         "a column has no name; expected one because columns are accessed by name");
    require_utf8(column.name, "the name");
    require_utf8(column.unit, "the unit");
    if (!names.insert(column.name).second)
      throw InvalidInput(where,
                         fmt::format("column name '{}' appears twice, expected distinct names",
                                     printable(column.name)));
    if (column.values.size() != table.rows())
      throw InvalidInput(
          where, fmt::format("column '{}' has {}, expected {} as '{}' has", printable(column.name),
                             counted(column.values.size(), "row"), table.rows(),
                             printable(table.columns.front().name)));
  }
  for (const auto& [key, value] : table.about) {
    require_utf8(key, "the key");
    require_utf8(value, "the value");
  }
  for (const LogEvent& event : table.events) {
    require_utf8(event.name, "the event");
    require_utf8(event.detail, "the detail");
  }
}

}  // namespace internal
}  // namespace quadtune
