// SPDX-License-Identifier: Apache-2.0
/// Changes of a valid input that respect its structure.
#pragma once

#include <string>
#include <vector>

#include "random.hpp"

namespace quadtune::mutations {

/// The structure of an input.
enum class Format {
  toml,
  json,
  numbers,  ///< rows of numbers, a line of names perhaps: matrices, tables, logs as text
  words,    ///< any other text
  ulog,
  mat,
  records,  ///< flights of a campaign
};

/// The bytes with one to four changes.
[[nodiscard]] std::string mutated(const std::string& bytes, Format format, Random& random);

/// A command line with one to three changes.
/// @param options  options of the command
[[nodiscard]] std::vector<std::string> mutated_words(std::vector<std::string> words,
                                                     const std::vector<std::string>& options,
                                                     Random& random);

// The parts of mutated(), each one change.

void change_tree(struct Node& root, bool json, Random& random);
void change_numbers(std::string& text, Random& random);
/// Lines, letters and bytes of any text.
void change_text(std::string& text, Random& random);
/// Bits, lengths, cuts of any bytes.
void change_bytes(std::string& bytes, Random& random);
void change_ulog(std::string& bytes, Random& random);
void change_mat(std::string& bytes, Random& random);
void change_records(std::string& bytes, Random& random);

/// Numbers at which programs fail, and words that look like numbers.
[[nodiscard]] const std::vector<std::string>& odd_numbers();
/// Texts that are difficult for some format, ready to be put between quotes.
[[nodiscard]] const std::vector<std::string>& odd_texts();

}  // namespace quadtune::mutations
