// SPDX-License-Identifier: Apache-2.0
#include "quadtune/internal/words.hpp"

#include <algorithm>
#include <charconv>
#include <cmath>

namespace quadtune::internal {

std::vector<std::string> comma_separated(const std::string& text) {
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

bool read_number(std::string_view word, double& value) {
  if (word.size() > 1 && word[0] == '+' && word[1] != '-') word.remove_prefix(1);
  double number = 0;
  const char* end = word.data() + word.size();
  const auto [stop, error] = std::from_chars(word.data(), end, number);
  if (error != std::errc() || stop != end || !std::isfinite(number)) return false;
  value = number;
  return true;
}

}  // namespace quadtune::internal
