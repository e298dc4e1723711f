// SPDX-License-Identifier: Apache-2.0
/// Conventions of the user's own: a TOML file says which state of a flight program is which of
/// ned_convention(). Format: docs/formats.md, "Convention files".
#pragma once

#include <filesystem>
#include <string>

#include "quadtune/convention.hpp"

namespace quadtune {

/// @param origin  the file's name in messages
/// @throws InvalidInput  "origin:line: …" unless the states and the wrench are signed permutations
///                       of those of ned_convention(), each with a name of its own
[[nodiscard]] Convention parse_convention(const std::string& text, const std::string& origin);

/// The text of a file that parse_convention() reads as the same convention.
[[nodiscard]] std::string convention_text(const Convention& convention);

/// Makes a convention known to convention() by its name, from any thread, until the program ends.
/// Nothing happens if it is known already.
/// @throws InvalidInput  if another convention has the name
const Convention& add_convention(const Convention& convention, const std::string& where);

/// The convention that a user names: by its name, or by a file whose name ends in ".toml", which is
/// read and added.
/// @param folder  that a relative file name is relative to; empty: the current one
/// @throws InvalidInput  as convention(), parse_convention() and add_convention()
/// @throws FileError     if the file cannot be read
[[nodiscard]] const Convention& named_convention(const std::string& word, const std::string& where,
                                                 const std::filesystem::path& folder = {});

/// Whether it is one of conventions(), which every program knows.
[[nodiscard]] bool is_built_in(const Convention& convention);

}  // namespace quadtune
