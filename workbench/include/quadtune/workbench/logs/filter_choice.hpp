// SPDX-License-Identifier: Apache-2.0
/// A filter model with some of its numbers chosen before it is tuned.
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

/// Texts "NAME=WORD" as names and words.
/// @param key   of the option, e.g. "map"
/// @param name  what stands for a name in messages, e.g. "STATE"
/// @param word  what stands for a word, e.g. "CHANNEL"
/// @throws OptionError  naming the key, for a text that has no name or no word
[[nodiscard]] std::vector<std::pair<std::string, std::string>> named_words(
    const std::vector<std::string>& texts, const std::string& key, const std::string& name,
    const std::string& word);

/// The same of texts "NAME=NUMBER".
[[nodiscard]] std::vector<std::pair<std::string, double>> named_numbers(
    const std::vector<std::string>& texts, const std::string& key);

struct FilterChoice {
  std::vector<std::string> fixed;                      ///< parameters that stay as they are
  std::vector<std::pair<std::string, double>> starts;  ///< parameters, and where the search begins
  double gate = 0;     ///< of all sensors, > 0 [variances]; 0: as the model has it
  double student = 0;  ///< degrees of freedom of all sensors, > 2; 0: as the model has it
};

/// @throws InvalidInput  "--fix", "--start" or "--gate, --student": for a parameter that the model
///                       does not have, and a number out of range
[[nodiscard]] FilterModel chosen_filter(FilterModel model, const FilterChoice& choice);

}  // namespace quadtune
