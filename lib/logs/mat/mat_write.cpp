// SPDX-License-Identifier: Apache-2.0
#include <fmt/format.h>

#include <array>
#include <cstdint>
#include <string>
#include <vector>

#include "logs/formats/unicode.hpp"
#include "logs/log_checks.hpp"
#include "logs/mat/mat_elements.hpp"
#include "logs/mat/mat_fields.hpp"
#include "logs/mat/mat_table.hpp"
#include "logs/mat/mat_variable.hpp"
#include "logs/mat/memory_file.hpp"
#include "quadtune/errors.hpp"
#include "quadtune/logs/flight_log.hpp"

namespace quadtune {
namespace {

using internal::FieldLayout;
using internal::FieldTree;
using internal::MatFile;
using internal::MatVariable;

// matio returns no variable where memory is short, and copies what it is given but for columns.
MatVariable made(matvar_t* variable) {
  if (variable == nullptr)
    throw FileError("a MAT file in memory", "matio could not make a variable");
  return MatVariable(variable);
}

// It refers to `values`; matio only reads them.
MatVariable numbers(const std::vector<double>& values) {
  std::array<std::size_t, 2> size = {values.size(), 1};
  return made(Mat_VarCreate(nullptr, MAT_C_DOUBLE, MAT_T_DOUBLE, 2, size.data(),
                            const_cast<double*>(values.data()), MAT_F_DONT_COPY_DATA));
}

MatVariable number(double value) {
  std::array<std::size_t, 2> size = {1, 1};
  return made(Mat_VarCreate(nullptr, MAT_C_DOUBLE, MAT_T_DOUBLE, 2, size.data(), &value, 0));
}

MatVariable text(const std::string& utf8) {
  std::u16string units = internal::utf16_of(utf8).value();
  std::array<std::size_t, 2> size = {units.empty() ? 0U : 1U, units.size()};
  return made(Mat_VarCreate(nullptr, MAT_C_CHAR, MAT_T_UTF16, 2, size.data(), units.data(), 0));
}

MatVariable cells(const std::vector<std::string>& texts) {
  std::array<std::size_t, 2> size = {texts.size(), 1};
  MatVariable cell =
      made(Mat_VarCreate(nullptr, MAT_C_CELL, MAT_T_CELL, 2, size.data(), nullptr, 0));
  for (std::size_t i = 0; i < texts.size(); ++i)
    Mat_VarSetCell(cell.get(), static_cast<int>(i), text(texts[i]).release());
  return cell;
}

// One struct, or a column of `rows` of them.
class Struct {
 public:
  explicit Struct(const std::vector<std::string>& fields, std::size_t rows = 1,
                  const char* name = nullptr) {
    std::vector<const char*> names;
    names.reserve(fields.size());
    for (const std::string& field : fields) names.push_back(field.c_str());
    std::array<std::size_t, 2> size = {rows, 1};
    variable_ = made(Mat_VarCreateStruct(name, 2, size.data(), names.data(),
                                         static_cast<unsigned>(names.size())));
  }

  void set(std::size_t field, MatVariable value, std::size_t row = 0) {
    Mat_VarSetStructFieldByIndex(variable_.get(), field, row, value.release());
  }

  MatVariable take() { return std::move(variable_); }

 private:
  MatVariable variable_;
};

std::vector<std::string> fields_of(const FieldTree& tree) {
  std::vector<std::string> names;
  for (const FieldTree& field : tree.fields) names.push_back(field.field);
  return names;
}

// The struct of the tree with what `leaf` makes of each column.
template <typename Leaf>
MatVariable filled(const FieldTree& tree, const Leaf& leaf) {
  if (tree.column >= 0) return leaf(static_cast<std::size_t>(tree.column));
  Struct result(fields_of(tree));
  for (std::size_t i = 0; i < tree.fields.size(); ++i) result.set(i, filled(tree.fields[i], leaf));
  return result.take();
}

std::vector<std::string> names_of(const LogTable& table) {
  std::vector<std::string> names;
  for (const LogColumn& column : table.columns) names.push_back(column.name);
  return names;
}

MatVariable about_of(const LogTable& table) {
  internal::FieldNames names;
  std::vector<std::string> fields;
  for (const auto& [key, value] : table.about) fields.push_back(names.add(key));
  Struct about(fields);
  for (std::size_t i = 0; i < fields.size(); ++i) about.set(i, text(table.about[i].second));
  return about.take();
}

std::vector<std::string> keys_of(const LogTable& table) {
  std::vector<std::string> keys;
  for (const auto& [key, value] : table.about) keys.push_back(key);
  return keys;
}

MatVariable columns_of(const LogTable& table, const FieldLayout& layout) {
  Struct columns({"name", "unit", "field"}, table.columns.size());
  for (std::size_t i = 0; i < table.columns.size(); ++i) {
    columns.set(0, text(table.columns[i].name), i);
    columns.set(1, text(table.columns[i].unit), i);
    columns.set(2, text(layout.paths[i]), i);
  }
  return columns.take();
}

MatVariable events_of(const LogTable& table) {
  Struct events({"time", "name", "detail"}, table.events.size());
  for (std::size_t i = 0; i < table.events.size(); ++i) {
    events.set(0, number(table.events[i].time), i);
    events.set(1, text(table.events[i].name), i);
    events.set(2, text(table.events[i].detail), i);
  }
  return events.take();
}

MatVariable variable_of(const LogTable& table) {
  // What a log has beside its columns; a column of such a name gets another field.
  std::vector<std::string> fields = {"format", "format_version", "about", "about_keys",
                                     "units",  "columns",        "events"};
  const std::size_t first_column = fields.size();
  const FieldLayout layout = internal::layout_of(names_of(table), fields);
  for (const std::string& field : fields_of(layout.root)) fields.push_back(field);
  Struct log(fields, 1, internal::kMatVariable);
  log.set(0, text(internal::kMatFormat));
  log.set(1, number(internal::kMatVersion));
  log.set(2, about_of(table));
  log.set(3, cells(keys_of(table)));
  log.set(4, filled(layout.root, [&](std::size_t i) { return text(table.columns[i].unit); }));
  log.set(5, columns_of(table, layout));
  log.set(6, events_of(table));
  for (std::size_t i = 0; i < layout.root.fields.size(); ++i)
    log.set(first_column + i, filled(layout.root.fields[i], [&](std::size_t column) {
              return numbers(table.columns[column].values);
            }));
  return log.take();
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

std::string internal::bytes_by_matio(const LogTable& table) {
  internal::require_log(table, "log");
  if (most_bytes(table) >= kLogLimit)
    throw InvalidInput("log", fmt::format("has {} rows of {} columns and {} events, expected less "
                                          "than 2 GiB in all, as MAT v5 files hold no more: write "
                                          "a .csv",
                                          table.rows(), table.columns.size(), table.events.size()));
  const internal::MemoryFile file;
  const MatVariable log = variable_of(table);
  // A header of our own, as matio's has the time of day.
  MatFile mat(Mat_CreateVer(file.path().c_str(), "MATLAB 5.0 MAT-file, quadtune log", MAT_FT_MAT5));
  if (!mat) throw FileError("a MAT file in memory", "matio could not open it");
  const bool written = Mat_VarWrite(mat.get(), log.get(), MAT_COMPRESSION_NONE) == 0;
  if (Mat_Close(mat.release()) != 0 || !written)
    throw FileError("a MAT file in memory", "matio could not write it");
  std::string bytes = file.read();
  // matio passes over failed writes; what is torn is seen here.
  internal::require_mat_v5(bytes, "log");
  return bytes;
}

}  // namespace quadtune
