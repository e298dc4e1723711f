// SPDX-License-Identifier: Apache-2.0
#include "logs/mat/mat_fields.hpp"

#include <fmt/format.h>

#include <memory>
#include <unordered_map>

namespace quadtune::internal {
namespace {

constexpr std::size_t kMaxName = 63;
constexpr int kDeepest = 4;  // levels of nested structs; further dots in a name are replaced by '_'

bool is_letter(char c) { return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z'); }
bool is_digit(char c) { return c >= '0' && c <= '9'; }

// Keywords of MATLAB and of Octave, which has the long "end…" forms.
bool is_keyword(const std::string& name) {
  constexpr std::string_view kKeywords =
      " break case catch classdef continue do else elseif end end_try_catch end_unwind_protect "
      "endclassdef endfor endfunction endif endparfor endswitch endwhile for function global if "
      "otherwise parfor persistent return spmd switch try until unwind_protect "
      "unwind_protect_cleanup while ";
  return kKeywords.find(' ' + name + ' ') != std::string_view::npos;
}

std::string identifier(std::string_view text) {
  std::string name;
  for (const char c : text)
    if ((static_cast<unsigned char>(c) & 0xc0U) != 0x80)  // one '_' per UTF-8 character
      name += is_letter(c) || is_digit(c) ? c : '_';
  if (name.empty() || !is_letter(name[0]) || is_keyword(name)) name.insert(0, "x");
  return name.substr(0, kMaxName);
}

// Data that FieldTree does not contain: the struct of each part of a name. "a-b.c" and "a_b.c" are
// in different structs.
struct Group {
  FieldNames names;
  std::size_t place = 0;  ///< index among the fields of the enclosing struct
  std::unordered_map<std::string, std::unique_ptr<Group>> groups = {};
};

// Inserts a column below `tree` and appends its fields to `path`.
void place_column(std::string_view name, int column, int depth, Group& group, FieldTree& tree,
                  std::string& path) {
  const std::size_t dot = depth < kDeepest ? name.find('.') : std::string_view::npos;
  if (dot == std::string_view::npos) {
    tree.fields.push_back({group.names.add(name), column, {}});
    path += tree.fields.back().field;
    return;
  }
  const std::string_view part = name.substr(0, dot);
  std::unique_ptr<Group>& inner = group.groups[std::string(part)];
  if (!inner) {
    inner = std::make_unique<Group>();
    inner->place = tree.fields.size();
    tree.fields.push_back({group.names.add(part), -1, {}});
  }
  FieldTree& below = tree.fields[inner->place];
  path += below.field + '.';
  place_column(name.substr(dot + 1), column, depth + 1, *inner, below, path);
}

}  // namespace

std::string FieldNames::add(std::string_view text) {
  const std::string name = identifier(text);
  std::string candidate = name;
  for (int i = 2; !taken_.insert(candidate).second; ++i) {
    const std::string end = fmt::format("_{}", i);
    candidate = name.substr(0, kMaxName - end.size()) + end;
  }
  return candidate;
}

FieldLayout layout_of(const std::vector<std::string>& names,
                      const std::vector<std::string>& taken) {
  FieldLayout layout;
  Group root{FieldNames(taken)};
  for (std::size_t i = 0; i < names.size(); ++i) {
    layout.paths.emplace_back();
    place_column(names[i], static_cast<int>(i), 1, root, layout.root, layout.paths.back());
  }
  return layout;
}

}  // namespace quadtune::internal
