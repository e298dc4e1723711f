// SPDX-License-Identifier: Apache-2.0
#include <algorithm>

#include "mutate.hpp"
#include "tree.hpp"

namespace quadtune::mutations {
namespace {

/// A node with its parent.
struct Spot {
  Node* parent;
  std::size_t index;

  [[nodiscard]] Node& node() const { return parent->parts[index].second; }
};

void collect(Node& node, std::vector<Spot>& spots) {
  for (std::size_t i = 0; i < node.parts.size(); ++i) {
    spots.push_back({&node, i});
    collect(node.parts[i].second, spots);
  }
}

bool is_number_node(const Node& node) {
  return node.kind == Node::Kind::leaf && !node.text.empty() &&
         std::string("-+.0123456789").find(node.text[0]) != std::string::npos;
}
bool is_text(const Node& node) { return node.kind == Node::Kind::leaf && node.text[0] == '"'; }

/// Inserted between quotes unchanged: an escape may be one of the parser, a byte may not be UTF-8.
Node odd_text(Random& random) { return leaf("\"" + random.of(odd_texts()) + "\""); }

Node deep(std::size_t depth, const Node& core) {
  Node node = core;
  for (std::size_t i = 0; i < depth; ++i) {
    Node around{Node::Kind::list};
    around.parts.emplace_back("", std::move(node));
    node = std::move(around);
  }
  return node;
}

Node of_another_type(bool json, Random& random) {
  static const std::vector<std::string> words = {
      "\"text\"", "\"\"", "true", "false", "1",         "-1",      "0.5",
      "[]",       "{}",   "[[]]", "[1]",   "[1, 2, 3]", "[\"a\"]", "[true, 1]"};
  if (random.percent(15)) return leaf(json ? "null" : "1979-05-27T07:32:00Z");
  return leaf(random.of(words));
}

/// The number times a power of ten, with another sign, or another number altogether.
void change_number(Node& node, Random& random) {
  switch (random.below(5)) {
    case 0:
      node.text = "-" + node.text;
      break;
    case 1:
      if (node.text.find_first_of("eE") == std::string::npos)
        node.text += "e" + std::to_string(static_cast<int>(random.below(13)) - 6);
      break;
    default:
      node.text = random.of(odd_numbers());
  }
}

std::string other_name(const std::string& name, Random& random) {
  switch (random.below(5)) {
    case 0:
      return name.substr(0, name.size() - std::min<std::size_t>(1, name.size()));
    case 1:
      return name + "s";
    case 2:
      return random.of(odd_texts());
    case 3: {
      const std::size_t unit = name.rfind('_');
      return unit == std::string::npos ? name + "_m" : name.substr(0, unit) + "_mm";
    }
    default:
      return std::string(1 + random.below(3), 'x');
  }
}

void change_list(Node& list, Random& random) {
  auto& parts = list.parts;
  if (parts.empty()) {
    parts.emplace_back("", leaf(random.of(odd_numbers())));
    return;
  }
  const std::size_t at = random.below(parts.size());
  switch (random.below(6)) {
    case 0:
      parts.erase(parts.begin() + static_cast<std::ptrdiff_t>(at));
      break;
    case 1:
      parts.insert(parts.begin() + static_cast<std::ptrdiff_t>(at), std::pair(parts[at]));
      break;
    case 2:
      parts.clear();
      break;
    case 3:
      std::reverse(parts.begin(), parts.end());
      break;
    case 4: {
      const auto part = parts[at];
      if (list.kind == Node::Kind::list)
        parts.insert(parts.end(), random.percent(80) ? 5 : 500, part);
      break;
    }
    default:
      std::swap(parts[at].second, parts[random.below(parts.size())].second);
  }
}

}  // namespace

void change_tree(Node& root, bool json, Random& random) {
  std::vector<Spot> spots;
  collect(root, spots);
  if (spots.empty()) {
    root.parts.emplace_back(random.of(odd_texts()), of_another_type(json, random));
    return;
  }
  const Spot spot = random.of(spots);
  auto& siblings = spot.parent->parts;
  const auto here = siblings.begin() + static_cast<std::ptrdiff_t>(spot.index);
  Node& node = spot.node();
  // Half of the time the value of a leaf: a wrong range, name or type.
  if (node.kind == Node::Kind::leaf && random.percent(50)) {
    if (is_number_node(node) && random.percent(80))
      change_number(node, random);
    else if (is_text(node) && random.percent(80))
      node = odd_text(random);
    else
      node = of_another_type(json, random);
    return;
  }
  switch (random.below(10)) {
    case 0:
    case 1:
      siblings.erase(here);
      break;
    case 2: {
      const auto twice = *here;
      siblings.insert(here, twice);
      break;
    }
    case 3:
      if (spot.parent->kind == Node::Kind::table)
        siblings[spot.index].first = other_name(siblings[spot.index].first, random);
      else
        change_list(*spot.parent, random);
      break;
    case 4: {  // content of another place: the name of another node, another shape
      const Node other = random.of(spots).node();
      spot.node() = other;
      break;
    }
    case 5:
      node = of_another_type(json, random);
      break;
    case 6:
      node = deep(random.percent(60) ? 1 : (random.percent(80) ? 12 : 3000), node);
      break;
    case 7:
      if (spot.parent->kind == Node::Kind::table && !siblings.empty())
        siblings[spot.index].first = siblings[random.below(siblings.size())].first;
      break;
    default:
      change_list(node.kind == Node::Kind::leaf ? *spot.parent : node, random);
  }
}

}  // namespace quadtune::mutations
