// SPDX-License-Identifier: Apache-2.0
#include "quadtune/internal/read_number.hpp"

#include <charconv>
#include <cmath>

namespace quadtune::internal {

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
