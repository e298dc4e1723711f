// SPDX-License-Identifier: Apache-2.0
/// Overrides numbers of a filter model before it is tuned.
#pragma once

#include <string>
#include <utility>
#include <vector>

#include "quadtune/estimation/filter_model.hpp"
#include "quadtune/tuning/noise_tuning.hpp"

namespace quadtune {

/// "ml" or "als".
/// @throws OptionError  "method", for other words
[[nodiscard]] NoiseMethod noise_method(const std::string& word);

/// Parses texts "NAME=WORD" to names and words.
/// @param texts  one for each item
/// @param key    of the option, e.g. "map"
/// @param name   placeholder of the name in messages, e.g. "STATE"
/// @param word   placeholder of the word in messages, e.g. "CHANNEL"
/// @throws OptionError  naming the key, if the name or the word of a text is missing
[[nodiscard]] std::vector<std::pair<std::string, std::string>> named_words(
    const std::vector<std::string>& texts, const std::string& key, const std::string& name,
    const std::string& word);

/// The same for texts "NAME=NUMBER".
[[nodiscard]] std::vector<std::pair<std::string, double>> named_numbers(
    const std::vector<std::string>& texts, const std::string& key);

/// Numbers that override those of a model.
struct FilterChoice {
  std::vector<std::string> fixed;                      ///< parameters that are not tuned
  std::vector<std::pair<std::string, double>> starts;  ///< parameters and their initial values in
                                                       ///< the search
  double gate = 0;     ///< of all sensors, > 0 [variances]; 0: as in the model
  double student = 0;  ///< degrees of freedom of all sensors, > 2; 0: as in the model
};

/// @throws InvalidInput  "--fix", "--start" or "--gate, --student": if the model does not have a
///                       parameter, or a number is out of range
[[nodiscard]] FilterModel chosen_filter(FilterModel model, const FilterChoice& choice);

}  // namespace quadtune
