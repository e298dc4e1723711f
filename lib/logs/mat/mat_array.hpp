// SPDX-License-Identifier: Apache-2.0
/// Arrays of a MAT v5 file, and the codes of the file format.
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

// Name of the struct in quadtune's logs. It is not `log`, because loading the file would then hide
// the function log().
inline constexpr const char* kMatVariable = "flight";
inline constexpr const char* kMatFormat = "quadtune-log";
inline constexpr double kMatVersion = 1;

/// Class of an array.
enum class MatClass : std::uint8_t {
  empty = 0,
  cell = 1,
  structure = 2,
  object = 3,
  text = 4,
  sparse = 5,
  float64 = 6,  // the first numeric class
  uint64 = 15,  // the last numeric class
  opaque = 17
};

/// Data type of an element.
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

/// Bytes per number or character; 0 for a type that has neither.
[[nodiscard]] std::size_t width_of(MatType type);

/// An array with its nested arrays. Views refer to the bytes passed to parse_mat().
struct MatArray {
  MatClass kind = MatClass::empty;
  bool complex = false;
  MatType type = MatType::int8;  ///< type of `data`; may differ from that of `kind`
  /// Name of a variable; often empty within structs and cells
  std::string_view name;
  std::vector<std::size_t> dimensions;  ///< two or more; empty if nothing is stored
  std::string_view data;                ///< (real part of) numbers or characters, entries() of them
  std::vector<std::string_view> fields;  ///< names of a struct
  std::vector<MatArray> parts;           ///< cells, or fields of struct 0, of struct 1, …

  [[nodiscard]] bool is_numeric() const {
    return kind >= MatClass::float64 && kind <= MatClass::uint64;
  }
  [[nodiscard]] bool is_matrix() const { return dimensions.size() == 2; }
  [[nodiscard]] std::size_t rows() const { return is_matrix() ? dimensions[0] : 0; }
  [[nodiscard]] std::size_t columns() const { return is_matrix() ? dimensions[1] : 0; }
  [[nodiscard]] std::size_t entries() const;
  /// Field of a struct; nullptr if it does not exist or this is not a struct.
  [[nodiscard]] const MatArray* field(std::string_view wanted, std::size_t index = 0) const;
  /// @param index  < entries() of a numeric array
  [[nodiscard]] double number(std::size_t index) const;
  /// UTF-16 characters as UTF-8; empty for other character types and unpaired surrogates.
  [[nodiscard]] std::optional<std::string> utf16_text() const;
};

/// Limits the memory that a file can make its reader allocate.
class MemoryBudget {
 public:
  explicit MemoryBudget(std::size_t bytes) : left_(bytes) {}

  [[nodiscard]] std::size_t left() const { return left_; }
  /// @throws std::bad_alloc  if the limit is exceeded
  void charge(std::size_t bytes) {
    if (bytes > left_) throw std::bad_alloc();
    left_ -= bytes;
  }

 private:
  std::size_t left_;
};

}  // namespace quadtune::internal
