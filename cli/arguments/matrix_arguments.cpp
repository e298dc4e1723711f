// SPDX-License-Identifier: Apache-2.0
#include "arguments/matrix_arguments.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cctype>
#include <cmath>
#include <istream>

#include "program/program.hpp"
#include "program/refusal.hpp"
#include "quadtune/internal/text_file.hpp"
#include "quadtune/internal/words.hpp"
#include "quadtune/text_matrix.hpp"
#include "quadtune/workbench/files/matrix_word.hpp"
#include "report/text/print.hpp"

namespace quadtune::cli {
namespace {

/// Whether the word is a number that no matrix may have, such as "-inf" or "NaN".
bool is_not_finite(std::string word) {
  if (word.starts_with('-') || word.starts_with('+')) word.erase(0, 1);
  std::transform(word.begin(), word.end(), word.begin(),
                 [](unsigned char c) { return static_cast<char>(std::tolower(c)); });
  return word == "inf" || word == "infinity" || word == "nan";
}

}  // namespace

Eigen::MatrixXd read_matrix(const std::string& path, std::istream& in, const std::string& option) {
  if (path.empty()) return {};
  if (const auto lines = matrix_lines(path))  // the matrix is part of the command line
    return parse_text_matrix(*lines, fmt::format("{} '{}'", option, internal::printable(path)));
  if (is_not_finite(path))
    refuse(option, "{} is '{}', expected finite numbers or a matrix file", option, path);
  if (path != "-") return read_text_matrix(path);
  // Reads at most one byte more than the limit, which is enough to reject an input that is too
  // long. Reads from the buffer directly, because a stream would swallow an exception of its buffer
  // (after a signal).
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

Eigen::MatrixXd require_matrix(const std::string& path, std::istream& in,
                               const std::string& option) {
  if (path.empty()) refuse(option, "{} is missing, expected a matrix file", option);
  return read_matrix(path, in, option);
}

std::vector<std::string> word_list(const std::string& text) {
  return internal::comma_separated(text);
}

std::vector<double> number_list(const std::string& text, const std::string& option) {
  std::vector<double> numbers;
  for (const std::string& word : word_list(text)) {
    double value = 0;
    if (!internal::read_number(word, value))
      refuse(option, "{}: '{}' is not a finite number, expected numbers separated by commas",
             option, word);
    numbers.push_back(value);
  }
  return numbers;
}

Eigen::VectorXd coefficients(const std::string& text, const std::string& option) {
  if (text.empty())
    refuse(option, "{} is missing, expected coefficients in descending powers, e.g. 1,6,11,6",
           option);
  const std::vector<double> values = number_list(text, option);
  return Eigen::VectorXd::Map(values.data(), static_cast<Eigen::Index>(values.size()));
}

Eigen::MatrixXd diagonal_weights(const std::string& text, std::size_t count,
                                 const std::string& what, const std::string& option) {
  std::vector<double> numbers = number_list(text, option);
  for (const double weight : numbers)
    if (weight < 0)
      refuse(option, "{}: {} is negative, expected weights of 0 or more", option, weight);
  if (numbers.size() == 1) numbers.assign(count, numbers[0]);
  if (numbers.size() != count)
    refuse(option, "{} has {} entries, expected {} or a single one for all ({})", option,
           numbers.size(), count, what);
  return Eigen::Map<const Eigen::VectorXd>(numbers.data(), static_cast<Eigen::Index>(count))
      .asDiagonal();
}

void require_time(const TimeArguments& time) {
  if (time.count() == 0)
    refuse(
        "--discrete",
        "expected --discrete, --continuous or --sampled DT; the matrices alone do not show whether "
        "the system is discrete");
}

void note_period(const TimeArguments& time, const std::optional<double>& dt,
                 const Context& context) {
  if (time.discrete && !dt)
    context.note("note: the sample period is not known: times and frequencies are for 1 s");
}

void require_one_time(const TimeArguments& time) {
  if (time.count() > 1)
    refuse(
        time.sampled ? "--sampled" : "--discrete",
        "more than one of --continuous, --discrete and --sampled was given; expected one of them");
}

void require_not_negative(double value, const std::string& option) {
  if (value < 0) refuse(option, "{} is {} s, expected 0 or more", option, number(value));
}

void require_positive(double value, const std::string& option, const std::string& unit) {
  if (!(value > 0) || !std::isfinite(value))
    refuse(option, "{} is {}, expected a positive number of {}", option, value, unit);
}

}  // namespace quadtune::cli
