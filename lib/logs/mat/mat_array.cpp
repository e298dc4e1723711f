// SPDX-License-Identifier: Apache-2.0
#include "logs/mat/mat_array.hpp"

#include <algorithm>
#include <cstdint>
#include <cstring>

#include "logs/formats/unicode.hpp"

namespace quadtune::internal {
namespace {

template <typename Number>
double number_at(std::string_view data, std::size_t index) {
  Number value;
  std::memcpy(&value, data.data() + index * sizeof value, sizeof value);
  return static_cast<double>(value);
}

}  // namespace

std::size_t width_of(MatType type) {
  switch (type) {
    case MatType::int8:
    case MatType::uint8:
    case MatType::utf8:
      return 1;
    case MatType::int16:
    case MatType::uint16:
    case MatType::utf16:
      return 2;
    case MatType::int32:
    case MatType::uint32:
    case MatType::float32:
    case MatType::utf32:
      return 4;
    case MatType::float64:
    case MatType::int64:
    case MatType::uint64:
      return 8;
    default:
      return 0;
  }
}

std::size_t MatArray::entries() const {
  std::size_t count = dimensions.empty() ? 0 : 1;
  for (const std::size_t extent : dimensions) count *= extent;
  return count;
}

const MatArray* MatArray::field(std::string_view wanted, std::size_t index) const {
  const auto at = std::find(fields.begin(), fields.end(), wanted);
  if (at == fields.end() || index >= entries()) return nullptr;
  return &parts[index * fields.size() + static_cast<std::size_t>(at - fields.begin())];
}

double MatArray::number(std::size_t index) const {
  switch (type) {
    case MatType::int8:
      return number_at<std::int8_t>(data, index);
    case MatType::int16:
      return number_at<std::int16_t>(data, index);
    case MatType::uint16:
    case MatType::utf16:
      return number_at<std::uint16_t>(data, index);
    case MatType::int32:
      return number_at<std::int32_t>(data, index);
    case MatType::uint32:
    case MatType::utf32:
      return number_at<std::uint32_t>(data, index);
    case MatType::float32:
      return number_at<float>(data, index);
    case MatType::float64:
      return number_at<double>(data, index);
    case MatType::int64:
      return number_at<std::int64_t>(data, index);
    case MatType::uint64:
      return number_at<std::uint64_t>(data, index);
    default:
      return number_at<std::uint8_t>(data, index);
  }
}

std::optional<std::string> MatArray::utf16_text() const {
  if (kind != MatClass::text || width_of(type) != sizeof(char16_t)) return std::nullopt;
  std::u16string units(entries(), u'\0');
  std::memcpy(units.data(), data.data(), data.size());
  return utf8_of(units);
}

}  // namespace quadtune::internal
