// SPDX-License-Identifier: Apache-2.0
/// Strict reading of TOML: the reader of each table lists the allowed keys, whose names include the
/// unit. Every error is one line with file and line number.
#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <vector>

namespace quadtune::internal {

/// Maximum size of a TOML file [bytes], and maximum length of a line.
inline constexpr std::size_t kTomlLimit = std::size_t{1} << 20;
inline constexpr std::size_t kTomlLineLimit = 8192;

/// An allowed key: "mass" with unit "kg" is written mass_kg.
struct TomlKey {
  std::string stem;
  std::string unit = "";

  [[nodiscard]] std::string name() const { return unit.empty() ? stem : stem + "_" + unit; }
};

/// The range of numbers that a key accepts.
struct Range {
  enum class Bound { none, open, closed };
  double low = 0;
  Bound low_bound = Bound::none;
  double high = 0;
  Bound high_bound = Bound::none;

  [[nodiscard]] bool holds(double value) const;
  [[nodiscard]] std::string words() const;  ///< "more than 0", "0 or more", "from 0 to 1"

  static Range any() { return {}; }
  static Range positive() { return {0, Bound::open, 0, Bound::none}; }
  static Range not_negative() { return {0, Bound::closed, 0, Bound::none}; }
};

/// A value of the file with its line. Built from the parser's tree, so that no other code depends
/// on it.
struct TomlNode {
  enum class Kind { boolean, integer, real, text, list, table, other };
  struct Entry;

  Kind kind = Kind::other;
  int line = 0;
  bool truth = false;
  double value = 0;          ///< of an integer or a real
  std::int64_t integer = 0;  ///< of an integer
  std::string text;
  std::vector<TomlNode> list;
  std::vector<Entry> table;  ///< in the order of the file
};

struct TomlNode::Entry {
  std::string key;
  int line = 0;
  TomlNode node;
};

/// One table of a file. Copies are cheap and share the file's tree.
class TomlTable {
 public:
  /// Parses a file's text.
  /// @param origin  the file's name in messages.
  /// @param limit   maximum size [bytes].
  /// @throws InvalidInput  if the text is not TOML, is too large, or defines a key twice.
  static TomlTable parse(const std::string& text, const std::string& origin,
                         std::size_t limit = kTomlLimit);

  /// Rejects the first key of the table that is not listed, and suggests the nearest one that is.
  void allow(const std::vector<TomlKey>& known) const;

  [[nodiscard]] bool has(const std::string& key) const { return find(key) != nullptr; }
  /// All keys, in the order of the file.
  [[nodiscard]] std::vector<std::string> keys() const;

  /// "file:line" of the key, or of the table if the key is missing or empty.
  [[nodiscard]] std::string where(const std::string& key = "") const;
  /// "file:line" of an entry of a list, counted from 0; of the key if there is no such entry.
  [[nodiscard]] std::string where(const std::string& key, std::size_t entry) const;
  [[nodiscard]] const std::string& title() const { return title_; }

  // Each of these rejects a missing key, a wrong type, a value out of range, NaN and infinity.
  [[nodiscard]] double number(const std::string& key, const Range& range = Range::any()) const;
  [[nodiscard]] int integer(const std::string& key, int low, int high) const;
  /// One line of text without control characters, since it may be copied to comments of other
  /// files.
  [[nodiscard]] std::string text(const std::string& key) const;
  /// 1 to 64 letters, digits, '.', '_' and '-': valid as part of a file name.
  [[nodiscard]] std::string word(const std::string& key) const;
  [[nodiscard]] bool truth(const std::string& key) const;
  [[nodiscard]] std::vector<std::string> texts(const std::string& key) const;
  [[nodiscard]] Eigen::VectorXd vector(const std::string& key,
                                       const Range& range = Range::any()) const;
  [[nodiscard]] Eigen::Vector3d vector3(const std::string& key,
                                        const Range& range = Range::any()) const;
  /// A list of lists of equal length.
  [[nodiscard]] Eigen::MatrixXd matrix(const std::string& key) const;
  [[nodiscard]] bool is_list_of_lists(const std::string& key) const;
  [[nodiscard]] bool is_text(const std::string& key) const;
  [[nodiscard]] bool is_list(const std::string& key) const;

  // The same with a default for a missing key.
  [[nodiscard]] double number_or(const std::string& key, double fallback,
                                 const Range& range = Range::any()) const;
  [[nodiscard]] std::string text_or(const std::string& key, const std::string& fallback) const;

  /// The subtable under a key.
  [[nodiscard]] TomlTable table(const std::string& key) const;
  [[nodiscard]] std::optional<TomlTable> maybe_table(const std::string& key) const;
  /// A list of tables ([[key]] or key = [{…}]); empty if the key is missing.
  [[nodiscard]] std::vector<TomlTable> tables(const std::string& key) const;

 private:
  TomlTable(std::shared_ptr<const TomlNode> root, const TomlNode* node, std::string origin,
            std::string title)
      : root_(std::move(root)), node_(node), origin_(std::move(origin)), title_(std::move(title)) {}

  [[nodiscard]] const TomlNode* find(const std::string& key) const;
  [[nodiscard]] const TomlNode& need(const std::string& key) const;
  [[nodiscard]] std::string at(const TomlNode& node) const;
  [[nodiscard]] std::string named(const std::string& key) const;
  [[nodiscard]] double checked(const TomlNode& node, const std::string& what,
                               const Range& range) const;
  void require_one_line(const TomlNode& node, const std::string& what) const;
  [[nodiscard]] TomlTable inner(const TomlNode& node, const std::string& title) const;
  [[noreturn]] void refuse_unknown(const TomlNode::Entry& entry,
                                   const std::vector<TomlKey>& known) const;

  std::shared_ptr<const TomlNode> root_;
  const TomlNode* node_;
  std::string origin_;
  std::string title_;  ///< "[body]", or "" for the top level
};

}  // namespace quadtune::internal
