// SPDX-License-Identifier: Apache-2.0
#include "quadtune/text_matrix.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <charconv>
#include <cmath>
#include <string_view>
#include <system_error>
#include <vector>

#include "quadtune/errors.hpp"
#include "quadtune/internal/counted.hpp"
#include "quadtune/internal/text_file.hpp"

namespace quadtune {
namespace {

bool is_blank(char c) { return c == ' ' || c == '\t' || c == '\r' || c == '\v' || c == '\f'; }

std::string_view trimmed(std::string_view line) {
  line = line.substr(0, line.find('#'));
  while (!line.empty() && is_blank(line.front())) line.remove_prefix(1);
  while (!line.empty() && is_blank(line.back())) line.remove_suffix(1);
  return line;
}

// "0,5 1,5" is two numbers in many locales and four to a reader that splits at commas: if blanks
// separate numbers, a comma between two nonblank characters is a decimal comma.
bool has_decimal_comma(std::string_view line) {
  bool tight_comma = false;
  bool blank = false;
  for (std::size_t i = 0; i < line.size(); ++i) {
    blank = blank || is_blank(line[i]);
    tight_comma = tight_comma || (line[i] == ',' && i > 0 && i + 1 < line.size() &&
                                  !is_blank(line[i - 1]) && !is_blank(line[i + 1]));
  }
  return tight_comma && blank;
}

double parse_number(std::string_view word, const std::string& where) {
  std::string_view digits = word;
  if (digits.size() > 1 && digits[0] == '+' && digits[1] != '-') digits.remove_prefix(1);
  double value = 0;
  const auto [end, error] = std::from_chars(digits.data(), digits.data() + digits.size(), value);
  if (error == std::errc::result_out_of_range)
    throw InvalidInput(where, fmt::format("'{}' is beyond the range of a double, expected at most "
                                          "1.8e308 and at least 4.9e-324 in magnitude",
                                          internal::printable(word)));
  if (word.starts_with("\xef\xbb\xbf"))  // invisible in an editor, so the message mentions it
    throw InvalidInput(
        where, fmt::format("'{}' is not a number but begins with a UTF-8 byte order mark, expected "
                           "a file without one",
                           internal::printable(word)));
  if (error != std::errc() || end != digits.data() + digits.size())
    throw InvalidInput(
        where, fmt::format("'{}' is not a number, expected numbers separated by blanks or commas",
                           internal::printable(word)));
  if (!std::isfinite(value))
    throw InvalidInput(where, fmt::format("'{}' is not finite, expected finite numbers",
                                          internal::printable(word)));
  return value;
}

// Appends the numbers of one line to `values` and returns their count.
std::size_t parse_row(std::string_view line, const std::string& where,
                      std::vector<double>& values) {
  if (has_decimal_comma(line))
    throw InvalidInput(where,
                       fmt::format("'{}' has commas within numbers and blanks between "
                                   "them, expected a dot as the decimal sign, or ', ' after each "
                                   "number",
                                   internal::printable(line)));
  std::size_t count = 0;
  std::size_t i = 0;
  while (true) {
    while (i < line.size() && is_blank(line[i])) ++i;
    const std::size_t start = i;
    while (i < line.size() && !is_blank(line[i]) && line[i] != ',') ++i;
    if (start == i)
      throw InvalidInput(where,
                         "no number before or after a comma, expected a number on each side of it");
    values.push_back(parse_number(line.substr(start, i - start), where));
    ++count;
    while (i < line.size() && is_blank(line[i])) ++i;
    if (i == line.size()) return count;
    if (line[i] == ',') ++i;
  }
}

}  // namespace

Eigen::MatrixXd parse_text_matrix(const std::string& text, const std::string& origin) {
  internal::require_text(text, origin, kMatrixTextLimit);
  std::vector<double> values;
  std::size_t rows = 0;
  std::size_t cols = 0;
  std::size_t number = 0;
  for (std::size_t start = 0; start < text.size();) {
    const std::size_t end = std::min(text.find('\n', start), text.size());
    const std::string_view line = trimmed(std::string_view(text).substr(start, end - start));
    start = end + 1;
    ++number;
    if (line.empty()) continue;
    const std::string where = fmt::format("{}:{}", origin, number);
    const std::size_t count = parse_row(line, where, values);
    if (++rows == 1) cols = count;
    if (count != cols)
      throw InvalidInput(where, fmt::format("row has {}, expected {} as in row 1",
                                            internal::counted(count, "number"), cols));
  }
  if (rows == 0)
    throw InvalidInput(origin, "has no numbers, expected a row of numbers on each line");
  return Eigen::Map<const Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>>(
      values.data(), static_cast<Eigen::Index>(rows), static_cast<Eigen::Index>(cols));
}

Eigen::MatrixXd read_text_matrix(const std::string& path) {
  return parse_text_matrix(internal::read_text_file(path, kMatrixTextLimit),
                           path == "-" ? "standard input" : path);
}

}  // namespace quadtune
