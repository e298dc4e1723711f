// SPDX-License-Identifier: Apache-2.0
#include "quadtune/internal/json_value.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <iterator>
#include <limits>
#include <nlohmann/json.hpp>
#include <ostream>
#include <utility>

#include "quadtune/internal/dump_json.hpp"
#include "quadtune/internal/utf8.hpp"

namespace quadtune::internal {
namespace {

using Library = nlohmann::ordered_json;

// A text of a million brackets would overflow the stack when values are copied and destroyed.
constexpr int kMaxDepth = 500;

Json from_library(const Library& json) {
  switch (json.type()) {
    case Library::value_t::boolean:
      return json.get<bool>();
    case Library::value_t::number_integer:
      return json.get<std::int64_t>();
    case Library::value_t::number_unsigned:
      return json.get<std::uint64_t>();
    case Library::value_t::number_float:
      return json.get<double>();
    case Library::value_t::string:
      return json.get_ref<const std::string&>();
    case Library::value_t::array: {
      Json array = Json::array();
      for (const Library& entry : json) array.push_back(from_library(entry));
      return array;
    }
    case Library::value_t::object: {
      Json object = Json::object();
      for (const auto& [key, value] : json.items()) object[key] = from_library(value);
      return object;
    }
    default:
      return nullptr;
  }
}

Library to_library(const Json& json) {
  if (json.is_boolean()) return json.get<bool>();
  if (json.is_number_float()) return json.get<double>();
  if (json.is_number_unsigned()) return json.get<std::uint64_t>();
  if (json.is_number_integer()) return json.get<std::int64_t>();
  if (json.is_string()) return json.text();
  if (json.is_array()) {
    Library array = Library::array();
    for (const Json& entry : json) array.push_back(to_library(entry));
    return array;
  }
  if (json.is_object()) {
    Library object = Library::object();
    for (std::size_t i = 0; i < json.size(); ++i)
      object.emplace(json.keys()[i], to_library(*(json.begin() + static_cast<std::ptrdiff_t>(i))));
    return object;
  }
  return nullptr;
}

/// A copy with names and strings converted by valid_utf8().
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
  } catch (const typename AnyJson::type_error&) {  // a string that is not UTF-8
    text = with_valid_text(json).dump(-1, ' ', ascii);
  }
  // Outside of strings there are only printable ASCII characters.
  std::string safe;
  std::size_t copied = 0;
  for (std::size_t i = 0; i < text.size();) {
    const Utf8Character c = first_character(std::string_view(text).substr(i));
    if (is_control_or_mark(c.code)) {
      safe.append(text, copied, i - copied);
      safe += fmt::format("\\u{:04x}", static_cast<unsigned>(c.code));
      copied = i + c.length;
    }
    i += c.length;
  }
  return copied == 0 ? text : safe.append(text, copied);
}

/// Appends `json` to `text`; lines after the first are indented by `indent` plus two.
void append_readable(const Json& json, std::size_t indent, bool in_array, std::string& text) {
  if (json.is_primitive() || json.empty()) {
    text.append(json_text(json));
    return;
  }
  const bool array = json.is_array();
  const bool one_line =
      (array || in_array) &&
      std::all_of(json.begin(), json.end(), [](const Json& entry) { return entry.is_primitive(); });
  text.push_back(array ? '[' : '{');
  std::size_t i = 0;
  for (const Json& value : json) {
    if (i > 0) text.append(one_line ? ", " : ",");
    if (!one_line) text.append(1, '\n').append(indent + 2, ' ');
    if (!array) text.append(json_text(json.keys()[i])).append(": ");
    append_readable(value, indent + 2, array, text);
    ++i;
  }
  if (!one_line) text.append(1, '\n').append(indent, ' ');
  text.push_back(array ? ']' : '}');
}

}  // namespace

Json::Json(std::initializer_list<Json> entries) : kind_(Kind::array) {
  const bool members = std::all_of(entries.begin(), entries.end(), [](const Json& entry) {
    return entry.is_array() && entry.size() == 2 && entry[0].is_string();
  });
  if (!members) {
    values_.assign(entries.begin(), entries.end());
    return;
  }
  kind_ = Kind::object;
  for (const Json& entry : entries)
    if (!contains(entry[0].text())) (*this)[entry[0].text()] = entry[1];
}

Json Json::array(std::initializer_list<Json> entries) {
  Json json;
  json.kind_ = Kind::array;
  json.values_.assign(entries.begin(), entries.end());
  return json;
}

Json Json::object() {
  Json json;
  json.kind_ = Kind::object;
  return json;
}

