// SPDX-License-Identifier: Apache-2.0
/// "No such file" together with what was expected and which files exist.
#pragma once

#include <string>
#include <vector>

namespace quadtune {
class FileError;
}

namespace quadtune::cli {

class CommandLine;

/// Whether a file does not exist, as opposed to being unreadable.
[[nodiscard]] bool is_missing(const FileError& error);

/// Adds to the error what the option that named the file accepts, and the most similar names, from
/// its folder and of the built-in files.
/// @param line     the options of the command, after parse()
/// @param outputs  the options that name files to write; their errors are returned unchanged
[[nodiscard]] FileError told_missing(const FileError& error, const CommandLine& line,
                                     const std::vector<std::string>& outputs);

}  // namespace quadtune::cli
