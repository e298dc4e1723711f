// SPDX-License-Identifier: Apache-2.0
/// How the names of a log become fields of structs.
#pragma once

#include <string>
#include <string_view>
#include <unordered_set>
#include <vector>

namespace quadtune::internal {

/// Names of the fields of one struct.
class FieldNames {
 public:
  FieldNames() = default;
  /// @param taken  Names that are spoken for.
  explicit FieldNames(const std::vector<std::string>& taken) : taken_(taken.begin(), taken.end()) {}

  /// `text` as a name that MATLAB takes and that was not given before: what is neither a letter, a
  /// digit nor '_' becomes '_', an 'x' goes before what begins otherwise than with a letter and
  /// before a keyword, what is longer than 63 is cut, and what is taken gets "_2", "_3", …
  std::string add(std::string_view text);

 private:
  std::unordered_set<std::string> taken_;
};

/// A struct of columns, in which "x.px" is the field "px" of the struct "x".
struct FieldTree {
  std::string field;              ///< its own name; empty at the root
  int column = -1;                ///< of the table; -1 for a struct
  std::vector<FieldTree> fields;  ///< in the order in which they came
};

/// The columns of a log in structs beside what else a log has, and the path of each: "x.px".
struct FieldLayout {
  FieldTree root;
  std::vector<std::string> paths;  ///< one a column
};

/// @param names  of the columns, in their order.
/// @param taken  Fields of the outermost struct that hold something else.
[[nodiscard]] FieldLayout layout_of(const std::vector<std::string>& names,
                                    const std::vector<std::string>& taken);

}  // namespace quadtune::internal