Json Json::parse(const std::string& text) {
  try {
    return from_library(Library::parse(text, [](int depth, Library::parse_event_t, Library&) {
      if (depth > kMaxDepth)
        throw JsonError(
            fmt::format("nests arrays and objects more than {} levels deep", kMaxDepth));
      return true;
    }));
  } catch (const Library::parse_error& error) {
    throw JsonError(error.what(), error.byte);
  } catch (const Library::out_of_range& error) {
    throw JsonError(error.what(), 0, /*out_of_range=*/true);
  }
}

bool Json::is_number_unsigned() const {
  return kind_ == Kind::natural || (kind_ == Kind::integer && number_.integer >= 0);
}

const char* Json::type_name() const {
  switch (kind_) {
    case Kind::null:
      return "null";
    case Kind::boolean:
      return "a boolean";
    case Kind::text:
      return "a string";
    case Kind::array:
      return "an array";
    case Kind::object:
      return "an object";
    default:
      return "a number";
  }
}

const Json* Json::find(std::string_view key) const {
  const auto found = std::find(keys_.begin(), keys_.end(), key);
  return found == keys_.end() ? nullptr : &values_[static_cast<std::size_t>(found - keys_.begin())];
}

Json& Json::operator[](std::string_view key) {
  if (is_null()) kind_ = Kind::object;
  if (!is_object()) refuse("an object");
  if (const Json* member = find(key)) return const_cast<Json&>(*member);
  keys_.emplace_back(key);
  return values_.emplace_back();
}

const Json& Json::operator[](std::string_view key) const {
  if (!is_object()) refuse("an object");
  const Json* member = find(key);
  if (member == nullptr) throw JsonError(fmt::format("has no \"{}\"", key));
  return *member;
}

const Json& Json::at(std::size_t index) const {
  if (!is_array()) refuse("an array");
  if (index >= values_.size())
    throw JsonError(fmt::format("has no entry {} of {}", index, values_.size()));
  return values_[index];
}

void Json::push_back(Json entry) {
  if (is_null()) kind_ = Kind::array;
  if (!is_array()) refuse("an array");
  values_.push_back(std::move(entry));
}

void Json::update(const Json& other) {
  if (!other.is_object()) other.refuse("an object");
  for (std::size_t i = 0; i < other.size(); ++i) (*this)[other.keys_[i]] = other.values_[i];
}

const std::string& Json::text() const {
  if (!is_string()) refuse("text");
  return text_;
}

bool Json::boolean() const {
  if (!is_boolean()) refuse("a boolean");
  return number_.boolean;
}

std::int64_t Json::integer() const {
  if (kind_ == Kind::integer) return number_.integer;
  if (kind_ == Kind::natural && std::in_range<std::int64_t>(number_.natural))
    return static_cast<std::int64_t>(number_.natural);
  /// 2^53: above it a double does not identify a single integer.
  constexpr double kExact = 9007199254740992;
  const double value =
      kind_ == Kind::real ? number_.real : std::numeric_limits<double>::quiet_NaN();
  if (!(std::abs(value) <= kExact) || value != std::floor(value)) refuse("a whole number");
  return static_cast<std::int64_t>(value);
}

std::uint64_t Json::natural() const {
  if (kind_ == Kind::natural) return number_.natural;
  const std::int64_t value = integer();
  if (value < 0) refuse("a whole number of at least 0");
  return static_cast<std::uint64_t>(value);
}

double Json::real() const {
  if (kind_ == Kind::real) return number_.real;
  if (kind_ == Kind::integer) return static_cast<double>(number_.integer);
  if (kind_ != Kind::natural) refuse("a number");
  return static_cast<double>(number_.natural);
}

void Json::refuse(const char* expected) const {
  throw JsonError(fmt::format("is {}, expected {}", type_name(), expected));
}

bool operator==(const Json& a, const Json& b) {
  if (a.is_number() && b.is_number()) return to_library(a) == to_library(b);
  if (a.kind_ != b.kind_) return false;
  if (a.is_boolean()) return a.number_.boolean == b.number_.boolean;
  return a.text_ == b.text_ && a.keys_ == b.keys_ && a.values_ == b.values_;
}

std::ostream& operator<<(std::ostream& stream, const Json& json) {
  return stream << json_text(json);
}

std::string json_text(const Json& json, bool ascii) { return text_of(to_library(json), ascii); }

std::string dump_json(const nlohmann::json& json, bool ascii) { return text_of(json, ascii); }

std::string readable(const Json& json) {
  std::string text;
  append_readable(json, 0, false, text);
  return text;
}

}  // namespace quadtune::internal
