// SPDX-License-Identifier: Apache-2.0
#include "arguments/matrix_arguments.hpp"

#include <fmt/format.h>

#include <cmath>
#include <filesystem>
#include <istream>
#include <optional>
#include <system_error>

#include "arguments/read_number.hpp"
#include "program/program.hpp"
#include "quadtune/internal/text_file.hpp"
#include "quadtune/text_matrix.hpp"

namespace quadtune::cli {

namespace {

/// "0 1; 0 0", "[0 1; 0 0]" or "[[0, 1], [0, 0]]" as the lines of a matrix file; nothing for other
/// words, and for the name of a file.
std::optional<std::string> matrix_lines(const std::string& word) {
  std::error_code ignored;  // a word too long for a file's name is none
  const bool numbers = word.find_first_not_of("0123456789+-.,eE;[] \t\n") == std::string::npos &&
                       word.find_first_of("0123456789") != std::string::npos;
  const bool bracketed = word.starts_with('[') || word.find(';') != std::string::npos;
  if (!(numbers || bracketed) || std::filesystem::exists(word, ignored)) return std::nullopt;
  std::string lines;
  bool row_ended = false;  // a comma after that separates rows
  for (const char c : word) {
    if (c == ';' || c == ']')
      lines += '\n';
    else if (c == '[' || (c == ',' && row_ended))
      lines += ' ';
    else
      lines += c;
    row_ended = c == ']' || (row_ended && (c == ',' || c == ' '));
  }
  return lines;
}

}  // namespace

Eigen::MatrixXd read_matrix(const std::string& path, std::istream& in) {
  if (path.empty()) return {};
  if (const auto lines = matrix_lines(path))
    return parse_text_matrix(*lines, fmt::format("'{}'", internal::printable(path)));
  if (path != "-") return read_text_matrix(path);
  // One byte beyond the limit tells that there is too much; an endless input ends there. Past the
  // stream, as an exception of its buffer (a signal came) does not leave the stream.
  std::string text(kMatrixTextLimit + 1, '\0');
  std::size_t size = 0;
  while (size < text.size()) {
    const std::streamsize got =
        in.rdbuf()->sgetn(text.data() + size, static_cast<std::streamsize>(text.size() - size));
    if (got <= 0) break;
    size += static_cast<std::size_t>(got);
  }
  text.resize(size);
  return parse_text_matrix(text, "standard input");
}

Eigen::MatrixXd require_matrix(const std::string& path, std::istream& in, const std::string& verb,
                               const std::string& option) {
  if (path.empty())
    throw UsageError(
        fmt::format("quadtune {}: {} is missing, expected a matrix file", verb, option), option);
  return read_matrix(path, in);
}

std::vector<std::string> word_list(const std::string& text) {
  return internal::comma_separated(text);
}

std::vector<double> number_list(const std::string& text, const std::string& verb,
                                const std::string& option) {
  std::vector<double> numbers;
  for (const std::string& word : word_list(text)) {
    double value = 0;
    if (!read_number(word, value))
      throw UsageError(
          fmt::format(
              "quadtune {}: {}: '{}' is not a finite number, expected numbers separated by commas",
              verb, option, word),
          option);
    numbers.push_back(value);
  }
  return numbers;
}

Eigen::VectorXd coefficients(const std::string& text, const std::string& verb,
                             const std::string& option) {
  if (text.empty())
    throw UsageError(fmt::format("quadtune {}: {} is missing, expected coefficients in descending "
                                 "powers, e.g. 1,6,11,6",
                                 verb, option),
                     option);
  const std::vector<double> values = number_list(text, verb, option);
  return Eigen::VectorXd::Map(values.data(), static_cast<Eigen::Index>(values.size()));
}

Eigen::MatrixXd diagonal_weights(const std::string& text, std::size_t count,
                                 const std::string& what, const std::string& verb,
                                 const std::string& option) {
  std::vector<double> numbers = number_list(text, verb, option);
  for (const double weight : numbers)
    if (weight < 0)
      throw UsageError(fmt::format("quadtune {}: {}: {} is negative, expected weights of 0 or more",
                                   verb, option, weight),
                       option);
  if (numbers.size() == 1) numbers.assign(count, numbers[0]);
  if (numbers.size() != count)
    throw UsageError(fmt::format("quadtune {}: {} has {} entries, expected {} or one for all ({})",
                                 verb, option, numbers.size(), count, what),
                     option);
  return Eigen::Map<const Eigen::VectorXd>(numbers.data(), static_cast<Eigen::Index>(count))
      .asDiagonal();
}

void require_positive(double value, const std::string& verb, const std::string& option,
                      const std::string& unit) {
  if (!(value > 0) || !std::isfinite(value))
    throw UsageError(fmt::format("quadtune {}: {} is {}, expected a positive number of {}", verb,
                                 option, value, unit),
                     option);
}

}  // namespace quadtune::cli
