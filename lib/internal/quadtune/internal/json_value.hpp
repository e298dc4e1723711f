// SPDX-License-Identifier: Apache-2.0
/// A JSON value: null, a boolean, a number, a string, an array, or an object whose members keep
/// their order. Only json_value.cpp uses nlohmann::json to parse and write text, because its
/// templates double the compile time of a verb.
#pragma once

#include <array>
#include <concepts>
#include <cstddef>
#include <cstdint>
#include <initializer_list>
#include <iosfwd>
#include <stdexcept>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

namespace quadtune::internal {

/// A text that is not JSON, or a value of a different kind than requested.
class JsonError : public std::runtime_error {
 public:
  explicit JsonError(const std::string& message, std::size_t byte = 0, bool out_of_range = false)
      : std::runtime_error(message), byte_(byte), out_of_range_(out_of_range) {}

  /// The number of bytes read up to the error, counted from 1; 0 if unknown.
  [[nodiscard]] std::size_t byte() const { return byte_; }
  /// Whether a number in the text exceeds the range of double.
  [[nodiscard]] bool out_of_range() const { return out_of_range_; }

 private:
  std::size_t byte_;
  bool out_of_range_;
};

class Json {
 public:
  Json() = default;
  Json(std::nullptr_t) {}
  template <std::same_as<bool> B>  // a template, so that pointers do not convert to bool
  Json(B value) : kind_(Kind::boolean) {
    number_.boolean = value;
  }
  template <std::signed_integral I>
  Json(I value) : kind_(Kind::integer) {
    number_.integer = value;
  }
  template <std::unsigned_integral U>
  requires(!std::same_as<U, bool>) Json(U value) : kind_(Kind::natural) { number_.natural = value; }
  Json(double value) : kind_(Kind::real) { number_.real = value; }
  Json(const char* text) : kind_(Kind::text), text_(text) {}
  Json(std::string text) : kind_(Kind::text), text_(std::move(text)) {}
  Json(std::string_view text) : kind_(Kind::text), text_(text) {}
  template <class T>
  Json(const std::vector<T>& values) : kind_(Kind::array) {
    values_.reserve(values.size());
    for (const auto& value : values) values_.emplace_back(value);
  }
  template <class T, std::size_t N>
  Json(const std::array<T, N>& values) : kind_(Kind::array) {
    values_.reserve(N);
    for (const auto& value : values) values_.emplace_back(value);
  }
  /// An object if every entry is an array of a string and a value; else an array.
  Json(std::initializer_list<Json> entries);

  [[nodiscard]] static Json array(std::initializer_list<Json> entries = {});
  [[nodiscard]] static Json object();
  /// @throws JsonError  if the text is not JSON, a number exceeds the range of double, or arrays
  ///                    and objects are nested more than 500 levels deep
  [[nodiscard]] static Json parse(const std::string& text);

  [[nodiscard]] bool is_null() const { return kind_ == Kind::null; }
  [[nodiscard]] bool is_boolean() const { return kind_ == Kind::boolean; }
  [[nodiscard]] bool is_number() const { return is_number_integer() || kind_ == Kind::real; }
  [[nodiscard]] bool is_number_float() const { return kind_ == Kind::real; }
  [[nodiscard]] bool is_number_integer() const {
    return kind_ == Kind::integer || kind_ == Kind::natural;
  }
  /// Whether it is a nonnegative whole number.
  [[nodiscard]] bool is_number_unsigned() const;
  [[nodiscard]] bool is_string() const { return kind_ == Kind::text; }
  [[nodiscard]] bool is_array() const { return kind_ == Kind::array; }
  [[nodiscard]] bool is_object() const { return kind_ == Kind::object; }
  [[nodiscard]] bool is_structured() const { return is_array() || is_object(); }
  [[nodiscard]] bool is_primitive() const { return !is_structured(); }
  [[nodiscard]] const char* type_name() const;  ///< "null", "a number", "an array", …

