// SPDX-License-Identifier: Apache-2.0
/// Definitions of the topics in a PX4 ULog.
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

/// A number within a record.
struct UlogLeaf {
  UlogType type;
  std::size_t offset;  ///< [bytes] from the beginning of the record
};

/// A topic expanded to its numbers: arrays and nested types entry by entry, without texts.
struct UlogLayout {
  std::vector<UlogLeaf> leaves;
  std::vector<LogChannel> channels;  ///< one per leaf: "x", "q[2]", "esc[0].rpm"
  /// It begins with a field `timestamp` [us], which is not a channel
  bool timed = false;
  UlogLeaf timestamp{UlogType::kUint64, 0};
  std::size_t min = 0;  ///< minimum size of a record [bytes]; padding at its end may be omitted
  std::size_t max = 0;
};

/// Value of a leaf in a record that contains it.
[[nodiscard]] double ulog_value(const UlogLeaf& leaf, std::string_view record);
/// Value of an integer leaf.
[[nodiscard]] std::uint64_t ulog_whole(const UlogLeaf& leaf, std::string_view record);

/// The formats that a log defines.
class UlogFormats {
 public:
  /// Adds a definition such as "name:uint64_t timestamp;float[3] x;".
  /// @return  why the definition is invalid; empty if it was added
  std::string add(std::string_view definition);

  /// Expands a topic into `layout`.
  /// @return  why this is not possible; empty if `layout` is filled
  std::string layout(const std::string& topic, UlogLayout& layout) const;

 private:
  struct Field {
    std::string type;
    std::string name;
    std::size_t count;  // 0: not an array
  };
  class Unfolder;

  std::map<std::string, std::vector<Field>, std::less<>> formats_;
};

}  // namespace quadtune::internal
