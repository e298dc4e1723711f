// SPDX-License-Identifier: Apache-2.0
#include "quadtune/workbench/verify/uncertain_range.hpp"

#include <fmt/format.h>

#include <functional>

#include "quadtune/errors.hpp"
#include "quadtune/internal/text_file.hpp"
#include "quadtune/internal/words.hpp"

namespace quadtune {
namespace {

UncertainRange range_of(const std::string& text, const std::string& key,
                        const std::string& expected,
                        const std::function<bool(const UncertainRange&)>& is_right) {
  const std::size_t colon = text.find(':');
  const bool one = colon == std::string::npos;
  UncertainRange range;
  const bool numbers = internal::read_number(text.substr(0, colon), range.low) &&
                       (one || internal::read_number(text.substr(colon + 1), range.high));
  if (one) range.high = range.low;
  if (!numbers || !is_right(range))
    throw OptionError(
        key, fmt::format("{} is '{}', expected {}", key, internal::printable(text), expected));
  return range;
}

}  // namespace

UncertainRange uncertain_ratios(const std::string& text, const std::string& key) {
  return range_of(text, key, "LOW:HIGH, ratios to the file's value with 0 < LOW <= 1 <= HIGH",
                  [](const UncertainRange& r) { return r.low > 0 && r.low <= 1 && r.high >= 1; });
}

UncertainRange uncertain_delay(const std::string& text, const std::string& key) {
  return range_of(text, key, "LOW:HIGH [s] with 0 <= LOW <= HIGH",
                  [](const UncertainRange& r) { return r.low >= 0 && r.low <= r.high; });
}

UncertainRange uncertain_lag(const std::string& text, const std::string& key) {
  return range_of(text, key, "LOW:HIGH [s] with 0 < LOW <= HIGH, or 0 for motors without lag",
                  [](const UncertainRange& r) {
                    return (r.low > 0 && r.low <= r.high) || (r.low == 0 && r.high == 0);
                  });
}

}  // namespace quadtune
