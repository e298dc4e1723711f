// SPDX-License-Identifier: Apache-2.0
#include "quadtune/internal/toml_reader.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "quadtune/errors.hpp"
#include "quadtune/internal/counted.hpp"
#include "quadtune/internal/joined.hpp"
#include "quadtune/internal/suggest.hpp"
#include "quadtune/internal/text_file.hpp"

namespace quadtune::internal {
namespace {

// Describes a value for messages: "the string '63 g'", "a list of 2".
std::string describe(const TomlNode& node) {
  switch (node.kind) {
    case TomlNode::Kind::boolean:
      return node.truth ? "true" : "false";
    case TomlNode::Kind::integer:
      return fmt::format("{}", node.integer);
    case TomlNode::Kind::real:
      return fmt::format("{}", node.value);
    case TomlNode::Kind::text:
      return fmt::format("the string '{}'", printable(node.text));
    case TomlNode::Kind::list:
      if (!node.list.empty() && node.list.front().kind == TomlNode::Kind::table)
        return fmt::format("a list of {}", counted(node.list.size(), "table"));
      return fmt::format("a list of {}", node.list.size());
    case TomlNode::Kind::table:
      return "a table";
    default:
      return "a date or time";
  }
}

bool is_number(const TomlNode& node) {
  return node.kind == TomlNode::Kind::integer || node.kind == TomlNode::Kind::real;
}

// Whether `key` has the stem of `known` with another unit or without unit.
bool same_stem(const std::string& key, const TomlKey& known) {
  return !known.unit.empty() && (key == known.stem || key.rfind(known.stem + "_", 0) == 0);
}

}  // namespace

bool Range::holds(double value) const {
  const bool above =
      low_bound == Bound::none || value > low || (low_bound == Bound::closed && value == low);
  const bool below =
      high_bound == Bound::none || value < high || (high_bound == Bound::closed && value == high);
  return above && below;
}

std::string Range::words() const {
  const std::string min = low_bound == Bound::closed ? fmt::format("{} or more", low)
                                                     : fmt::format("more than {}", low);
  const std::string max = high_bound == Bound::closed ? fmt::format("{} or less", high)
                                                      : fmt::format("less than {}", high);
  if (low_bound == Bound::none) return high_bound == Bound::none ? "a finite number" : max;
  return high_bound == Bound::none ? min : min + " and " + max;
}

const TomlNode* TomlTable::find(const std::string& key) const {
  for (const TomlNode::Entry& entry : node_->table)
    if (entry.key == key) return &entry.node;
  return nullptr;
}

std::string TomlTable::at(const TomlNode& node) const {
  return fmt::format("{}:{}", origin_, node.line);
}

std::vector<std::string> TomlTable::keys() const {
  std::vector<std::string> all;
  for (const TomlNode::Entry& entry : node_->table) all.push_back(entry.key);
  return all;
}

std::string TomlTable::where(const std::string& key) const {
  for (const TomlNode::Entry& entry : node_->table)
    if (entry.key == key) return fmt::format("{}:{}", origin_, entry.line);
  return at(*node_);
}

std::string TomlTable::where(const std::string& key, std::size_t entry) const {
  const TomlNode* node = find(key);
  return node == nullptr || entry >= node->list.size() ? where(key) : at(node->list[entry]);
}

std::string TomlTable::named(const std::string& key) const {
  return title_.empty() ? key : key + " in " + title_;
}

const TomlNode& TomlTable::need(const std::string& key) const {
  const TomlNode* node = find(key);
  if (node == nullptr)
    throw InvalidInput(where(), fmt::format("{} has no key '{}', which is required",
                                            title_.empty() ? "the file" : title_, key));
  return *node;
}

void TomlTable::allow(const std::vector<TomlKey>& known) const {
  for (const TomlNode::Entry& entry : node_->table) {
    bool listed = false;
    for (const TomlKey& key : known) listed = listed || key.name() == entry.key;
    if (!listed) refuse_unknown(entry, known);
  }
}

void TomlTable::refuse_unknown(const TomlNode::Entry& entry,
                               const std::vector<TomlKey>& known) const {
  const std::string message = fmt::format("key '{}'{} is not known", printable(entry.key),
                                          title_.empty() ? "" : " in " + title_);
  const std::string place = fmt::format("{}:{}", origin_, entry.line);
  const TomlKey* sibling = nullptr;
  for (const TomlKey& key : known)
    if (same_stem(entry.key, key) && (!sibling || key.stem.size() > sibling->stem.size()))
      sibling = &key;
  if (sibling != nullptr)
    throw InvalidInput(place, fmt::format("{}, expected '{}' (the unit is part of the key)",
                                          message, sibling->name()));
  std::vector<std::string> names;
  names.reserve(known.size());
  for (const TomlKey& key : known) names.push_back(key.name());
  throw InvalidInput(place,
                     fmt::format("{}, expected one of {}{}", message, internal::joined(names, ", "),
                                 did_you_mean(entry.key, names)));
}

double TomlTable::checked(const TomlNode& node, const std::string& what, const Range& range) const {
  if (!is_number(node))
    throw InvalidInput(at(node), fmt::format("{} is {}, expected a number", what, describe(node)));
  if (!std::isfinite(node.value))
    throw InvalidInput(at(node),
                       fmt::format("{} is {}, expected a finite number", what, node.value));
  if (!range.holds(node.value))
    throw InvalidInput(at(node),
                       fmt::format("{} is {}, expected {}", what, describe(node), range.words()));
  return node.value;
}

double TomlTable::number(const std::string& key, const Range& range) const {
  return checked(need(key), named(key), range);
}

double TomlTable::number_or(const std::string& key, double fallback, const Range& range) const {
  return has(key) ? number(key, range) : fallback;
}

int TomlTable::integer(const std::string& key, int low, int high) const {
  const TomlNode& node = need(key);
  if (node.kind != TomlNode::Kind::integer || node.integer < low || node.integer > high)
    throw InvalidInput(
        at(node),
        node.kind == TomlNode::Kind::real
            ? fmt::format("{} is {:#}, expected a whole number from {} to {}, written without a "
                          "point or an exponent",
                          named(key), node.value, low, high)
            : fmt::format("{} is {}, expected a whole number from {} to {}", named(key),
                          describe(node), low, high));
  return static_cast<int>(node.integer);
}

std::string TomlTable::text(const std::string& key) const {
  const TomlNode& node = need(key);
  if (node.kind != TomlNode::Kind::text)
    throw InvalidInput(at(node),
                       fmt::format("{} is {}, expected a string", named(key), describe(node)));
  require_one_line(node, named(key));
  return node.text;
}

std::string TomlTable::word(const std::string& key) const {
  std::string value = text(key);
  const auto fits = [](char c) {
    return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || (c >= '0' && c <= '9') || c == '.' ||
           c == '_' || c == '-';
  };
  if (value.empty() || value.size() > 64 || !std::all_of(value.begin(), value.end(), fits))
    throw InvalidInput(where(key), fmt::format("{} is '{}', expected 1 to 64 letters, digits, "
                                               "'.', '_' or '-' because it is used in file names",
                                               named(key), printable(value)));
  return value;
}

void TomlTable::require_one_line(const TomlNode& node, const std::string& what) const {
  for (const char c : node.text)
    if (static_cast<unsigned char>(c) < 0x20 || c == 0x7f)
      throw InvalidInput(at(node), what +
                                       " has a line break or another control character, "
                                       "expected one line of text");
}

std::string TomlTable::text_or(const std::string& key, const std::string& fallback) const {
  return has(key) ? text(key) : fallback;
}

std::vector<std::string> TomlTable::texts(const std::string& key) const {
  const TomlNode& node = need(key);
  if (node.kind != TomlNode::Kind::list)
    throw InvalidInput(
        at(node), fmt::format("{} is {}, expected a list of strings", named(key), describe(node)));
  std::vector<std::string> words;
  for (const TomlNode& element : node.list) {
    if (element.kind != TomlNode::Kind::text)
      throw InvalidInput(at(element), fmt::format("{} has {} as entry {}, expected a string",
                                                  named(key), describe(element), words.size() + 1));
    require_one_line(element, fmt::format("entry {} of {}", words.size() + 1, named(key)));
    words.push_back(element.text);
  }
  return words;
}

Eigen::VectorXd TomlTable::vector(const std::string& key, const Range& range) const {
  const TomlNode& node = need(key);
  if (node.kind != TomlNode::Kind::list)
    throw InvalidInput(
        at(node), fmt::format("{} is {}, expected a list of numbers", named(key), describe(node)));
  Eigen::VectorXd values(static_cast<Eigen::Index>(node.list.size()));
  for (Eigen::Index i = 0; i < values.size(); ++i)
    values(i) = checked(node.list[static_cast<std::size_t>(i)],
                        fmt::format("entry {} of {}", i + 1, named(key)), range);
  return values;
}

Eigen::Vector3d TomlTable::vector3(const std::string& key, const Range& range) const {
  const Eigen::VectorXd values = vector(key, range);
  if (values.size() != 3)
    throw InvalidInput(where(key), fmt::format("{} has {}, expected 3 (x, y, z)", named(key),
                                               counted(values.size(), "entry", "entries")));
  return values;
}

Eigen::MatrixXd TomlTable::matrix(const std::string& key) const {
  const TomlNode& node = need(key);
  if (node.kind != TomlNode::Kind::list || node.list.empty())
    throw InvalidInput(at(node), fmt::format("{} is {}, expected a list of rows", named(key),
                                             node.kind == TomlNode::Kind::list ? "an empty list"
                                                                               : describe(node)));
  const std::size_t cols = node.list.front().list.size();
  Eigen::MatrixXd M(static_cast<Eigen::Index>(node.list.size()), static_cast<Eigen::Index>(cols));
  for (Eigen::Index i = 0; i < M.rows(); ++i) {
    const TomlNode& row = node.list[static_cast<std::size_t>(i)];
    if (row.kind != TomlNode::Kind::list || row.list.empty())
      throw InvalidInput(at(row), fmt::format("row {} of {} is {}, expected a list of numbers",
                                              i + 1, named(key), describe(row)));
    if (row.list.size() != cols)
      throw InvalidInput(
          at(row), fmt::format("row {} of {} has {}, expected {} as in row 1", i + 1, named(key),
                               counted(row.list.size(), "number"), cols));
    for (Eigen::Index j = 0; j < M.cols(); ++j)
      M(i, j) = checked(row.list[static_cast<std::size_t>(j)],
                        fmt::format("entry ({},{}) of {}", i + 1, j + 1, named(key)), Range::any());
  }
  return M;
}

bool TomlTable::is_list_of_lists(const std::string& key) const {
  const TomlNode* node = find(key);
  return node != nullptr && node->kind == TomlNode::Kind::list && !node->list.empty() &&
         node->list.front().kind == TomlNode::Kind::list;
}

bool TomlTable::truth(const std::string& key) const {
  const TomlNode& node = need(key);
  if (node.kind != TomlNode::Kind::boolean)
    throw InvalidInput(at(node),
                       fmt::format("{} is {}, expected true or false", named(key), describe(node)));
  return node.truth;
}

bool TomlTable::is_list(const std::string& key) const {
  const TomlNode* node = find(key);
  return node != nullptr && node->kind == TomlNode::Kind::list;
}

bool TomlTable::is_text(const std::string& key) const {
  const TomlNode* node = find(key);
  return node != nullptr && node->kind == TomlNode::Kind::text;
}

TomlTable TomlTable::inner(const TomlNode& node, const std::string& title) const {
  return TomlTable(root_, &node, origin_, title);
}

TomlTable TomlTable::table(const std::string& key) const {
  const TomlNode& node = need(key);
  std::string title = "[" + key + "]";
  if (title_.rfind("[[", 0) == 0)  // "[[rotors]] 2" has no bracket at its end
    title = title_ + "." + key;
  else if (!title_.empty())
    title = title_.substr(0, title_.size() - 1) + "." + key + "]";
  if (node.kind != TomlNode::Kind::table)
    throw InvalidInput(at(node), fmt::format("{} is {}, expected one table, {}", named(key),
                                             describe(node), title));
  return inner(node, title);
}

std::optional<TomlTable> TomlTable::maybe_table(const std::string& key) const {
  if (!has(key)) return std::nullopt;
  return table(key);
}

std::vector<TomlTable> TomlTable::tables(const std::string& key) const {
  std::vector<TomlTable> all;
  if (!has(key)) return all;
  const TomlNode& node = need(key);
  if (node.kind != TomlNode::Kind::list)
    throw InvalidInput(
        at(node), fmt::format("{} is {}, expected a list of tables, each under [[{}]]", named(key),
                              describe(node), key));
  const bool in_table = title_.starts_with('[') && title_.ends_with(']');
  const std::string parent = in_table ? title_.substr(1, title_.size() - 2) + "." : "";
  for (const TomlNode& element : node.list) {
    const std::size_t count = all.size() + 1;
    if (element.kind != TomlNode::Kind::table)
      throw InvalidInput(at(element), fmt::format("{} has {} as entry {}, expected a table",
                                                  named(key), describe(element), count));
    all.push_back(inner(element, fmt::format("[[{}{}]] {}", parent, key, count)));
  }
  return all;
}

}  // namespace quadtune::internal
