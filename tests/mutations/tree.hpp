// SPDX-License-Identifier: Apache-2.0
/// TOML and JSON as a tree that can represent invalid files: duplicate keys, numbers beyond any
/// range, invalid words.
#pragma once

#include <string>
#include <utility>
#include <vector>

namespace quadtune::mutations {

struct Node {
  enum class Kind { leaf, list, table };
  Kind kind = Kind::leaf;
  std::string text = {};                                 ///< text of a leaf, as written in the file
  std::vector<std::pair<std::string, Node>> parts = {};  ///< named in a table
};

[[nodiscard]] Node leaf(const std::string& text);
/// A text in quotes, with the escapes that TOML and JSON share.
[[nodiscard]] std::string quoted(const std::string& text);

/// @throws std::exception  if the text is neither TOML nor JSON.
[[nodiscard]] Node tree_of_toml(const std::string& text);
[[nodiscard]] Node tree_of_json(const std::string& text);

[[nodiscard]] std::string toml_of(const Node& table);
[[nodiscard]] std::string json_of(const Node& node);

}  // namespace quadtune::mutations
