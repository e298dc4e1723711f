// SPDX-License-Identifier: Apache-2.0
#include "log_columns.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <istream>
#include <iterator>
#include <optional>
#include <string_view>

#include "number_arguments.hpp"
#include "program.hpp"
#include "quadtune/errors.hpp"
#include "quadtune/internal/suggest.hpp"
#include "quadtune/internal/text_file.hpp"

namespace quadtune::cli {
namespace {

constexpr std::size_t kLogLimit = std::size_t{1} << 30;  // [bytes]
constexpr std::string_view kBlank = " \t\r";

std::string_view trimmed(std::string_view text) {
  const std::size_t start = text.find_first_not_of(kBlank);
  if (start == std::string_view::npos) return {};
  return text.substr(start, text.find_last_not_of(kBlank) - start + 1);
}

/// Takes the next field off the front of a line. A comma or semicolon separates alone, blanks do
/// only where the line has none of these.
std::string_view next_field(std::string_view& line, char separator) {
  if (separator != ' ') {
    const std::size_t end = std::min(line.find(separator), line.size());
    const std::string_view field = trimmed(line.substr(0, end));
    line.remove_prefix(std::min(end + 1, line.size()));
    return field;
  }
  const std::size_t start = std::min(line.find_first_not_of(kBlank), line.size());
  line.remove_prefix(start);
  const std::string_view field = line.substr(0, line.find_first_of(kBlank));
  line.remove_prefix(field.size());
  line.remove_prefix(std::min(line.find_first_not_of(kBlank), line.size()));
  return field;
}

char separator_of(std::string_view line) {
  if (line.find(',') != std::string_view::npos) return ',';
  return line.find(';') != std::string_view::npos ? ';' : ' ';
}

std::vector<std::string> fields_of(std::string_view line) {
  std::vector<std::string> fields;
  const char separator = separator_of(line);
  while (!line.empty()) fields.emplace_back(next_field(line, separator));
  return fields;
}

bool is_number(const std::string& field) {
  double value = 0;
  return read_number(field, value);
}

std::optional<double> seconds_in(const std::string& unit) {
  if (unit == "s") return 1;
  if (unit == "ms") return 1e-3;
  if (unit == "us") return 1e-6;
  if (unit == "ns") return 1e-9;
  return std::nullopt;
}

}  // namespace

LogColumns::LogColumns(const std::string& path, std::istream& in)
    : file_(path == "-" ? "standard input" : path) {
  if (path == "-") {
    text_.assign(std::istreambuf_iterator<char>(in), {});
    internal::require_text(text_, file_, kLogLimit);
  } else {
    text_ = internal::read_text_file(path, kLogLimit);
  }
  std::string comment;
  int line = 0;
  for (std::size_t start = 0; start < text_.size();) {
    const std::size_t end = std::min(text_.find('\n', start), text_.size());
    const std::string_view row = trimmed(std::string_view(text_).substr(start, end - start));
    ++line;
    if (row.starts_with('#')) {
      if (rows_.empty()) comment = row.substr(1);
    } else if (!row.empty()) {
      const bool first = rows_.empty() && names_.empty();
      std::vector<std::string> fields;
      if (first) fields = fields_of(row);
      if (first && std::none_of(fields.begin(), fields.end(), is_number))
        read_header(std::string(row));
      else
        rows_.push_back({static_cast<std::size_t>(row.data() - text_.data()), row.size(), line});
    }
    start = end + 1;
  }
  if (rows_.empty()) throw InvalidInput(file_, "has no row of numbers, expected one a sample");
  const Row& first = rows_.front();
  if (names_.empty() &&
      fields_of(comment).size() ==
          fields_of(std::string_view(text_).substr(first.start, first.length)).size())
    read_header(comment);
}

void LogColumns::read_header(const std::string& header) {
  for (const std::string& field : fields_of(header)) {
    const std::size_t bracket = field.find('[');
    const bool has_unit = bracket != std::string::npos && field.back() == ']';
    names_.emplace_back(trimmed(field.substr(0, bracket)));
    units_.push_back(has_unit ? field.substr(bracket + 1, field.size() - bracket - 2) : "");
  }
}

bool LogColumns::has(const std::string& name) const {
  return std::find(names_.begin(), names_.end(), name) != names_.end();
}

std::string LogColumns::place(Eigen::Index row) const {
  return fmt::format("{}:{}", file_, rows_[static_cast<std::size_t>(row)].line);
}

std::size_t LogColumns::index_of(const std::string& column, const std::string& option) const {
  const auto named = std::find(names_.begin(), names_.end(), column);
  if (named != names_.end()) return static_cast<std::size_t>(named - names_.begin());
  const bool digits = !column.empty() && column.size() < 6 &&
                      column.find_first_not_of("0123456789") == std::string::npos;
  if (digits && std::stoul(column) >= 1) return std::stoul(column) - 1;
  throw InvalidInput(
      option, fmt::format("no column '{}' in {}, expected a number from 1{}{}",
                          internal::printable(column), file_,
                          names_.empty() ? ", because the log names none"
                                         : fmt::format(" or one of {}", fmt::join(names_, " ")),
                          internal::did_you_mean(column, names_)));
}

LogColumnValues LogColumns::column(const std::string& column, const std::string& option) const {
  const std::size_t index = index_of(column, option);
  LogColumnValues result;
  result.name = index < names_.size() ? names_[index] : fmt::format("column {}", index + 1);
  if (index < units_.size()) result.unit = units_[index];
  result.values.resize(std::ssize(rows_));
  for (Eigen::Index i = 0; i < result.values.size(); ++i) {
    const Row& row = rows_[static_cast<std::size_t>(i)];
    std::string_view rest = std::string_view(text_).substr(row.start, row.length);
    const char separator = separator_of(rest);
    std::string_view field;
    std::size_t at = 0;
    for (; at <= index && !rest.empty(); ++at) field = next_field(rest, separator);
    if (at <= index)
      throw InvalidInput(place(i), fmt::format("has {} fields, expected at least {} for {}", at,
                                               index + 1, result.name));
    if (!read_number(field, result.values(i)))
      throw InvalidInput(place(i), fmt::format("{} is '{}', expected a finite number", result.name,
                                               internal::printable(field)));
  }
  return result;
}

Eigen::VectorXd read_time(const LogColumns& log, const LogTime& time, Eigen::Index rows,
                          const std::string& verb) {
  if (time.column.empty() == (time.rate <= 0))
    throw UsageError(
        fmt::format("quadtune {}: {}, expected one of --rate HZ and --time COLUMN", verb,
                    time.column.empty() ? "no sample rate came" : "--rate and --time both came"),
        "--rate");
  if (time.column.empty())
    return Eigen::VectorXd::LinSpaced(rows, 0, static_cast<double>(rows - 1) / time.rate);
  LogColumnValues column = log.column(time.column, "--time");
  std::string unit = time.unit.empty() ? column.unit : time.unit;
  if (unit.empty()) unit = "s";
  const std::optional<double> seconds = seconds_in(unit);
  if (!seconds)
    throw UsageError(fmt::format("quadtune {}: the unit of time is '{}', expected --time-unit s, "
                                 "ms, us or ns",
                                 verb, internal::printable(unit)),
                     "--time-unit");
  // From the first on: nanoseconds of an epoch have more digits than a double holds of seconds.
  Eigen::VectorXd t = (column.values.array() - column.values(0)) * *seconds;
  for (Eigen::Index i = 1; i < t.size(); ++i)
    if (!(t(i) > t(i - 1)))
      throw InvalidInput(log.place(i),
                         fmt::format("{} is {} after {}, expected times that increase", column.name,
                                     column.values(i), column.values(i - 1)));
  return t;
}

double even_period(const LogColumns& log, const Eigen::VectorXd& t) {
  if (t.size() < 2) throw InvalidInput(log.file(), "has one row, expected samples");
  std::vector<double> steps(static_cast<std::size_t>(t.size() - 1));
  for (Eigen::Index i = 1; i < t.size(); ++i)
    steps[static_cast<std::size_t>(i - 1)] = t(i) - t(i - 1);
  std::vector<double> sorted = steps;
  const auto middle = sorted.begin() + std::ssize(sorted) / 2;
  std::nth_element(sorted.begin(), middle, sorted.end());
  for (std::size_t i = 0; i < steps.size(); ++i)
    if (steps[i] >= 1.5 * *middle)
      throw InvalidInput(log.place(static_cast<Eigen::Index>(i + 1)),
                         fmt::format("comes {:.6g} s after the row before, expected {:.6g} s (the "
                                     "median), because means over a gap would be of another length",
                                     steps[i], *middle));
  return (t(t.size() - 1) - t(0)) / static_cast<double>(t.size() - 1);
}

}  // namespace quadtune::cli
