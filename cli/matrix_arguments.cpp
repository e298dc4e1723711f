// SPDX-License-Identifier: Apache-2.0
#include "matrix_arguments.hpp"

#include <fmt/format.h>

#include <cmath>
#include <istream>
#include <iterator>

#include "number_arguments.hpp"
#include "program.hpp"
#include "quadtune/text_matrix.hpp"

namespace quadtune::cli {

Eigen::MatrixXd read_matrix(const std::string& path, std::istream& in) {
  if (path.empty()) return {};
  if (path != "-") return read_text_matrix(path);
  return parse_text_matrix(
      std::string(std::istreambuf_iterator<char>(in), std::istreambuf_iterator<char>()),
      "standard input");
}

Eigen::MatrixXd require_matrix(const std::string& path, std::istream& in, const std::string& verb,
                               const std::string& option) {
  if (path.empty())
    throw UsageError(
        fmt::format("quadtune {}: {} is missing, expected a matrix file", verb, option), option);
  return read_matrix(path, in);
}

std::vector<std::string> word_list(const std::string& text) {
  std::vector<std::string> words;
  std::size_t start = 0;
  while (start < text.size()) {
    const std::size_t end = std::min(text.find(',', start), text.size());
    words.push_back(text.substr(start, end - start));
    start = end + 1;
  }
  if (!text.empty() && text.back() == ',') words.emplace_back();
  return words;
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

void require_positive(double value, const std::string& verb, const std::string& option) {
  if (!(value > 0) || !std::isfinite(value))
    throw UsageError(fmt::format("quadtune {}: {} is {}, expected a positive number of seconds",
                                 verb, option, value),
                     option);
}

}  // namespace quadtune::cli
