// SPDX-License-Identifier: Apache-2.0
#include <fmt/format.h>

#include <algorithm>

#include "quadtune/errors.hpp"
#include "quadtune/internal/joined.hpp"
#include "quadtune/internal/suggest.hpp"
#include "quadtune/linearize/linearize.hpp"

namespace quadtune {
namespace {

// Whether a state is px, py, u or v of ned_convention(), which only GPS or a camera measures.
bool is_horizontal(const Convention& convention, Eigen::Index state) {
  for (const Eigen::Index ned : {0, 1, 6, 7})
    if (convention.from_ned(state, ned) != 0) return true;
  return false;
}

Eigen::Index find(const std::vector<std::string>& known, const std::string& name,
                  const Convention& convention, const std::string& where) {
  const auto found = std::find(known.begin(), known.end(), name);
  if (found == known.end())
    throw InvalidInput(
        where, fmt::format("no state '{}' in convention '{}', expected names from {}{}", name,
                           convention.name, internal::joined(known, " "),
                           internal::did_you_mean(name, known)));
  return found - known.begin();
}

}  // namespace

StateSelection state_selection(const std::string& text, const std::string& where) {
  StateSelection selection;
  std::string word;
  for (const char letter : text + ' ') {
    if (letter != ',' && letter != ' ' && letter != '\t') {
      word += letter;
    } else if (!word.empty()) {
      selection.names.push_back(word);
      word.clear();
    }
  }
  if (selection.names.empty())
    throw InvalidInput(where,
                       fmt::format("'{}' does not name a state, expected full, no-position or a "
                                   "list of names",
                                   text));
  if (selection.names == std::vector<std::string>{"full"}) return {};
  if (selection.names == std::vector<std::string>{"no-position"})
    return {StateSelection::Kind::no_position, {}};
  selection.kind = StateSelection::Kind::list;
  return selection;
}

std::vector<Eigen::Index> selected_states(const Convention& convention,
                                          const StateSelection& selection,
                                          const std::string& where) {
  const std::vector<std::string> known = names_or_numbers(convention.states, 12);
  std::vector<Eigen::Index> selected;
  if (selection.kind != StateSelection::Kind::list) {
    const bool all = selection.kind == StateSelection::Kind::full;
    for (Eigen::Index i = 0; i < 12; ++i)
      if (all || !is_horizontal(convention, i)) selected.push_back(i);
    return selected;
  }
  if (selection.names.empty())
    throw InvalidInput(where, fmt::format("the list of states is empty, expected names from {}",
                                          internal::joined(known, " ")));
  for (const std::string& name : selection.names) {
    const Eigen::Index i = find(known, name, convention, where);
    if (std::find(selected.begin(), selected.end(), i) != selected.end())
      throw InvalidInput(where,
                         fmt::format("state '{}' is listed twice, expected each once", name));
    selected.push_back(i);
  }
  return selected;
}

}  // namespace quadtune
