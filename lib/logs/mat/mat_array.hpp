// SPDX-License-Identifier: Apache-2.0
/// The arrays of a MAT v5 file, and the codes of the format.
// Source: The MathWorks, "MAT-File Format", level 5.
#pragma once

#include <cstddef>
#include <cstdint>
#include <new>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace quadtune::internal {

inline constexpr std::size_t kMatHeaderSize = 128;  // [bytes]
inline constexpr std::size_t kMatTagSize = 8;       // [bytes]

// The struct in the project's own logs. Not `log`: loading a file would hide the logarithm.
inline constexpr const char* kMatVariable = "flight";
inline constexpr const char* kMatFormat = "quadtune-log";
inline constexpr double kMatVersion = 1;

/// What an array holds.
enum class MatClass : std::uint8_t {
  empty = 0,
  cell = 1,
  structure = 2,
  object = 3,
  text = 4,
  sparse = 5,
  float64 = 6,  // the first of the numeric classes
  uint64 = 15,  // the last one
  opaque = 17
};

/// How the bytes of an element are to be read.
enum class MatType : std::uint32_t {
  int8 = 1,
  uint8 = 2,
  int16 = 3,
  uint16 = 4,
  int32 = 5,
  uint32 = 6,
  float32 = 7,
  float64 = 9,
  int64 = 12,
  uint64 = 13,
  matrix = 14,
  compressed = 15,
  utf8 = 16,
  utf16 = 17,
  utf32 = 18
};

/// Bytes of one number or letter; 0 for a type that has neither.
[[nodiscard]] std::size_t width_of(MatType type);

/// One array with those that it holds. Views refer to the bytes that parse_mat() was given.
struct MatArray {
  MatClass kind = MatClass::empty;
  bool complex = false;
  MatType type = MatType::int8;         ///< of `data`; need not be that of `kind`
  std::string_view name;                ///< of a variable; often empty within structs and cells
  std::vector<std::size_t> dimensions;  ///< two or more; none where nothing is stored at all
  std::string_view data;                ///< (real part of) numbers or letters, as many as entries()
  std::vector<std::string_view> fields;  ///< names of a struct
  std::vector<MatArray> parts;           ///< of a cell, or fields of struct 0, of struct 1, …

  [[nodiscard]] bool is_numeric() const {
    return kind >= MatClass::float64 && kind <= MatClass::uint64;
  }
  [[nodiscard]] bool is_matrix() const { return dimensions.size() == 2; }
  [[nodiscard]] std::size_t rows() const { return is_matrix() ? dimensions[0] : 0; }
  [[nodiscard]] std::size_t columns() const { return is_matrix() ? dimensions[1] : 0; }
  [[nodiscard]] std::size_t entries() const;
  /// Of a struct; nullptr where there is no such field or this is no struct.
  [[nodiscard]] const MatArray* field(std::string_view wanted, std::size_t index = 0) const;
  /// @param index  < entries() of an array of numbers
  [[nodiscard]] double number(std::size_t index) const;
  /// Letters in UTF-16 as UTF-8; nothing for other letters and a surrogate that stands alone.
  [[nodiscard]] std::optional<std::string> utf16_text() const;
};

/// Bounds what a file can make its reader allocate.
class MemoryBudget {
 public:
  explicit MemoryBudget(std::size_t bytes) : left_(bytes) {}

  [[nodiscard]] std::size_t left() const { return left_; }
  /// @throws std::bad_alloc  beyond the limit.
  void charge(std::size_t bytes) {
    if (bytes > left_) throw std::bad_alloc();
    left_ -= bytes;
  }

 private:
  std::size_t left_;
};

}  // namespace quadtune::internal
