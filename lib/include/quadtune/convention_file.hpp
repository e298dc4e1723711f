// SPDX-License-Identifier: Apache-2.0
/// User-defined conventions: a TOML file maps the states of a flight code to those of
/// ned_convention(). Format: docs/formats.md, "Convention files".
#pragma once

#include <filesystem>
#include <string>

#include "quadtune/convention.hpp"

namespace quadtune {

/// @param text    content of the file
/// @param origin  the file's name in messages
/// @throws InvalidInput  "origin:line: …" unless the states and the wrench are signed permutations
///                       of those of ned_convention() and all names are unique
[[nodiscard]] Convention parse_convention(const std::string& text, const std::string& origin);

/// The text of a convention file that parse_convention() reads back as the same convention.
[[nodiscard]] std::string convention_text(const Convention& convention);

/// Registers a convention so that convention() finds it by name, until the program ends.
/// Thread-safe. Has no effect if the same convention is already registered.
/// @return  the registered convention, valid until the program ends
/// @throws InvalidInput  if a different convention has the same name
const Convention& add_convention(const Convention& convention, const std::string& where);

/// The convention of a user's word: a registered name, or the path of a convention file ending in
/// ".toml", which is read and registered.
/// @param word    a registered name, or a path that ends in ".toml"
/// @param where   beginning of messages
/// @param folder  base of a relative path; empty: the current folder
/// @throws InvalidInput  as convention(), parse_convention() and add_convention()
/// @throws FileError     if the file cannot be read
[[nodiscard]] const Convention& named_convention(const std::string& word, const std::string& where,
                                                 const std::filesystem::path& folder = {});

/// Whether a convention has the name of a built-in one, that is one of conventions().
[[nodiscard]] bool is_built_in(const Convention& convention);

}  // namespace quadtune
