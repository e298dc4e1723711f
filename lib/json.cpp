// SPDX-License-Identifier: Apache-2.0
#include "quadtune/internal/json.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <iterator>
#include <string_view>

#include "quadtune/errors.hpp"
#include "quadtune/internal/utf8.hpp"
#include "quadtune/matrix_checks.hpp"

namespace quadtune::internal {

namespace {

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

template <typename AnyJson>
std::string text_of(const AnyJson& json, bool ascii) {
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

/// Appends `json` to `text`; lines below the first are indented by `indent` and two more.
void append_readable(const Json& json, std::size_t indent, bool in_array, std::string& text) {
  if (!json.is_structured() || json.empty()) {
    text.append(text_of(json, false));
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
    if (!array) text.append(text_of(Json(key), false)).append(": ");
    append_readable(value, indent + 2, array, text);
  }
  if (!one_line) text.append(1, '\n').append(indent, ' ');
  text.push_back(array ? ']' : '}');
}

}  // namespace

std::string json_text(const Json& json, bool ascii) { return text_of(json, ascii); }

std::string json_text(const nlohmann::json& json, bool ascii) { return text_of(json, ascii); }

Json number_to_json(double number, const std::string& name) {
  if (!std::isfinite(number))
    throw InvalidInput(name, fmt::format("{} cannot be written, expected a finite number", number));
  return number;
}

Json finite_or_null(double number) { return std::isfinite(number) ? Json(number) : Json(nullptr); }

Json matrix_to_json(const Eigen::Ref<const Eigen::MatrixXd>& M, const std::string& name) {
  require_finite(M, "json", name);
  Json rows = Json::array();
  for (Eigen::Index i = 0; i < M.rows(); ++i) {
    Json row = Json::array();
    for (Eigen::Index j = 0; j < M.cols(); ++j) row.push_back(M(i, j));
    rows.push_back(std::move(row));
  }
  return rows;
}

Json vector_to_json(const Eigen::Ref<const Eigen::VectorXd>& v, const std::string& name) {
  require_finite(v, "json", name);
  Json entries = Json::array();
  for (const double entry : v) entries.push_back(entry);
  return entries;
}

Json poles_to_json(const Eigen::Ref<const Eigen::VectorXcd>& poles, const std::string& name) {
  Json entries = Json::array();
  for (const std::complex<double>& pole : poles)
    entries.push_back({number_to_json(pole.real(), name), number_to_json(pole.imag(), name)});
  return entries;
}

Json signals_to_json(const std::vector<Signal>& signals) {
  Json entries = Json::array();
  for (const Signal& signal : signals)
    entries.push_back({{"name", signal.name}, {"unit", signal.unit}});
  return entries;
}

const Json& member(const Json& json, const std::string& key, const std::string& where) {
  if (!json.is_object())
    throw InvalidInput(where, fmt::format("is {}, expected an object", json.type_name()));
  const auto found = json.find(key);
  if (found == json.end()) throw InvalidInput(where, fmt::format("has no \"{}\"", key));
  return *found;
}

double number_from_json(const Json& json, const std::string& where) {
  if (!json.is_number() || !std::isfinite(json.get<double>()))
    throw InvalidInput(where, fmt::format("is {}, expected a finite number", json_text(json)));
  return json.get<double>();
}

std::string string_from_json(const Json& json, const std::string& where) {
  if (!json.is_string())
    throw InvalidInput(where, fmt::format("is {}, expected text", json.type_name()));
  return json.get<std::string>();
}

Eigen::VectorXd vector_from_json(const Json& json, const std::string& where) {
  if (!json.is_array())
    throw InvalidInput(where, fmt::format("is {}, expected an array of numbers", json.type_name()));
  Eigen::VectorXd v(static_cast<Eigen::Index>(json.size()));
  for (std::size_t i = 0; i < json.size(); ++i)
    v(static_cast<Eigen::Index>(i)) = number_from_json(json[i], fmt::format("{}[{}]", where, i));
  return v;
}

Eigen::MatrixXd matrix_from_json(const Json& json, const std::string& where) {
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

Eigen::VectorXcd poles_from_json(const Json& json, const std::string& where) {
  const Eigen::MatrixXd pairs = matrix_from_json(json, where);
  if (pairs.rows() > 0 && pairs.cols() != 2)
    throw InvalidInput(
        where, fmt::format("has rows of {} numbers, expected [real, imaginary]", pairs.cols()));
  Eigen::VectorXcd poles(pairs.rows());
  for (Eigen::Index i = 0; i < pairs.rows(); ++i) poles(i) = {pairs(i, 0), pairs(i, 1)};
  return poles;
}

std::vector<Signal> signals_from_json(const Json& json, const std::string& where) {
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

std::string readable(const Json& json) {
  std::string text;
  append_readable(json, 0, false, text);
  return text;
}

}  // namespace quadtune::internal
