// SPDX-License-Identifier: Apache-2.0
#include "quadtune/workbench/files/matrix_word.hpp"

#include <filesystem>
#include <system_error>

namespace quadtune {

std::optional<std::string> matrix_lines(const std::string& word) {
  std::error_code ignored;  // e.g. a word that is too long for a file name
  const bool numbers = word.find_first_not_of("0123456789+-.,eE;[] \t\n") == std::string::npos &&
                       word.find_first_of("0123456789") != std::string::npos;
  const bool bracketed = word.starts_with('[') || word.find(';') != std::string::npos;
  if (!(numbers || bracketed) || std::filesystem::exists(word, ignored)) return std::nullopt;
  std::string lines;
  bool row_ended = false;  // a comma after a row separates rows
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

}  // namespace quadtune
