// SPDX-License-Identifier: Apache-2.0
#include <fmt/format.h>

#include <cstddef>
#include <string>
#include <string_view>
#include <vector>

#include "logs/formats/unicode.hpp"
#include "logs/log_checks.hpp"
#include "logs/mat/mat_elements.hpp"
#include "logs/mat/mat_table.hpp"
#include "logs/mat/mat_variable.hpp"
#include "logs/mat/memory_file.hpp"
#include "quadtune/errors.hpp"
#include "quadtune/internal/text_file.hpp"
#include "quadtune/logs/flight_log.hpp"

namespace quadtune {
namespace {

using internal::kMatVariable;
using internal::MatFile;
using internal::MatVariable;
using internal::printable;

class Reader {
 public:
  explicit Reader(const std::string& origin) : origin_(origin) {}

  LogTable table(matvar_t* variable) const {
    const Place log{variable, kMatVariable};
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
  // A variable, which may be missing, and what messages call it.
  struct Place {
    matvar_t* variable;
    std::string name;
  };

  [[noreturn]] void refuse(const Place& place, const std::string& expected) const {
    throw InvalidInput(origin_, fmt::format("{} is missing or something else, expected {}",
                                            printable(place.name), expected));
  }

  // matio leaves out the size of what it could not read.
  static bool has_size(const Place& place) {
    return place.variable != nullptr && place.variable->rank == 2 &&
           place.variable->dims != nullptr;
  }
  static std::size_t rows(const Place& place) {
    return has_size(place) ? place.variable->dims[0] : 0;
  }
  static std::size_t columns(const Place& place) {
    return has_size(place) ? place.variable->dims[1] : 0;
  }

  // Of that kind, with its data where it has any.
  static bool is(const Place& place, matio_classes kind) {
    if (!has_size(place) || place.variable->class_type != kind || place.variable->isComplex != 0)
      return false;
    const bool empty = rows(place) * columns(place) == 0 ||
                       (kind == MAT_C_STRUCT && Mat_VarGetNumberOfFields(place.variable) == 0);
    return empty || place.variable->data != nullptr;
  }

  // Likewise, as many entries of that type as its size says.
  static bool is(const Place& place, matio_classes kind, matio_types type, std::size_t entry) {
    return is(place, kind) && place.variable->data_type == type &&
           place.variable->nbytes == rows(place) * columns(place) * entry;
  }

  void require_struct(const Place& place, std::size_t count) const {
    if (!is(place, MAT_C_STRUCT) || columns(place) != 1 || rows(place) != count)
      refuse(place, "a struct, or a column of them");
  }

  static Place field(const Place& place, const std::string& name, std::size_t row = 0) {
    return {Mat_VarGetStructFieldByName(place.variable, name.c_str(), row),
            place.name + '.' + name};
  }

  [[nodiscard]] std::vector<double> numbers(const Place& place) const {
    if (!is(place, MAT_C_DOUBLE, MAT_T_DOUBLE, sizeof(double)) || columns(place) != 1)
      refuse(place, "a column of real numbers");
    const auto* const first = static_cast<const double*>(place.variable->data);
    return {first, first + rows(place)};
  }

  [[nodiscard]] double number(const Place& place) const {
    const std::vector<double> values = numbers(place);
    if (values.size() != 1) refuse(place, "one number");
    return values[0];
  }

  [[nodiscard]] std::string text(const Place& place) const {
    if (!is(place, MAT_C_CHAR, MAT_T_UTF16, sizeof(char16_t)) || rows(place) > 1)
      refuse(place, "a text in UTF-16");
    const std::optional<std::string> utf8 = internal::utf8_of(
        {static_cast<const char16_t*>(place.variable->data), rows(place) * columns(place)});
    if (!utf8) refuse(place, "a text in UTF-16");
    return *utf8;
  }

  void read_about(const Place& log, LogTable& result) const {
    const Place about = field(log, "about");
    require_struct(about, 1);
    const Place keys = field(log, "about_keys");
    if (!is(keys, MAT_C_CELL) || columns(keys) != 1 ||
        rows(keys) != Mat_VarGetNumberOfFields(about.variable))
      refuse(keys, "a column of cells, one for each field of about");
    for (std::size_t i = 0; i < rows(keys); ++i) {
      const std::string name = fmt::format("{}[{}]", about.name, i);
      result.about.emplace_back(
          text({Mat_VarGetCell(keys.variable, static_cast<int>(i)), keys.name}),
          text({Mat_VarGetStructFieldByIndex(about.variable, i, 0), name}));
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
      if (!is(place, MAT_C_STRUCT) || rows(place) * columns(place) != 1) place.variable = nullptr;
      place = field(place, std::string(path.substr(0, dot)));
      if (dot == std::string_view::npos) return place;
      path.remove_prefix(dot + 1);
    }
  }

  const std::string& origin_;
};

}  // namespace

LogTable internal::table_by_matio(const std::string& bytes, const std::string& origin) {
  internal::require_mat_v5(bytes, origin);
  const internal::MemoryFile file;
  file.write(bytes);
  const MatFile mat(Mat_Open(file.path().c_str(), MAT_ACC_RDONLY));
  const MatVariable log(mat ? Mat_VarRead(mat.get(), kMatVariable) : nullptr);
  if (!log)
    throw InvalidInput(
        origin,
        fmt::format("has no variable '{}', expected it as quadtune writes it", kMatVariable));
  return Reader(origin).table(log.get());
}

}  // namespace quadtune
