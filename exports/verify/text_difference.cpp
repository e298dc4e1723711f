// SPDX-License-Identifier: Apache-2.0
#include "quadtune/exports/text_difference.hpp"

#include <algorithm>
#include <cctype>
#include <cmath>
#include <cstdlib>
#include <sstream>
#include <vector>

namespace quadtune {
namespace {

/// A line split into words and numbers. A digit within a name belongs to the name.
struct LineParts {
  std::string words;
  std::vector<double> numbers;
};

LineParts parts_of(const std::string& line) {
  LineParts parts;
  const auto is = [&](int (*kind)(int), std::size_t at) {
    return at < line.size() && kind(static_cast<unsigned char>(line[at])) != 0;
  };
  const auto in_name = [&](std::size_t at) { return is(std::isalnum, at) || line[at] == '_'; };
  for (std::size_t at = 0; at < line.size();) {
    // The sign belongs to the number, because rounding can change the sign of small numbers.
    const std::size_t first = line[at] == '-' || line[at] == '+' ? at + 1 : at;
    const bool digits = is(std::isdigit, first) ||
                        (first < line.size() && line[first] == '.' && is(std::isdigit, first + 1));
    if (!digits || (at > 0 && in_name(at - 1))) {
      // Columns of numbers are padded with blanks.
      const bool blank = line[at] == ' ' && parts.words.ends_with(' ');
      if (!blank) parts.words += line[at];
      ++at;
      continue;
    }
    char* end = nullptr;
    const double number = std::strtod(line.c_str() + at, &end);
    const auto stop = static_cast<std::size_t>(end - line.c_str());
    if (std::isfinite(number)) {
      parts.numbers.push_back(number);
      parts.words += '#';
    } else {
      parts.words += line.substr(at, stop - at);
    }
    at = stop;
  }
  return parts;
}

}  // namespace

std::size_t first_other_line(const std::string& a, const std::string& b) {
  std::size_t line = 1;
  const std::size_t common = std::min(a.size(), b.size());
  for (std::size_t i = 0; i < common; ++i) {
    if (a[i] != b[i]) return line;
    if (a[i] == '\n') ++line;
  }
  return a.size() == b.size() ? 0 : line;
}

std::optional<double> numbers_apart(const std::string& a, const std::string& b) {
  std::istringstream lines_a(a), lines_b(b);
  double worst = 0;
  for (std::string line_a, line_b;;) {
    const bool more_a = static_cast<bool>(std::getline(lines_a, line_a));
    const bool more_b = static_cast<bool>(std::getline(lines_b, line_b));
    if (more_a != more_b) return {};
    if (!more_a) return worst;
    if (line_a == line_b) continue;
    const LineParts of_a = parts_of(line_a), of_b = parts_of(line_b);
    if (of_a.words != of_b.words || of_a.numbers.size() != of_b.numbers.size()) return {};
    double largest = 0, apart = 0;
    for (std::size_t i = 0; i < of_a.numbers.size(); ++i) {
      largest = std::max({largest, std::abs(of_a.numbers[i]), std::abs(of_b.numbers[i])});
      apart = std::max(apart, std::abs(of_a.numbers[i] - of_b.numbers[i]));
    }
    if (apart > 0) worst = std::max(worst, apart / largest);
  }
}

}  // namespace quadtune
