// SPDX-License-Identifier: Apache-2.0
/// Which commands take a kind of file: for messages about a file that came to the wrong one.
#pragma once

#include <string>
#include <vector>

namespace quadtune::cli {

/// @param args   the command line after the program's name
/// @param where  what an error complains about: a file, "file:line", or else
/// @return       "; FILE is a design file, which quadtune design, export, … take" where `where` is
///               an argument, its kind is known and this command does not take that kind there;
///               "" otherwise
[[nodiscard]] std::string who_takes(const std::vector<std::string>& args, const std::string& where);

}  // namespace quadtune::cli
