// SPDX-License-Identifier: Apache-2.0
#include "quadtune/internal/mat_values.hpp"

#include <algorithm>
#include <cstdint>

#include "logs/formats/unicode.hpp"
#include "logs/mat/mat_array.hpp"

namespace quadtune::internal {
namespace {

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

// @param content  elements after the name
std::string array(MatClass kind, std::size_t rows, std::size_t columns, const std::string& content,
                  const std::string& name = "") {
  const std::vector<std::uint32_t> flags = {static_cast<std::uint32_t>(kind), 0};
  const std::vector<std::int32_t> size = {static_cast<std::int32_t>(rows),
                                          static_cast<std::int32_t>(columns)};
  const std::string head = element(MatType::uint32, flags) + element(MatType::int32, size) +
                           element(MatType::int8, name);
  return tag(MatType::matrix, head.size() + content.size()) + head + content;
}

bool is_list_of_numbers(const Json& json) {
  return json.is_array() &&
         std::all_of(json.begin(), json.end(), [](const Json& one) { return one.is_number(); });
}

/// Whether the nested lists of numbers are the rows of a matrix.
bool is_matrix(const Json& json) {
  return !json.empty() && std::all_of(json.begin(), json.end(), [&](const Json& row) {
    return is_list_of_numbers(row) && row.size() == json.front().size();
  });
}

bool is_column_of_structs(const Json& json) {
  return !json.empty() && std::all_of(json.begin(), json.end(), [&](const Json& one) {
    return one.is_object() && one.keys() == json.front().keys();
  });
}

std::string matrix_of_rows(const Json& rows) {
  Eigen::MatrixXd M(static_cast<Eigen::Index>(rows.size()),
                    static_cast<Eigen::Index>(rows.front().size()));
  for (Eigen::Index i = 0; i < M.rows(); ++i)
    for (Eigen::Index j = 0; j < M.cols(); ++j) M(i, j) = rows[i][j].get<double>();
  return mat_matrix(M);
}

std::string list_of(const Json& json) {
  if (is_list_of_numbers(json)) {
    Eigen::VectorXd column(static_cast<Eigen::Index>(json.size()));
    for (Eigen::Index i = 0; i < column.size(); ++i) column(i) = json[i].get<double>();
    return mat_matrix(column);
  }
  if (is_matrix(json)) return matrix_of_rows(json);
  std::string values;
  if (is_column_of_structs(json)) {
    for (const Json& one : json)
      for (const Json& field : one) values += mat_of_json(field);
    return mat_structs(json.front().keys(), values, json.size());
  }
  for (const Json& one : json) values += mat_of_json(one);
  return array(MatClass::cell, json.size(), 1, values);
}

}  // namespace

std::string mat_header(const std::string& title) {
  std::string bytes = title;
  bytes.resize(34, '\0');
  bytes.resize(124, ' ');
  const std::uint16_t version = 0x0100;
  const std::uint16_t byte_order = 0x4d49;
  append(bytes, &version, sizeof version);
  append(bytes, &byte_order, sizeof byte_order);
  return bytes;
}

std::string mat_matrix(const Eigen::Ref<const Eigen::MatrixXd>& M) {
  const std::size_t column = static_cast<std::size_t>(M.rows()) * sizeof(double);
  std::string bytes = tag(MatType::float64, column * static_cast<std::size_t>(M.cols()));
  bytes.reserve(bytes.size() + column * static_cast<std::size_t>(M.cols()));
  for (Eigen::Index j = 0; j < M.cols(); ++j) append(bytes, M.col(j).data(), column);
  return array(MatClass::float64, static_cast<std::size_t>(M.rows()),
               static_cast<std::size_t>(M.cols()), bytes);
}

std::string mat_text(const std::string& utf8) {
  const std::u16string units = utf16_of(utf8).value();
  return array(MatClass::text, units.empty() ? 0 : 1, units.size(), element(MatType::utf16, units));
}

std::string mat_cells(const std::vector<std::string>& texts) {
  std::string parts;
  for (const std::string& one : texts) parts += mat_text(one);
  return array(MatClass::cell, texts.size(), 1, parts);
}

std::string mat_structs(const std::vector<std::string>& fields, const std::string& values,
                        std::size_t rows, const std::string& name) {
  // Size of a name with its NUL, so that all names together fill a multiple of eight bytes
  std::size_t slot = 1;
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

std::string mat_of_json(const Json& json, const std::string& name) {
  if (json.is_object()) {
    std::string values;
    for (const Json& field : json) values += mat_of_json(field);
    return mat_structs(json.keys(), values, 1, name);
  }
  if (json.is_array()) return list_of(json);
  if (json.is_string()) return mat_text(json.text());
  if (json.is_boolean())
    return mat_matrix(Eigen::MatrixXd::Constant(1, 1, json.get<bool>() ? 1 : 0));
  if (json.is_null()) return mat_matrix(Eigen::MatrixXd(0, 0));
  return mat_matrix(Eigen::MatrixXd::Constant(1, 1, json.get<double>()));
}

}  // namespace quadtune::internal
