// SPDX-License-Identifier: Apache-2.0
/// Maps the names of a log to fields of structs.
#pragma once

#include <string>
#include <string_view>
#include <unordered_set>
#include <vector>

namespace quadtune::internal {

/// Unique field names within one struct.
class FieldNames {
 public:
  FieldNames() = default;
  /// @param taken  names that are already in use
  explicit FieldNames(const std::vector<std::string>& taken) : taken_(taken.begin(), taken.end()) {}

  /// Converts `text` to a valid MATLAB name that has not been returned before. Characters other
  /// than letters, digits and '_' are replaced by '_'; 'x' is prepended if the name does not begin
  /// with a letter or is a keyword; names longer than 63 characters are truncated; "_2", "_3", … is
  /// appended to names that are in use.
  std::string add(std::string_view text);

 private:
  std::unordered_set<std::string> taken_;
};

/// A struct of columns, in which "x.px" is the field "px" of the struct "x".
struct FieldTree {
  std::string field;              ///< its name; empty at the root
  int column = -1;                ///< index in the table; -1 for a struct
  std::vector<FieldTree> fields;  ///< in order of insertion
};

/// The columns of a log as fields of structs, and the path of each column: "x.px".
struct FieldLayout {
  FieldTree root;
  std::vector<std::string> paths;  ///< one per column
};

/// @param names  of the columns, in their order
/// @param taken  fields of the outermost struct that are used for other data
[[nodiscard]] FieldLayout layout_of(const std::vector<std::string>& names,
                                    const std::vector<std::string>& taken);

}  // namespace quadtune::internal
