// SPDX-License-Identifier: Apache-2.0
// Source: The MathWorks, "MAT-File Format", level 5.
#include "logs/mat/mat_elements.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <string_view>

#include "quadtune/errors.hpp"

namespace quadtune::internal {
namespace {

constexpr std::size_t kMaxDimensions = 16;
constexpr int kMaxDepth = 32;  // far more than a log needs, far less than the stack allows

template <typename Number>
Number element_number(std::string_view bytes, std::size_t at) {
  Number value;
  std::memcpy(&value, bytes.data() + at, sizeof value);
  return value;
}

struct Element {
  MatType type;
  std::string_view data;
};

class Parser {
 public:
  Parser(std::string_view bytes, const std::string& origin, MemoryBudget& budget)
      : bytes_(bytes), origin_(origin), budget_(budget) {}

  std::vector<MatArray> variables() {
    std::vector<MatArray> found;
    for (std::size_t at = kMatHeaderSize; at < bytes_.size();) {
      const Element element = next(at, bytes_.size());
      if (element.type == MatType::compressed)
        throw InvalidInput(origin_,
                           "is compressed, expected an uncompressed MAT file: save it with -v6");
      if (element.type == MatType::matrix) found.push_back(array_of(element, 1));
    }
    return found;
  }

 private:
  [[noreturn]] void refuse(std::size_t at, const std::string& what) const {
    throw InvalidInput(
        origin_, fmt::format("{} at offset {}, expected a complete MAT v5 file; is it cut short or "
                             "damaged?",
                             what, at));
  }

  [[nodiscard]] std::size_t offset(std::string_view data) const {
    return static_cast<std::size_t>(data.data() - bytes_.data());
  }

  // Reads the element at `at` and moves `at` behind it.
  Element next(std::size_t& at, std::size_t end) const {
    const std::size_t start = at;
    if (end - at < kMatTagSize) refuse(start, "an element has no complete tag");
    auto type = element_number<std::uint32_t>(bytes_, at);
    std::size_t size = element_number<std::uint32_t>(bytes_, at + 4);
    const bool small = type > 0xffff;  // up to four bytes, within the tag
    if (small) {
      size = type >> 16U;
      type &= 0xffffU;
    }
    const std::size_t data = at + (small ? 4 : kMatTagSize);
    if (size > (small ? 4 : end - data))
      refuse(start, fmt::format("an element claims {} bytes of {}", size, small ? 4 : end - data));
    at = small ? at + kMatTagSize : std::min(end, data + (size + 7) / 8 * 8);
    return {MatType{type}, bytes_.substr(data, size)};
  }

  // Reads an array. Its elements are, in this order: flags, dimensions, name; then numbers or
  // characters; or the length of a name, the names and the arrays of a struct; or the arrays of a
  // cell.
  MatArray array_of(const Element& matrix, int depth) {
    if (depth > kMaxDepth)
      refuse(offset(matrix.data), fmt::format("an array is nested {} deep", depth));
    budget_.charge(sizeof(MatArray));
    MatArray array;
    std::size_t at = offset(matrix.data);
    const std::size_t end = at + matrix.data.size();
    std::size_t name_length = 0;
    int count = 0;
    for (; at < end; ++count) {
      const Element element = next(at, end);
      if (count == 0) read_flags(element, array);
      if (count == 1) read_dimensions(element, matrix.data.size(), array);
      if (count == 2) array.name = text_before_nul(element.data);
      if (count == 3 && has_data(array)) read_data(element, array);
      if (count == 3 && array.kind == MatClass::structure) name_length = name_length_of(element);
      if (count == 4 && array.kind == MatClass::structure) read_fields(element, name_length, array);
      if (count > 2 && element.type == MatType::matrix)
        array.parts.push_back(array_of(element, depth + 1));
    }
    if (has_data(array) && array.entries() > 0 && count < 4)
      refuse(end, "an array ends before its data");
    require_parts(array, end);
    return array;
  }

  static bool has_data(const MatArray& array) {
    return array.kind == MatClass::text || array.is_numeric();
  }

  static std::string_view text_before_nul(std::string_view bytes) {
    return bytes.substr(0, bytes.find('\0'));
  }

  void read_flags(const Element& flags, MatArray& array) const {
    if (flags.type != MatType::uint32 || flags.data.size() != 2 * sizeof(std::uint32_t))
      refuse(offset(flags.data), "an array does not begin with its flags");
    constexpr std::uint32_t kComplex = 0x800;
    const auto word = element_number<std::uint32_t>(flags.data, 0);
    array.kind = MatClass{static_cast<std::uint8_t>(word & 0xffU)};
    array.complex = (word & kComplex) != 0;
  }

