// SPDX-License-Identifier: Apache-2.0
/// "No such file" with what was looked for and what is there instead.
#pragma once

#include <string>

namespace quadtune {
class FileError;
}

namespace quadtune::cli {

class CommandLine;

/// Whether a file is missing, and not unreadable.
[[nodiscard]] bool is_missing(const FileError& error);

/// What the option that named the file takes, and the names that are nearest: of its folder, and of
/// what is built in.
/// @param line  the verb's options, after parse()
[[nodiscard]] FileError told_missing(const FileError& error, const CommandLine& line);

}  // namespace quadtune::cli
