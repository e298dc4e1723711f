// SPDX-License-Identifier: Apache-2.0
/// Which commands read a kind of file, for messages about a file that was given to the wrong
/// command.
#pragma once

#include <string>
#include <vector>

namespace quadtune::cli {

/// @param args   the command line after the program's name
/// @param where  the location that an error names: a file, "file:line", or something else
/// @return       "; this is a design file; it is read by: quadtune design, export, …" if `where` is
///               an argument of a known kind that this command does not read there; "" otherwise
[[nodiscard]] std::string who_takes(const std::vector<std::string>& args, const std::string& where);

}  // namespace quadtune::cli
