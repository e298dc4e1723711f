// SPDX-License-Identifier: Apache-2.0
/// Strict reading of TOML: every table says which keys it may hold, with the unit as part of the
/// key, and every mistake becomes one line with file and line number.
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

/// Largest TOML file that is read [bytes], and its longest line.
inline constexpr std::size_t kTomlLimit = std::size_t{1} << 20;
inline constexpr std::size_t kTomlLineLimit = 8192;

/// A key that a table may hold: "mass" with unit "kg" is written mass_kg.
struct TomlKey {
  std::string stem;
  std::string unit = "";

  [[nodiscard]] std::string name() const { return unit.empty() ? stem : stem + "_" + unit; }
};

/// Which numbers a key accepts.
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

/// A value of the file with its line. Built from the parser's tree, so that nobody else needs it.
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

/// One table of a file. Copies are cheap and keep the file's tree alive.
class TomlTable {
 public:
  /// Parses a file's text.
  /// @param origin  What messages call the file.
  /// @param limit   Most bytes that it may have.
  /// @throws InvalidInput  for what is not TOML, too large, or has a key twice.
  static TomlTable parse(const std::string& text, const std::string& origin,
                         std::size_t limit = kTomlLimit);

  /// Refuses the first key of the file that is not listed, with the nearest that is.
  void allow(const std::vector<TomlKey>& known) const;

  [[nodiscard]] bool has(const std::string& key) const { return find(key) != nullptr; }
  /// All of them, in the order of the file.
  [[nodiscard]] std::vector<std::string> keys() const;

  /// "file:line" of the key, or of the table when it has no such key or none is named.
  [[nodiscard]] std::string where(const std::string& key = "") const;
  /// "file:line" of an entry of a list, counted from 0; of the key when there is no such entry.
  [[nodiscard]] std::string where(const std::string& key, std::size_t entry) const;
  [[nodiscard]] const std::string& title() const { return title_; }

  // Each of these refuses a missing key, another type, a value out of range, nan and infinity.
  [[nodiscard]] double number(const std::string& key, const Range& range = Range::any()) const;
  [[nodiscard]] int integer(const std::string& key, int low, int high) const;
  /// One line of text without control characters, as it may end up in comments of other files.
  [[nodiscard]] std::string text(const std::string& key) const;
  /// Letters, digits, '.', '_' and '-', 1 to 64 of them: fit for the name of a file.
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

  // The same with a value to take where the key is absent.
  [[nodiscard]] double number_or(const std::string& key, double fallback,
                                 const Range& range = Range::any()) const;
  [[nodiscard]] std::string text_or(const std::string& key, const std::string& fallback) const;

  /// A table within this one.
  [[nodiscard]] TomlTable table(const std::string& key) const;
  [[nodiscard]] std::optional<TomlTable> maybe_table(const std::string& key) const;
  /// A list of tables ([[key]] or key = [{…}]); empty when the key is absent.
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
  std::string title_;  ///< "[body]", or "" at the top
};

}  // namespace quadtune::internal
