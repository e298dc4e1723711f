// SPDX-License-Identifier: Apache-2.0
#include "quadtune/internal/joined.hpp"

namespace quadtune::internal {
namespace {

template <class Words>
std::string all_of(const Words& words, std::string_view separator) {
  std::string text;
  bool first = true;
  for (const auto& word : words) {
    if (!first) text += separator;
    first = false;
    text += word;
  }
  return text;
}

}  // namespace

std::string joined(const std::vector<std::string>& words, std::string_view separator) {
  return all_of(words, separator);
}

std::string joined(const std::set<std::string>& words, std::string_view separator) {
  return all_of(words, separator);
}

std::string joined(std::span<const char* const> words, std::string_view separator) {
  return all_of(words, separator);
}

std::string joined(std::span<const std::string_view> words, std::string_view separator) {
  return all_of(words, separator);
}

}  // namespace quadtune::internal
