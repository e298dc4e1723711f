// SPDX-License-Identifier: Apache-2.0
#include "tree.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cctype>
#include <nlohmann/json.hpp>
#include <sstream>
#include <stdexcept>
#define TOML_EXCEPTIONS 1
#include <toml++/toml.h>

namespace quadtune::mutations {
namespace {

using Json = nlohmann::ordered_json;

Node tree_of(const Json& json) {
  if (json.is_string()) return leaf(quoted(json.get<std::string>()));
  if (!json.is_structured()) return leaf(json.dump());
  Node node{json.is_object() ? Node::Kind::table : Node::Kind::list};
  for (const auto& [key, value] : json.items())
    node.parts.emplace_back(json.is_object() ? key : "", tree_of(value));
  return node;
}

Node tree_of(const toml::node& toml) {
  if (const toml::table* table = toml.as_table()) {
    // In the order of the file.
    std::vector<std::pair<std::string, const toml::node*>> members;
    for (const auto& [key, value] : *table) members.emplace_back(std::string(key.str()), &value);
    std::stable_sort(members.begin(), members.end(), [](const auto& a, const auto& b) {
      return a.second->source().begin < b.second->source().begin;
    });
    Node node{Node::Kind::table};
    for (const auto& [key, value] : members) node.parts.emplace_back(key, tree_of(*value));
    return node;
  }
  if (const toml::array* array = toml.as_array()) {
    Node node{Node::Kind::list};
    for (const toml::node& value : *array) node.parts.emplace_back("", tree_of(value));
    return node;
  }
  if (const auto* text = toml.as_string()) return leaf(quoted(text->get()));
  if (const auto* truth = toml.as_boolean()) return leaf(truth->get() ? "true" : "false");
  if (const auto* whole = toml.as_integer()) return leaf(fmt::format("{}", whole->get()));
  if (const auto* number = toml.as_floating_point()) {
    std::string digits = fmt::format("{}", number->get());
    if (digits.find_first_of(".en") == std::string::npos) digits += ".0";
    return leaf(digits);
  }
  throw std::runtime_error("a seed has a date");
}

std::string key_of(const std::string& name) {
  const bool bare = !name.empty() && std::all_of(name.begin(), name.end(), [](unsigned char c) {
    return std::isalnum(c) || c == '_' || c == '-';
  });
  return bare ? name : quoted(name);
}

std::string inline_toml(const Node& node) {
  if (node.kind == Node::Kind::leaf) return node.text;
  const bool table = node.kind == Node::Kind::table;
  std::string text = table ? "{ " : "[";
  for (std::size_t i = 0; i < node.parts.size(); ++i) {
    if (i > 0) text += ", ";
    if (table) text += key_of(node.parts[i].first) + " = ";
    text += inline_toml(node.parts[i].second);
  }
  return text + (table ? " }" : "]");
}

bool is_list_of_tables(const Node& node) {
  return node.kind == Node::Kind::list && !node.parts.empty() &&
         std::all_of(node.parts.begin(), node.parts.end(),
                     [](const auto& part) { return part.second.kind == Node::Kind::table; });
}

void write_toml(const Node& table, const std::string& path, std::string& text) {
  for (const auto& [name, node] : table.parts)
    if (node.kind != Node::Kind::table && !is_list_of_tables(node))
      text += key_of(name) + " = " + inline_toml(node) + "\n";
  for (const auto& [name, node] : table.parts) {
    const std::string inner = path.empty() ? key_of(name) : path + "." + key_of(name);
    if (node.kind == Node::Kind::table) {
      text += "[" + inner + "]\n";
      write_toml(node, inner, text);
    } else if (is_list_of_tables(node)) {
      for (const auto& [none, part] : node.parts) {
        text += "[[" + inner + "]]\n";
        write_toml(part, inner, text);
      }
    }
  }
}

}  // namespace

Node leaf(const std::string& text) { return {Node::Kind::leaf, text}; }

std::string quoted(const std::string& text) {
  std::string result = "\"";
  for (const char c : text) {
    const auto byte = static_cast<unsigned char>(c);
    if (c == '"' || c == '\\')
      result += std::string("\\") + c;
    else if (byte < 0x20 || byte == 0x7f)
      result += fmt::format("\\u{:04x}", byte);
    else
      result += c;
  }
  return result + "\"";
}

Node tree_of_toml(const std::string& text) {
  const toml::table table = toml::parse(text);
  return tree_of(static_cast<const toml::node&>(table));
}

Node tree_of_json(const std::string& text) { return tree_of(Json::parse(text)); }

std::string toml_of(const Node& table) {
  if (table.kind != Node::Kind::table) return inline_toml(table) + "\n";
  std::string text;
  write_toml(table, "", text);
  return text;
}

std::string json_of(const Node& node) {
  if (node.kind == Node::Kind::leaf) return node.text;
  const bool table = node.kind == Node::Kind::table;
  std::string text = table ? "{" : "[";
  for (std::size_t i = 0; i < node.parts.size(); ++i) {
    if (i > 0) text += ",";
    if (table) text += quoted(node.parts[i].first) + ":";
    text += json_of(node.parts[i].second);
  }
  return text + (table ? "}" : "]");
}

}  // namespace quadtune::mutations
