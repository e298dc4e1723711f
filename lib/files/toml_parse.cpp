// SPDX-License-Identifier: Apache-2.0
// Converts the tree of toml++ to TomlNode; the only file that includes toml++.
#include <fmt/format.h>
#include <toml++/toml.h>

#include <algorithm>
#include <cctype>

#include "quadtune/errors.hpp"
#include "quadtune/internal/text_file.hpp"
#include "quadtune/internal/toml_reader.hpp"

namespace quadtune::internal {
namespace {

constexpr int kDeepest = 8;  // no file format of quadtune needs more than five levels

int line_of(const toml::node& node, int fallback) {
  const auto line = node.source().begin.line;
  return line > 0 ? static_cast<int>(line) : fallback;
}

class Converter {
 public:
  explicit Converter(std::string origin) : origin_(std::move(origin)) {}

  TomlNode convert(const toml::node& node, int parent_line, int depth) const {
    TomlNode result;
    result.line = line_of(node, parent_line);
    if (depth > kDeepest)
      throw InvalidInput(fmt::format("{}:{}", origin_, result.line),
                         fmt::format("tables and lists nest more than {} levels deep; no quadtune "
                                     "file needs more",
                                     kDeepest));
    switch (node.type()) {
      case toml::node_type::table:
        result.kind = TomlNode::Kind::table;
        add_table(*node.as_table(), result, depth);
        break;
      case toml::node_type::array:
        result.kind = TomlNode::Kind::list;
        for (const toml::node& element : *node.as_array())
          result.list.push_back(convert(element, result.line, depth + 1));
        break;
      case toml::node_type::string:
        result.kind = TomlNode::Kind::text;
        result.text = node.as_string()->get();
        break;
      case toml::node_type::integer:
        result.kind = TomlNode::Kind::integer;
        result.integer = node.as_integer()->get();
        result.value = static_cast<double>(result.integer);
        break;
      case toml::node_type::floating_point:
        result.kind = TomlNode::Kind::real;
        result.value = node.as_floating_point()->get();
        break;
      case toml::node_type::boolean:
        result.kind = TomlNode::Kind::boolean;
        result.truth = node.as_boolean()->get();
        break;
      default:  // dates and times
        result.kind = TomlNode::Kind::other;
    }
    return result;
  }

 private:
  void add_table(const toml::table& table, TomlNode& result, int depth) const {
    struct Place {
      toml::source_index line;
      toml::source_index column;
    };
    std::vector<std::pair<Place, TomlNode::Entry>> entries;
    for (const auto& [key, value] : table) {
      const toml::source_position place = key.source().begin;
      const int line = place.line > 0 ? static_cast<int>(place.line) : result.line;
      entries.push_back({{place.line, place.column},
                         {std::string(key.str()), line, convert(value, line, depth + 1)}});
    }
    // toml++ sorts by name; messages should follow the order of the file.
    std::stable_sort(entries.begin(), entries.end(), [](const auto& a, const auto& b) {
      return std::pair(a.first.line, a.first.column) < std::pair(b.first.line, b.first.column);
    });
    for (auto& entry : entries) result.table.push_back(std::move(entry.second));
  }

  std::string origin_;
};

// toml++ 3.3 parses dotted keys of any depth and frees the tables recursively; the limit on the
// length of a line bounds the recursion.
void require_short_lines(const std::string& text, const std::string& origin) {
  int line = 1;
  std::size_t start = 0;
  while (start < text.size()) {
    const std::size_t end = std::min(text.find('\n', start), text.size());
    if (end - start > kTomlLineLimit)
      throw InvalidInput(fmt::format("{}:{}", origin, line),
                         fmt::format("line has {} bytes, expected at most {}; lists may span lines",
                                     end - start, kTomlLineLimit));
    start = end + 1;
    ++line;
  }
}

/// Whether a line of the text begins with the header of a table.
bool has_header(std::string_view text, const std::string& header) {
  for (std::size_t at = text.find(header); at != std::string_view::npos;
       at = text.find(header, at + 1))
    if (at == 0 || text[at - 1] == '\n') return true;
  return false;
}

// Rewrites messages such as "Error while parsing key-value pair: cannot redefine existing integer
// 'a'".
std::string translate_message(std::string_view description, std::string_view text) {
  std::string words;
  for (const char c : description) words += static_cast<unsigned char>(c) < 0x20 ? ' ' : c;
  if (const std::size_t saw = words.find("expected a comment or whitespace, saw ");
      saw != std::string::npos) {
    const std::string came = words.substr(words.find("saw ") + 4);
    return came == "','"
               ? "not TOML: ',' after a value, expected a decimal point, or the end of "
                 "the line"
               : fmt::format(
                     "not TOML: {} after a value, expected the end of the line{}", came,
                     came.size() == 3 && std::isalpha(static_cast<unsigned char>(came[1])) != 0
                         ? ", because the unit is part of the key"
                         : "");
  }
  if (words.find("unescaped control characters") != std::string::npos)
    return "not TOML: a text has no closing quote in its line, or contains a control character";
  if (words.find("invalid utf-8") != std::string::npos)
    return "not TOML: the line has bytes that are not UTF-8, expected text in UTF-8";
  // A word without quotes, in whose first letters the parser sees true, false, inf or nan.
  const auto has = [&](const char* part) { return words.find(part) != std::string::npos; };
  if (has("could not determine value type") || has("boolean: expected") ||
      has("floating-point: expected 'inf'") || has("floating-point: expected 'nan'"))
    return "not TOML: the value has no recognizable type, expected a number, a text in quotes, "
           "true, false, "
           "[a list] or {a table}";
  const std::size_t twice = words.find("cannot redefine existing ");
  if (twice == std::string::npos) {
    const std::string prefix = "Error while parsing ";
    if (words.rfind(prefix, 0) == 0) words = words.substr(prefix.size());
    return "not TOML: " + words;
  }
  const std::size_t open = words.find('\'', twice);
  const std::size_t close = open == std::string::npos ? open : words.find('\'', open + 1);
  if (close == std::string::npos) return "a key is defined twice";
  const std::string key = words.substr(open + 1, close - open - 1);
  if (has_header(text, "[" + key + "]"))
    return fmt::format(
        "table [{0}] is defined twice, expected once, or [[{0}]] above each entry if "
        "it is a list of tables",
        printable(key));
  return fmt::format("key '{}' is defined twice, expected once", printable(key));
}

}  // namespace

TomlTable TomlTable::parse(const std::string& text, const std::string& origin, std::size_t limit) {
  require_text(text, origin, limit);
  require_short_lines(text, origin);
  try {
    const toml::table table = toml::parse(std::string_view(text));
    auto root = std::make_shared<TomlNode>(Converter(origin).convert(table, 1, 0));
    const TomlNode* node = root.get();
    return TomlTable(std::move(root), node, origin, "");
  } catch (const toml::parse_error& error) {
    const auto line = std::max<toml::source_index>(error.source().begin.line, 1);
    throw InvalidInput(fmt::format("{}:{}", origin, line),
                       translate_message(error.description(), text));
  }
}

}  // namespace quadtune::internal
