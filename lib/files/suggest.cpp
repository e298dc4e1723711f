// SPDX-License-Identifier: Apache-2.0
#include "quadtune/internal/suggest.hpp"

#include <algorithm>

namespace quadtune::internal {
namespace {

/// Whether two neighbouring letters are swapped, which is one mistake and not two.
bool are_swapped(const std::string& a, const std::string& b) {
  if (a.size() != b.size()) return false;
  const auto [at, from] = std::mismatch(a.begin(), a.end(), b.begin());
  if (a.end() - at < 2) return false;
  return at[0] == from[1] && at[1] == from[0] && std::equal(at + 2, a.end(), from + 2);
}

}  // namespace

std::size_t edit_distance(const std::string& a, const std::string& b) {
  std::vector<std::size_t> row(b.size() + 1);
  for (std::size_t j = 0; j <= b.size(); ++j) row[j] = j;
  for (std::size_t i = 1; i <= a.size(); ++i) {
    std::size_t diagonal = row[0];
    row[0] = i;
    for (std::size_t j = 1; j <= b.size(); ++j) {
      const std::size_t replace = diagonal + (a[i - 1] == b[j - 1] ? 0 : 1);
      diagonal = row[j];
      row[j] = std::min({replace, row[j] + 1, row[j - 1] + 1});
    }
  }
  return row[b.size()];
}

std::string nearest(const std::string& word, const std::vector<std::string>& known) {
  std::string best;
  // The dashes of an option are no letters: "--W" resembles every short option.
  const std::size_t dashes = std::min(word.find_first_not_of('-'), word.size());
  const std::size_t letters = word.size() - dashes;
  if (letters < 4) return best;
  std::size_t min = (letters + 1) / 3 + 1;  // up to a third of the letters may differ
  for (const std::string& candidate : known) {
    const std::size_t distance = are_swapped(word, candidate) ? 1 : edit_distance(word, candidate);
    if (distance < min) {
      min = distance;
      best = candidate;
    }
  }
  if (!best.empty()) return best;
  // A part of a longer name: "--thrust" of "--max-thrust".
  const std::string part = word.substr(dashes);
  for (const std::string& candidate : known)
    if (candidate.find(part) != std::string::npos &&
        (best.empty() || candidate.size() < best.size()))
      best = candidate;
  return best;
}

std::string did_you_mean(const std::string& word, const std::vector<std::string>& known) {
  const std::string best = nearest(word, known);
  return best.empty() ? "" : "; did you mean '" + best + "'?";
}

}  // namespace quadtune::internal
