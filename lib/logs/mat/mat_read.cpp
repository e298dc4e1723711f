// SPDX-License-Identifier: Apache-2.0
#include <fmt/format.h>

#include <cstddef>
#include <new>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "logs/log_checks.hpp"
#include "logs/mat/mat_elements.hpp"
#include "quadtune/errors.hpp"
#include "quadtune/internal/text_file.hpp"
#include "quadtune/logs/flight_log.hpp"
#include "quadtune/logs/log_reader.hpp"

namespace quadtune {
namespace {

using internal::kMatVariable;
using internal::MatArray;
using internal::MatClass;
using internal::MatType;
using internal::printable;

class Reader {
 public:
  explicit Reader(const std::string& origin) : origin_(origin) {}

  LogTable table(const MatArray& variable) const {
    const Place log{&variable, kMatVariable};
    require_struct(log, 1);
    const std::string format = text(field(log, "format"));
    const double version = number(field(log, "format_version"));
    if (format != internal::kMatFormat || version != internal::kMatVersion)
      throw InvalidInput(origin_, fmt::format("{}.format is '{}', version {}, expected '{}', "
                                              "version {}",
                                              kMatVariable, printable(format), version,
                                              internal::kMatFormat, internal::kMatVersion));
    LogTable result;
    read_about(log, result);
    read_columns(log, result);
    const Place events = field(log, "events");
    require_struct(events, rows(events));
    for (std::size_t i = 0; i < rows(events); ++i)
      result.events.push_back({number(field(events, "time", i)), text(field(events, "name", i)),
                               text(field(events, "detail", i))});
    internal::require_log(result, origin_);
    return result;
  }

 private:
  // An array, which may be missing, and its name in messages.
  struct Place {
    const MatArray* array;
    std::string name;
  };

  [[noreturn]] void refuse(const Place& place, const std::string& expected) const {
    throw InvalidInput(origin_, fmt::format("{} is missing or has the wrong type, expected {}",
                                            printable(place.name), expected));
  }

  static std::size_t rows(const Place& place) { return place.array ? place.array->rows() : 0; }
  static std::size_t columns(const Place& place) {
    return place.array ? place.array->columns() : 0;
  }

  static bool is(const Place& place, MatClass kind) {
    return place.array != nullptr && place.array->is_matrix() && place.array->kind == kind &&
           !place.array->complex;
  }

  void require_struct(const Place& place, std::size_t count) const {
    if (!is(place, MatClass::structure) || columns(place) != 1 || rows(place) != count)
      refuse(place, "a struct, or a column of them");
  }

  static Place field(const Place& place, const std::string& name, std::size_t row = 0) {
    return {place.array == nullptr ? nullptr : place.array->field(name, row),
            place.name + '.' + name};
  }

  [[nodiscard]] std::vector<double> numbers(const Place& place) const {
    if (!is(place, MatClass::float64) || place.array->type != MatType::float64 ||
        columns(place) != 1)
      refuse(place, "a column of real numbers");
    std::vector<double> values(rows(place));
    for (std::size_t i = 0; i < values.size(); ++i) values[i] = place.array->number(i);
    return values;
  }

  [[nodiscard]] double number(const Place& place) const {
    const std::vector<double> values = numbers(place);
    if (values.size() != 1) refuse(place, "one number");
    return values[0];
  }

  [[nodiscard]] std::string text(const Place& place) const {
    const bool letters = is(place, MatClass::text) && rows(place) <= 1;
    const std::optional<std::string> utf8 = letters ? place.array->utf16_text() : std::nullopt;
    if (!utf8) refuse(place, "a text in UTF-16");
    return *utf8;
  }

  void read_about(const Place& log, LogTable& result) const {
    const Place about = field(log, "about");
    require_struct(about, 1);
    const Place keys = field(log, "about_keys");
    if (!is(keys, MatClass::cell) || columns(keys) != 1 || rows(keys) != about.array->fields.size())
      refuse(keys, "a column of cells, one for each field of about");
    for (std::size_t i = 0; i < rows(keys); ++i) {
      const std::string name = fmt::format("{}[{}]", about.name, i);
      result.about.emplace_back(text({&keys.array->parts[i], keys.name}),
                                text({&about.array->parts[i], name}));
    }
  }

  void read_columns(const Place& log, LogTable& result) const {
    const Place columns = field(log, "columns");
    require_struct(columns, rows(columns));
    for (std::size_t i = 0; i < rows(columns); ++i)
      result.columns.push_back({text(field(columns, "name", i)), text(field(columns, "unit", i)),
                                numbers(follow(log, text(field(columns, "field", i))))});
  }

  // "x.px" is the field px of the field x.
  static Place follow(Place place, std::string_view path) {
    while (true) {
      const std::size_t dot = path.find('.');
      if (!is(place, MatClass::structure) || rows(place) * columns(place) != 1)
        place.array = nullptr;
      place = field(place, std::string(path.substr(0, dot)));
      if (dot == std::string_view::npos) return place;
      path.remove_prefix(dot + 1);
    }
  }

  const std::string& origin_;
};

}  // namespace

LogTable table_of_mat(const std::string& bytes, const std::string& origin) {
  const std::size_t memory_limit = LogOptions().memory_limit;
  internal::MemoryBudget budget(memory_limit);
  try {
    const std::vector<MatArray> variables = internal::parse_mat(bytes, origin, budget);
    for (const MatArray& variable : variables)
      if (variable.name == kMatVariable) return Reader(origin).table(variable);
  } catch (const std::bad_alloc&) {
    throw InvalidInput(
        origin, fmt::format("needs more than {} MiB of memory to be read", memory_limit >> 20U));
  }
  throw InvalidInput(origin, fmt::format("has no variable '{}', expected a log that quadtune wrote",
                                         kMatVariable));
}

}  // namespace quadtune
