// SPDX-License-Identifier: Apache-2.0
#include <algorithm>

#include "mutate.hpp"

namespace quadtune::mutations {
namespace {

/// Words that may follow an option. No name leads out of the folder of a case.
std::string any_value(const std::vector<std::string>& words, Random& random) {
  static const std::vector<std::string> lists = {
      "1,2",    "1,2,3",       "1,,2",        ",",           "1,",
      "0,0",    "x,y",         "roll=1",      "roll=1,x=2",  "roll=",
      "=1",     "a=b",         "0:1",         "1:0",         "nan:1",
      "0.5:2",  "1:1:1",       "speed=0:1:2", "speed=0:0:1", "speed=0:1e-9:1",
      "mass=1", "mass=0",      "north=3",     "north=nan",   "gust_at=5",
      "none",   "all",         "x y",         "[1]",         "@/none",
      "@",      "@/v.toml",    "hover",       "mambo",       "uquad",
      "ned",    "a.svg",       "t_s:1",       "height[m]:2", "*",
      "y=z",    "local-level", "-1",          "--",          "-",
      "-o",     "--json",      "--help",      "-h"};
  switch (random.below(4)) {
    case 0:
      return random.of(odd_numbers());
    case 1:
      return random.of(lists);
    case 2:
      return random.of(words);
    default: {
      const std::string text = random.of(odd_texts());
      // A name outside the folder would be written to.
      return text.find('/') == std::string::npos ? text : "@/" + std::string(3, 'a');
    }
  }
}

/// A value that is a list or a number, with a part changed.
std::string changed_value(std::string value, Random& random) {
  const std::size_t at = random.below(value.size() + 1);
  switch (random.below(5)) {
    case 0:
      return value + "," + random.of(odd_numbers());
    case 1:
      return value.substr(0, at);
    case 2: {
      const std::size_t comma = value.find_first_of(",=:", at);
      if (comma == std::string::npos) return random.of(odd_numbers());
      return value.substr(0, comma + 1) + random.of(odd_numbers());
    }
    case 3:
      return value.insert(at, 1, random.of(std::string(",:= []-.e9x\xff")));
    default:
      return value.erase(at, 1);
  }
}

}  // namespace

std::vector<std::string> mutated_words(std::vector<std::string> words,
                                       const std::vector<std::string>& options, Random& random) {
  for (std::size_t i = 1 + random.below(random.percent(60) ? 1 : 3); i > 0; --i) {
    if (words.empty()) return words;
    const std::size_t at = random.below(words.size());
    const auto here = words.begin() + static_cast<std::ptrdiff_t>(at);
    const bool path = words[at].find('/') != std::string::npos;
    switch (random.below(8)) {
      case 0:
        words.erase(here);
        break;
      case 1:
        words.insert(here, std::string(words[at]));
        break;
      case 2:
        std::swap(words[at], words[random.below(words.size())]);
        break;
      case 3:
        words[at] = any_value(words, random);
        break;
      case 4:
      case 5:
        if (!options.empty()) {
          words.push_back(random.of(options));
          if (random.percent(80)) words.push_back(any_value(words, random));
        }
        break;
      case 6:
        if (words[at].starts_with("--") && at + 1 < words.size()) {
          words[at] += "=" + words[at + 1];
          words.erase(words.begin() + static_cast<std::ptrdiff_t>(at + 1));
        }
        break;
      default:
        if (!path && !words[at].starts_with("-")) words[at] = changed_value(words[at], random);
    }
  }
  return words;
}

}  // namespace quadtune::mutations
