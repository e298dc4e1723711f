// SPDX-License-Identifier: Apache-2.0
#include <fmt/format.h>

#include <algorithm>
#include <cstdint>
#include <string>
#include <vector>

#include "logs/formats/unicode.hpp"
#include "logs/log_checks.hpp"
#include "logs/mat/mat_array.hpp"
#include "logs/mat/mat_fields.hpp"
#include "quadtune/errors.hpp"
#include "quadtune/logs/flight_log.hpp"

namespace quadtune {
namespace {

using internal::FieldLayout;
using internal::FieldTree;
using internal::MatClass;
using internal::MatType;

void append(std::string& bytes, const void* data, std::size_t size) {
  bytes.append(static_cast<const char*>(data), size);
}

std::string tag(MatType type, std::size_t size) {
  std::string bytes;
  const auto length = static_cast<std::uint32_t>(size);
  append(bytes, &type, sizeof type);
  append(bytes, &length, sizeof length);
  return bytes;
}

template <typename Numbers>  // a vector or a string
std::string element(MatType type, const Numbers& numbers) {
  const std::size_t size = numbers.size() * sizeof numbers[0];
  std::string bytes = tag(type, size);
  append(bytes, numbers.data(), size);
  bytes.resize((bytes.size() + 7) / 8 * 8, '\0');
  return bytes;
}

// @param content  Its elements behind the name.
std::string array(MatClass kind, std::size_t rows, std::size_t columns, const std::string& content,
                  const std::string& name = "") {
  const std::vector<std::uint32_t> flags = {static_cast<std::uint32_t>(kind), 0};
  const std::vector<std::int32_t> size = {static_cast<std::int32_t>(rows),
                                          static_cast<std::int32_t>(columns)};
  const std::string head = element(MatType::uint32, flags) + element(MatType::int32, size) +
                           element(MatType::int8, name);
  return tag(MatType::matrix, head.size() + content.size()) + head + content;
}

std::string numbers(const std::vector<double>& values) {
  return array(MatClass::float64, values.size(), 1, element(MatType::float64, values));
}

std::string number(double value) { return numbers({value}); }

std::string text(const std::string& utf8) {
  const std::u16string units = internal::utf16_of(utf8).value();
  return array(MatClass::text, units.empty() ? 0 : 1, units.size(), element(MatType::utf16, units));
}

std::string cells(const std::vector<std::string>& texts) {
  std::string parts;
  for (const std::string& one : texts) parts += text(one);
  return array(MatClass::cell, texts.size(), 1, parts);
}

// A struct, or a column of them.
// @param values  All fields of the first one, then those of the second one, …
std::string structs(const std::vector<std::string>& fields, const std::string& values,
                    std::size_t rows = 1, const std::string& name = "") {
  std::size_t slot = 1;  // of a name with its NUL, so that all of them fill whole eight bytes
  for (const std::string& field : fields) slot = std::max(slot, field.size() + 1);
  while (slot * fields.size() % 8 != 0) ++slot;
  std::string names;
  for (const std::string& field : fields) {
    names += field;
    names.append(slot - field.size(), '\0');
  }
  std::string content;
  const std::uint32_t small_tag =
      sizeof(std::int32_t) << 16U | static_cast<std::uint32_t>(MatType::int32);
  const auto length = static_cast<std::int32_t>(slot);
  append(content, &small_tag, sizeof small_tag);
  append(content, &length, sizeof length);
  content += element(MatType::int8, names);
  content += values;
  return array(MatClass::structure, rows, 1, content, name);
}

std::vector<std::string> fields_of(const FieldTree& tree) {
  std::vector<std::string> names;
  for (const FieldTree& field : tree.fields) names.push_back(field.field);
  return names;
}

// The struct of the tree with what `leaf` makes of each column.
template <typename Leaf>
std::string filled(const FieldTree& tree, const Leaf& leaf) {
  if (tree.column >= 0) return leaf(static_cast<std::size_t>(tree.column));
  std::string values;
  for (const FieldTree& field : tree.fields) values += filled(field, leaf);
  return structs(fields_of(tree), values);
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
    values += text(value);
  }
  return structs(fields, values);
}

std::vector<std::string> keys_of(const LogTable& table) {
  std::vector<std::string> keys;
  for (const auto& [key, value] : table.about) keys.push_back(key);
  return keys;
}

std::string columns_of(const LogTable& table, const FieldLayout& layout) {
  std::string values;
  for (std::size_t i = 0; i < table.columns.size(); ++i)
    values += text(table.columns[i].name) + text(table.columns[i].unit) + text(layout.paths[i]);
  return structs({"name", "unit", "field"}, values, table.columns.size());
}

std::string events_of(const LogTable& table) {
  std::string values;
  for (const LogEvent& event : table.events)
    values += number(event.time) + text(event.name) + text(event.detail);
  return structs({"time", "name", "detail"}, values, table.events.size());
}

std::string variable_of(const LogTable& table) {
  // What a log has beside its columns; a column of such a name gets another field.
  std::vector<std::string> fields = {"format", "format_version", "about", "about_keys",
                                     "units",  "columns",        "events"};
  const FieldLayout layout = internal::layout_of(names_of(table), fields);
  for (const std::string& field : fields_of(layout.root)) fields.push_back(field);
  std::string values = text(internal::kMatFormat) + number(internal::kMatVersion) +
                       about_of(table) + cells(keys_of(table));
  values += filled(layout.root, [&](std::size_t i) { return text(table.columns[i].unit); });
  values += columns_of(table, layout) + events_of(table);
  for (const FieldTree& field : layout.root.fields)
    values += filled(field, [&](std::size_t i) { return numbers(table.columns[i].values); });
  return structs(fields, values, 1, internal::kMatVariable);
}

// No less than the file will have [bytes]: a text stands there up to three times in UTF-16, and
// each array has a few hundred bytes of its own.
std::size_t most_bytes(const LogTable& table) {
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
  if (most_bytes(table) >= kLogLimit)
    throw InvalidInput("log", fmt::format("has {} rows of {} columns and {} events, expected less "
                                          "than 2 GiB in all, as MAT v5 files hold no more: write "
                                          "a .csv",
                                          table.rows(), table.columns.size(), table.events.size()));
  std::string bytes = "MATLAB 5.0 MAT-file, quadtune log";  // no date: same log, same bytes
  bytes.resize(34, '\0');
  bytes.resize(124, ' ');
  const std::uint16_t version = 0x0100;
  const std::uint16_t byte_order = 0x4d49;
  append(bytes, &version, sizeof version);
  append(bytes, &byte_order, sizeof byte_order);
  return bytes + variable_of(table);
}

}  // namespace quadtune