  // Every entry of a log occupies at least one byte.
  void read_dimensions(const Element& element, std::size_t max_entries, MatArray& array) {
    const std::size_t count = element.data.size() / sizeof(std::int32_t);
    if (element.type != MatType::int32 || count < 2 || count > kMaxDimensions ||
        element.data.size() % sizeof(std::int32_t) != 0)
      refuse(offset(element.data),
             fmt::format("an array has other than 2 to {} dimensions", kMaxDimensions));
    std::size_t entries = 1;
    bool too_many = false;
    std::string extents;
    for (std::size_t i = 0; i < count; ++i) {
      const auto extent = element_number<std::int32_t>(element.data, i * sizeof(std::int32_t));
      extents += fmt::format("{}{}", i > 0 ? " x " : "", extent);
      array.dimensions.push_back(static_cast<std::size_t>(extent));
      too_many =
          too_many || extent < 0 || (extent > 0 && entries > max_entries / array.dimensions[i]);
      if (!too_many) entries *= array.dimensions[i];
    }
    if (too_many) refuse(offset(element.data), fmt::format("an array claims {} entries", extents));
    budget_.charge(count * sizeof(std::size_t));
  }

  void read_data(const Element& element, MatArray& array) const {
    const std::size_t width = width_of(element.type);
    if (width == 0 || array.entries() * width != element.data.size())
      refuse(offset(element.data),
             fmt::format("an array of {} entries has {} bytes of type {}", array.entries(),
                         element.data.size(), static_cast<std::uint32_t>(element.type)));
    array.type = element.type;
    array.data = element.data;
  }

  [[nodiscard]] std::size_t name_length_of(const Element& element) const {
    const bool number =
        element.type == MatType::int32 && element.data.size() == sizeof(std::int32_t);
    const std::int32_t length = number ? element_number<std::int32_t>(element.data, 0) : 0;
    if (length <= 0)
      refuse(offset(element.data), "a struct does not state the length of its names");
    return static_cast<std::size_t>(length);
  }

  // Names in slots of equal length, terminated by NUL.
  void read_fields(const Element& element, std::size_t length, MatArray& array) {
    const std::size_t count = element.data.size() / length;
    budget_.charge(count * sizeof(std::string_view));
    for (std::size_t i = 0; i < count; ++i)
      array.fields.push_back(text_before_nul(element.data.substr(i * length, length)));
  }

  void require_parts(const MatArray& array, std::size_t end) const {
    const bool structure = array.kind == MatClass::structure;
    if (!structure && array.kind != MatClass::cell) return;
    const std::size_t expected = array.entries() * (structure ? array.fields.size() : 1);
    if (array.parts.size() != expected)
      refuse(end, fmt::format("a {} holds {} arrays instead of {}", structure ? "struct" : "cell",
                              array.parts.size(), expected));
  }

  std::string_view bytes_;
  const std::string& origin_;
  MemoryBudget& budget_;
};

}  // namespace

void require_mat_header(std::string_view bytes, const std::string& origin) {
  constexpr std::string_view kHdf5 = "\x89HDF\r\n\x1a\n";
  constexpr std::size_t kHdf5Offset = 512;  // after the header of a v7.3 file
  if (bytes.starts_with(kHdf5) ||
      bytes.substr(std::min(kHdf5Offset, bytes.size())).starts_with(kHdf5))
    throw InvalidInput(origin,
                       "is a MAT v7.3 file, which is HDF5, expected MAT v5: save it with -v6");
  if (bytes.size() < kMatHeaderSize)
    throw InvalidInput(origin, fmt::format("has {} bytes, expected a MAT v5 file, which has a "
                                           "header of {}",
                                           bytes.size(), kMatHeaderSize));
  const auto version = element_number<std::uint16_t>(bytes, 124);
  const auto order = element_number<std::uint16_t>(bytes, 126);
  if (order == 0x494d)
    throw InvalidInput(origin,
                       "was written on a machine with the opposite byte order, expected this "
                       "machine's");
  if (order != 0x4d49 || version != 0x0100)
    throw InvalidInput(origin, "is not a MAT v5 file according to its header");
}

std::vector<MatArray> parse_mat(std::string_view bytes, const std::string& origin,
                                MemoryBudget& budget) {
  require_mat_header(bytes, origin);
  return Parser(bytes, origin, budget).variables();
}

}  // namespace quadtune::internal
