// SPDX-License-Identifier: Apache-2.0
#include <fmt/format.h>

#include <string>
#include <vector>

#include "logs/log_checks.hpp"
#include "logs/mat/mat_array.hpp"
#include "logs/mat/mat_fields.hpp"
#include "quadtune/errors.hpp"
#include "quadtune/internal/mat_values.hpp"
#include "quadtune/logs/flight_log.hpp"

namespace quadtune {
namespace {

using internal::FieldLayout;
using internal::FieldTree;

std::string numbers(const std::vector<double>& values) {
  return internal::mat_matrix(
      Eigen::Map<const Eigen::VectorXd>(values.data(), static_cast<Eigen::Index>(values.size())));
}

std::string number(double value) { return numbers({value}); }

std::vector<std::string> fields_of(const FieldTree& tree) {
  std::vector<std::string> names;
  for (const FieldTree& field : tree.fields) names.push_back(field.field);
  return names;
}

// The struct of the tree; `leaf` converts each column.
template <typename Leaf>
std::string filled(const FieldTree& tree, const Leaf& leaf) {
  if (tree.column >= 0) return leaf(static_cast<std::size_t>(tree.column));
  std::string values;
  for (const FieldTree& field : tree.fields) values += filled(field, leaf);
  return internal::mat_structs(fields_of(tree), values);
}

std::vector<std::string> names_of(const LogTable& table) {
  std::vector<std::string> names;
  for (const LogColumn& column : table.columns) names.push_back(column.name);
  return names;
}

std::string about_of(const LogTable& table) {
  internal::FieldNames names;
  std::vector<std::string> fields;
  std::string values;
  for (const auto& [key, value] : table.about) {
    fields.push_back(names.add(key));
    values += internal::mat_text(value);
  }
  return internal::mat_structs(fields, values);
}

std::vector<std::string> keys_of(const LogTable& table) {
  std::vector<std::string> keys;
  for (const auto& [key, value] : table.about) keys.push_back(key);
  return keys;
}

std::string columns_of(const LogTable& table, const FieldLayout& layout) {
  std::string values;
  for (std::size_t i = 0; i < table.columns.size(); ++i)
    values += internal::mat_text(table.columns[i].name) +
              internal::mat_text(table.columns[i].unit) + internal::mat_text(layout.paths[i]);
  return internal::mat_structs({"name", "unit", "field"}, values, table.columns.size());
}

std::string events_of(const LogTable& table) {
  std::string values;
  for (const LogEvent& event : table.events)
    values +=
        number(event.time) + internal::mat_text(event.name) + internal::mat_text(event.detail);
  return internal::mat_structs({"time", "name", "detail"}, values, table.events.size());
}

std::string variable_of(const LogTable& table) {
  // Fields of a log that are not columns; a column of such a name gets a different field name.
  std::vector<std::string> fields = {"format", "format_version", "about", "about_keys",
                                     "units",  "columns",        "events"};
  const FieldLayout layout = internal::layout_of(names_of(table), fields);
  for (const std::string& field : fields_of(layout.root)) fields.push_back(field);
  std::string values = internal::mat_text(internal::kMatFormat) + number(internal::kMatVersion) +
                       about_of(table) + internal::mat_cells(keys_of(table));
  values +=
      filled(layout.root, [&](std::size_t i) { return internal::mat_text(table.columns[i].unit); });
  values += columns_of(table, layout) + events_of(table);
  for (const FieldTree& field : layout.root.fields)
    values += filled(field, [&](std::size_t i) { return numbers(table.columns[i].values); });
  return internal::mat_structs(fields, values, 1, internal::kMatVariable);
}

// An upper bound of the file size [bytes]: a text appears up to three times in UTF-16, and each
// array needs a few hundred bytes in addition.
std::size_t max_bytes(const LogTable& table) {
  constexpr std::size_t kOwn = 2048;
  std::size_t texts = 0;
  for (const LogColumn& column : table.columns) texts += column.name.size() + column.unit.size();
  for (const auto& [key, value] : table.about) texts += key.size() + value.size();
  for (const LogEvent& event : table.events) texts += event.name.size() + event.detail.size();
  return sizeof(double) * table.rows() * table.columns.size() + 6 * texts +
         kOwn * (1 + table.columns.size() + table.about.size() + table.events.size());
}

}  // namespace

std::string bytes_of_mat(const LogTable& table) {
  internal::require_log(table, "log");
  if (max_bytes(table) >= kLogLimit)
    throw InvalidInput("log", fmt::format("has {} rows of {} columns and {} events, expected less "
                                          "than 2 GiB in all, as MAT v5 files hold no more: write "
                                          "a .csv",
                                          table.rows(), table.columns.size(), table.events.size()));
  // No date, so that the same log gives the same bytes.
  return internal::mat_header("MATLAB 5.0 MAT-file, quadtune log") + variable_of(table);
}

}  // namespace quadtune