  /// The number of entries of an array or of members of an object; 0 for other kinds.
  [[nodiscard]] std::size_t size() const { return values_.size(); }
  [[nodiscard]] bool empty() const { return values_.empty(); }
  [[nodiscard]] auto begin() { return values_.begin(); }
  [[nodiscard]] auto begin() const { return values_.begin(); }
  [[nodiscard]] auto end() { return values_.end(); }
  [[nodiscard]] auto end() const { return values_.end(); }
  [[nodiscard]] const Json& front() const { return at(0); }
  [[nodiscard]] const Json& back() const { return at(values_.size() - 1); }
  [[nodiscard]] Json& back() { return (*this)[values_.size() - 1]; }

  /// The names of an object's members, in the order of the values.
  [[nodiscard]] const std::vector<std::string>& keys() const { return keys_; }
  [[nodiscard]] bool contains(std::string_view key) const { return find(key) != nullptr; }
  /// The member of that name, or nullptr if there is none.
  [[nodiscard]] const Json* find(std::string_view key) const;

  /// The member of that name; a missing one is added as null. Null becomes an object.
  /// @throws JsonError  if this is neither an object nor null
  [[nodiscard]] Json& operator[](std::string_view key);
  /// @throws JsonError  if this is not an object or has no such member
  [[nodiscard]] const Json& operator[](std::string_view key) const;
  /// @throws JsonError  if this is not an array or has no such entry
  template <std::integral I>
  [[nodiscard]] Json& operator[](I index) {
    return const_cast<Json&>(at(static_cast<std::size_t>(index)));
  }
  template <std::integral I>
  [[nodiscard]] const Json& operator[](I index) const {
    return at(static_cast<std::size_t>(index));
  }

  /// Appends an entry. Null becomes an array.
  /// @throws JsonError  if this is neither an array nor null
  void push_back(Json entry);
  /// Replaces or adds the members of another object.
  void update(const Json& other);

  /// The value as a bool, a std::string, or a number; 2.0 is a whole number as well.
  /// @throws JsonError  if it is of a different kind, or a number that T cannot represent
  template <class T>
  [[nodiscard]] T get() const {
    if constexpr (std::same_as<T, bool>)
      return boolean();
    else if constexpr (std::same_as<T, std::string>)
      return text();
    else if constexpr (std::unsigned_integral<T>)
      return held<T>(natural());
    else if constexpr (std::signed_integral<T>)
      return held<T>(integer());
    else {
      static_assert(std::floating_point<T>, "a list is read entry by entry");
      return static_cast<T>(real());
    }
  }
  [[nodiscard]] const std::string& text() const;

  /// Numbers are equal if their values are equal, whatever their kind.
  friend bool operator==(const Json& a, const Json& b);
  friend std::ostream& operator<<(std::ostream& stream, const Json& json);

 private:
  enum class Kind { null, boolean, integer, natural, real, text, array, object };

  [[nodiscard]] const Json& at(std::size_t index) const;
  [[nodiscard]] bool boolean() const;
  [[nodiscard]] std::int64_t integer() const;
  [[nodiscard]] std::uint64_t natural() const;
  [[nodiscard]] double real() const;
  [[noreturn]] void refuse(const char* expected) const;
  template <class T, class Integer>
  [[nodiscard]] T held(Integer value) const {
    if (!std::in_range<T>(value)) refuse("a smaller whole number");
    return static_cast<T>(value);
  }

  Kind kind_ = Kind::null;
  union {
    bool boolean;
    std::int64_t integer;
    std::uint64_t natural;
    double real = 0;
  } number_;
  std::string text_;
  std::vector<std::string> keys_;
  std::vector<Json> values_;
};

/// The value as text on one line. Characters that a terminal would interpret are written as \uNNNN,
/// bytes that are not UTF-8 as by valid_utf8().
/// @param ascii  whether to escape all characters that are not ASCII
[[nodiscard]] std::string json_text(const Json& json, bool ascii = false);

/// The value as text with two blanks of indentation. Arrays of scalars, and objects of scalars
/// within an array, are written on one line, so that the rows of a matrix are aligned.
[[nodiscard]] std::string readable(const Json& json);

}  // namespace quadtune::internal
