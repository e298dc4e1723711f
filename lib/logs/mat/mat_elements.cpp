// SPDX-License-Identifier: Apache-2.0
// Source: The MathWorks, "MAT-File Format", level 5.
#include "logs/mat/mat_elements.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <string_view>

#include "quadtune/errors.hpp"

namespace quadtune::internal {
namespace {

constexpr std::size_t kHeaderSize = 128;  // [bytes]
constexpr std::size_t kTagSize = 8;       // [bytes]
constexpr std::uint32_t kInt32 = 5;
constexpr std::uint32_t kUint32 = 6;
constexpr std::uint32_t kMatrix = 14;
constexpr std::uint32_t kCompressed = 15;
constexpr std::size_t kMostDimensions = 16;
constexpr int kDeepest = 32;  // far more than a log has, far less than the stack holds

template <typename Number>
Number number_at(std::string_view bytes, std::size_t at) {
  Number value;
  std::memcpy(&value, bytes.data() + at, sizeof value);
  return value;
}

struct Element {
  std::uint32_t type;
  std::string_view data;
};

class Elements {
 public:
  Elements(std::string_view bytes, const std::string& origin) : bytes_(bytes), origin_(origin) {}

  void check() {
    for (std::size_t at = kHeaderSize; at < bytes_.size();) {
      const Element element = next(at, bytes_.size());
      if (element.type == kCompressed)
        throw InvalidInput(origin_,
                           "is compressed, expected a MAT file that is not: save it with -v6");
      if (element.type == kMatrix) check_matrix(element, 1);
    }
  }

 private:
  [[noreturn]] void refuse(std::size_t at, const std::string& what) const {
    throw InvalidInput(
        origin_, fmt::format("{} at offset {}, expected a whole MAT v5 file; is it cut short or "
                             "damaged?",
                             what, at));
  }

  [[nodiscard]] std::size_t offset(std::string_view data) const {
    return static_cast<std::size_t>(data.data() - bytes_.data());
  }

  // The element at `at`, which moves behind it.
  Element next(std::size_t& at, std::size_t end) const {
    const std::size_t start = at;
    if (end - at < kTagSize) refuse(start, "an element has no whole tag");
    auto type = number_at<std::uint32_t>(bytes_, at);
    std::size_t size = number_at<std::uint32_t>(bytes_, at + 4);
    const bool small = type > 0xffff;  // up to four bytes, in the tag itself
    if (small) {
      size = type >> 16U;
      type &= 0xffffU;
    }
    const std::size_t data = at + (small ? 4 : kTagSize);
    if (size > (small ? 4 : end - data))
      refuse(start, fmt::format("an element claims {} bytes of {}", size, small ? 4 : end - data));
    at = small ? at + kTagSize : std::min(end, data + (size + 7) / 8 * 8);
    return {type, bytes_.substr(data, size)};
  }

  // Parts of an array, in order: flags with its class, dimensions, name, then data or what it
  // holds.
  void check_matrix(const Element& matrix, int depth) {
    if (depth > kDeepest) refuse(offset(matrix.data), fmt::format("an array lies {} deep", depth));
    std::size_t at = offset(matrix.data);
    const std::size_t end = at + matrix.data.size();
    bool plain = false;  // numbers or letters
    std::int64_t entries = 0;
    int parts = 0;
    for (; at < end; ++parts) {
      const Element part = next(at, end);
      if (parts == 0) plain = is_plain(part);
      if (parts == 1) entries = entries_of(part, matrix.data.size());
      if (parts == 3 && plain) check_data(part, entries);
      if (part.type == kMatrix) check_matrix(part, depth + 1);
    }
    if (plain && entries > 0 && parts < 4) refuse(end, "an array ends before its data");
  }

  [[nodiscard]] bool is_plain(const Element& flags) const {
    if (flags.type != kUint32 || flags.data.size() != 2 * sizeof(std::uint32_t))
      refuse(offset(flags.data), "an array does not begin with its flags");
    const std::uint32_t kind = number_at<std::uint32_t>(flags.data, 0) & 0xffU;
    constexpr std::uint32_t kCharacters = 4;
    constexpr std::uint32_t kDouble = 6;
    constexpr std::uint32_t kLastInteger = 15;
    return kind == kCharacters || (kind >= kDouble && kind <= kLastInteger);
  }

  // Each entry of what a log holds takes a byte or more.
  [[nodiscard]] std::int64_t entries_of(const Element& dimensions, std::size_t most) const {
    const std::size_t count = dimensions.data.size() / sizeof(std::int32_t);
    if (dimensions.type != kInt32 || count < 2 || count > kMostDimensions ||
        dimensions.data.size() % sizeof(std::int32_t) != 0)
      refuse(offset(dimensions.data),
             fmt::format("an array has other than 2 to {} dimensions", kMostDimensions));
    std::int64_t entries = 1;
    bool too_many = false;
    std::string extents;
    for (std::size_t i = 0; i < count; ++i) {
      const auto extent = number_at<std::int32_t>(dimensions.data, i * sizeof(std::int32_t));
      extents += fmt::format("{}{}", i > 0 ? " x " : "", extent);
      too_many = too_many || extent < 0 ||
                 (extent > 0 && entries > static_cast<std::int64_t>(most) / extent);
      if (!too_many) entries *= extent;
    }
    if (too_many)
      refuse(offset(dimensions.data), fmt::format("an array claims {} entries", extents));
    return entries;
  }

  void check_data(const Element& data, std::int64_t entries) const {
    // Bytes of an entry by type, 0 for what is none: int8, uint8, … as the format numbers them.
    constexpr std::array<std::int64_t, 19> kWidths = {0, 1, 1, 2, 2, 4, 4, 4, 0, 8,
                                                      0, 0, 8, 8, 0, 0, 1, 2, 4};
    const std::int64_t width = data.type < kWidths.size() ? kWidths[data.type] : 0;
    if (width == 0 || entries * width != static_cast<std::int64_t>(data.data.size()))
      refuse(offset(data.data), fmt::format("an array of {} entries has {} bytes of type {}",
                                            entries, data.data.size(), data.type));
  }

  std::string_view bytes_;
  const std::string& origin_;
};

}  // namespace

void require_mat_header(std::string_view bytes, const std::string& origin) {
  constexpr std::string_view kHdf5 = "\x89HDF\r\n\x1a\n";
  constexpr std::size_t kHdf5Offset = 512;  // behind the header of a v7.3 file
  if (bytes.starts_with(kHdf5) ||
      bytes.substr(std::min(kHdf5Offset, bytes.size())).starts_with(kHdf5))
    throw InvalidInput(origin,
                       "is a MAT v7.3 file, which is HDF5, expected MAT v5: save it with -v6");
  if (bytes.size() < kHeaderSize)
    throw InvalidInput(origin, fmt::format("has {} bytes, expected a MAT v5 file, which has a "
                                           "header of {}",
                                           bytes.size(), kHeaderSize));
  const auto version = number_at<std::uint16_t>(bytes, 124);
  const auto order = number_at<std::uint16_t>(bytes, 126);
  if (order == 0x494d)
    throw InvalidInput(origin,
                       "was written on a machine of the other byte order, expected this "
                       "machine's");
  if (order != 0x4d49 || version != 0x0100)
    throw InvalidInput(origin, "is no MAT v5 file, expected one: its header says otherwise");
}

void require_mat_v5(const std::string& bytes, const std::string& origin) {
  require_mat_header(bytes, origin);
  Elements(bytes, origin).check();
}

}  // namespace quadtune::internal
