// SPDX-License-Identifier: Apache-2.0
/// What the topics of a PX4 ULog are made of.
#pragma once

#include <cstddef>
#include <map>
#include <string>
#include <string_view>
#include <vector>

#include "quadtune/logs/log_reader.hpp"

namespace quadtune::internal {

enum class UlogType : char {
  kInt8,
  kUint8,
  kInt16,
  kUint16,
  kInt32,
  kUint32,
  kInt64,
  kUint64,
  kFloat,
  kDouble,
  kBool
};

/// One number within a record.
struct UlogLeaf {
  UlogType type;
  std::size_t offset;  ///< [bytes] from the start of the record
};

/// A topic taken apart to its numbers: arrays and nested types entry by entry, texts left out.
struct UlogLayout {
  std::vector<UlogLeaf> leaves;
  std::vector<LogChannel> channels;  ///< one a leaf: "x", "q[2]", "esc[0].rpm"
  bool timed = false;                ///< it begins a field `timestamp` [us], which is no channel
  UlogLeaf timestamp{UlogType::kUint64, 0};
  std::size_t least = 0;  ///< [bytes] of a record; padding at its end need not be written
  std::size_t most = 0;
};

/// The value of a leaf in a record that has it.
[[nodiscard]] double ulog_value(const UlogLeaf& leaf, std::string_view record);
/// Likewise of a whole number.
[[nodiscard]] std::uint64_t ulog_whole(const UlogLeaf& leaf, std::string_view record);

/// The formats that a log defines.
class UlogFormats {
 public:
  /// Takes a definition, "name:uint64_t timestamp;float[3] x;".
  /// @return  why it cannot be taken; "" if it was.
  std::string add(std::string_view definition);

  /// @return  why there is none; "" with `layout` filled.
  std::string layout(const std::string& topic, UlogLayout& layout) const;

 private:
  struct Field {
    std::string type;
    std::string name;
    std::size_t count;  // 0: no array
  };
  class Unfolder;

  std::map<std::string, std::vector<Field>, std::less<>> formats_;
};

}  // namespace quadtune::internal
