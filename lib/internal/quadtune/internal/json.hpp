// SPDX-License-Identifier: Apache-2.0
/// Matrices, signals and poles as JSON and back. Numbers read back to the same double. JSON has no
/// word for numbers that are not finite: they are refused, or null where that has a meaning.
#pragma once

#include <fmt/format.h>

#include <Eigen/Core>
#include <algorithm>
#include <cmath>
#include <cstddef>
#include <iterator>
#include <nlohmann/json.hpp>
#include <string>
#include <string_view>
#include <vector>

#include "quadtune/errors.hpp"
#include "quadtune/internal/utf8.hpp"
#include "quadtune/lti.hpp"
#include "quadtune/matrix_checks.hpp"

namespace quadtune::internal {

using Json = nlohmann::ordered_json;

/// A copy whose names and texts are UTF-8, as valid_utf8() makes them.
template <typename AnyJson>
AnyJson with_valid_text(const AnyJson& json) {
  if (json.is_string()) return valid_utf8(json.template get_ref<const std::string&>());
  AnyJson copy = json;
  if (json.is_array()) {
    for (AnyJson& entry : copy) entry = with_valid_text(entry);
  } else if (json.is_object()) {
    copy.clear();
    for (const auto& [key, value] : json.items()) copy[valid_utf8(key)] = with_valid_text(value);
  }
  return copy;
}

/// Text of a JSON value on one line. All JSON is written through this, because names of files and
/// of what is in them need not be UTF-8, which JSON has to be. What a terminal would obey instead
/// of show is written as \uNNNN.
/// @param ascii  whether to write everything but ASCII so
template <typename AnyJson>
std::string json_text(const AnyJson& json, bool ascii = false) {
  std::string text;
  try {
    text = json.dump(-1, ' ', ascii);
  } catch (const typename AnyJson::type_error&) {  // a text that is not UTF-8
    text = with_valid_text(json).dump(-1, ' ', ascii);
  }
  // Outside of strings there are only ASCII characters that are shown.
  std::string safe;
  std::size_t copied = 0;
  for (std::size_t i = 0; i < text.size();) {
    const Utf8Character c = first_character(std::string_view(text).substr(i));
    if (is_control_or_mark(c.code)) {
      safe.append(text, copied, i - copied);
      fmt::format_to(std::back_inserter(safe), "\\u{:04x}", static_cast<unsigned>(c.code));
      copied = i + c.length;
    }
    i += c.length;
  }
  return copied == 0 ? text : safe.append(text, copied);
}

/// @param name  what the message calls the number.
/// @throws InvalidInput  if it is not finite.
inline Json number_to_json(double number, const std::string& name) {
  if (!std::isfinite(number))
    throw InvalidInput(name, fmt::format("{} cannot be written, expected a finite number", number));
  return number;
}

/// For a figure that may be missing or without bound.
inline Json finite_or_null(double number) {
  return std::isfinite(number) ? Json(number) : Json(nullptr);
}

/// An array of rows; a matrix without rows or columns keeps its rows: [[], []].
/// @throws InvalidInput  naming the first entry that is not finite.
inline Json matrix_to_json(const Eigen::Ref<const Eigen::MatrixXd>& M, const std::string& name) {
  require_finite(M, "json", name);
  Json rows = Json::array();
  for (Eigen::Index i = 0; i < M.rows(); ++i) {
    Json row = Json::array();
    for (Eigen::Index j = 0; j < M.cols(); ++j) row.push_back(M(i, j));
    rows.push_back(std::move(row));
  }
  return rows;
}

inline Json vector_to_json(const Eigen::Ref<const Eigen::VectorXd>& v, const std::string& name) {
  require_finite(v, "json", name);
  Json entries = Json::array();
  for (const double entry : v) entries.push_back(entry);
  return entries;
}

/// Complex numbers as [real, imaginary].
inline Json poles_to_json(const Eigen::Ref<const Eigen::VectorXcd>& poles,
                          const std::string& name) {
  Json entries = Json::array();
  for (const std::complex<double>& pole : poles)
    entries.push_back({number_to_json(pole.real(), name), number_to_json(pole.imag(), name)});
  return entries;
}

/// [{"name": "z", "unit": "m"}, …]
inline Json signals_to_json(const std::vector<Signal>& signals) {
  Json entries = Json::array();
  for (const Signal& signal : signals)
    entries.push_back({{"name", signal.name}, {"unit", signal.unit}});
  return entries;
}

/// The member `key` of an object. `where` is "file: path", to which readers add the key.
/// @throws InvalidInput  if `json` is no object or has no such member.
inline const Json& member(const Json& json, const std::string& key, const std::string& where) {
  if (!json.is_object())
    throw InvalidInput(where, fmt::format("is {}, expected an object", json.type_name()));
  const auto found = json.find(key);
  if (found == json.end()) throw InvalidInput(where, fmt::format("has no \"{}\"", key));
  return *found;
}

inline double number_from_json(const Json& json, const std::string& where) {
  if (!json.is_number() || !std::isfinite(json.get<double>()))
    throw InvalidInput(where, fmt::format("is {}, expected a finite number", json_text(json)));
  return json.get<double>();
}

inline std::string string_from_json(const Json& json, const std::string& where) {
  if (!json.is_string())
    throw InvalidInput(where, fmt::format("is {}, expected text", json.type_name()));
  return json.get<std::string>();
}

inline Eigen::VectorXd vector_from_json(const Json& json, const std::string& where) {
  if (!json.is_array())
    throw InvalidInput(where, fmt::format("is {}, expected an array of numbers", json.type_name()));
  Eigen::VectorXd v(static_cast<Eigen::Index>(json.size()));
  for (std::size_t i = 0; i < json.size(); ++i)
    v(static_cast<Eigen::Index>(i)) = number_from_json(json[i], fmt::format("{}[{}]", where, i));
  return v;
}

/// @throws InvalidInput  if the rows have different lengths.
inline Eigen::MatrixXd matrix_from_json(const Json& json, const std::string& where) {
  if (!json.is_array())
    throw InvalidInput(where, fmt::format("is {}, expected an array of rows", json.type_name()));
  Eigen::MatrixXd M(static_cast<Eigen::Index>(json.size()), 0);
  for (std::size_t i = 0; i < json.size(); ++i) {
    const Eigen::VectorXd row = vector_from_json(json[i], fmt::format("{}[{}]", where, i));
    if (i == 0) M.resize(M.rows(), row.size());
    if (row.size() != M.cols())
      throw InvalidInput(fmt::format("{}[{}]", where, i),
                         fmt::format("has {} entries, expected {} as in the rows before it",
                                     row.size(), M.cols()));
    M.row(static_cast<Eigen::Index>(i)) = row.transpose();
  }
  return M;
}

inline Eigen::VectorXcd poles_from_json(const Json& json, const std::string& where) {
  const Eigen::MatrixXd pairs = matrix_from_json(json, where);
  if (pairs.rows() > 0 && pairs.cols() != 2)
    throw InvalidInput(
        where, fmt::format("has rows of {} numbers, expected [real, imaginary]", pairs.cols()));
  Eigen::VectorXcd poles(pairs.rows());
  for (Eigen::Index i = 0; i < pairs.rows(); ++i) poles(i) = {pairs(i, 0), pairs(i, 1)};
  return poles;
}

inline std::vector<Signal> signals_from_json(const Json& json, const std::string& where) {
  if (!json.is_array())
    throw InvalidInput(where, fmt::format("is {}, expected an array of signals", json.type_name()));
  std::vector<Signal> signals;
  for (std::size_t i = 0; i < json.size(); ++i) {
    const std::string here = fmt::format("{}[{}]", where, i);
    signals.push_back({string_from_json(member(json[i], "name", here), here + ".name"),
                       string_from_json(member(json[i], "unit", here), here + ".unit")});
  }
  return signals;
}

/// Appends `json` to `text`; lines below the first are indented by `indent` and two more.
inline void append_readable(const Json& json, std::size_t indent, bool in_array,
                            std::string& text) {
  if (!json.is_structured() || json.empty()) {
    text.append(json_text(json));
    return;
  }
  const bool array = json.is_array();
  const bool one_line =
      (array || in_array) && std::none_of(json.begin(), json.end(),
                                          [](const Json& entry) { return entry.is_structured(); });
  text.push_back(array ? '[' : '{');
  bool first = true;
  for (const auto& [key, value] : json.items()) {
    if (!first) text.append(one_line ? ", " : ",");
    first = false;
    if (!one_line) text.append(1, '\n').append(indent + 2, ' ');
    if (!array) text.append(json_text(Json(key))).append(": ");
    append_readable(value, indent + 2, array, text);
  }
  if (!one_line) text.append(1, '\n').append(indent, ' ');
  text.push_back(array ? ']' : '}');
}

/// Text of a JSON value with two blanks of indent. Arrays of plain values, and plain objects in an
/// array, stand on one line, so that a matrix stands row under row.
inline std::string readable(const Json& json) {
  std::string text;
  append_readable(json, 0, false, text);
  return text;
}

}  // namespace quadtune::internal
