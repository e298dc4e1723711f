// SPDX-License-Identifier: Apache-2.0
/// Reads numbers as the uquad flight program scans them, and rejects what it would misread.
#pragma once

#include <fmt/format.h>

#include <algorithm>
#include <charconv>
#include <cmath>
#include <string>
#include <vector>

#include "quadtune/errors.hpp"
#include "quadtune/internal/text_file.hpp"

namespace quadtune::exports {

/// @throws InvalidInput  if a word is not a finite number, or has a decimal comma
inline double number_of_word(const std::string& word, const std::string& where) {
  if (word.find(',') != std::string::npos)
    throw InvalidInput(where, fmt::format("'{}' has a comma, expected a decimal point, because the "
                                          "flight program stops reading at a comma",
                                          internal::printable(word)));
  const std::size_t plus = word.front() == '+' && word.compare(0, 2, "+-") != 0 ? 1 : 0;
  double number = 0;
  const char* end = word.data() + word.size();
  const auto [stopped, error] = std::from_chars(word.data() + plus, end, number);
  if (error != std::errc() || stopped != end || !std::isfinite(number))
    throw InvalidInput(where,
                       fmt::format("'{}' is not a finite number, expected a number such as 0.01",
                                   internal::printable(word)));
  return number;
}

/// Parses the numbers of a line, separated by blanks.
inline std::vector<double> numbers_of_line(const std::string& line, const std::string& where) {
  std::vector<double> numbers;
  for (std::size_t i = line.find_first_not_of(" \t\r"); i != std::string::npos;) {
    const std::size_t end = std::min(line.find_first_of(" \t\r", i), line.size());
    numbers.push_back(number_of_word(line.substr(i, end - i), where));
    i = line.find_first_not_of(" \t\r", end);
  }
  return numbers;
}

}  // namespace quadtune::exports
