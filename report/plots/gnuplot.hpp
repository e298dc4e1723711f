// SPDX-License-Identifier: Apache-2.0
/// Runs gnuplot, which draws what the program shows as pictures.
#pragma once

#include <functional>
#include <string>

namespace quadtune::report {

/// Gives a script to gnuplot on its standard input and returns what it puts on its standard output:
/// the picture, where the script names a terminal and no output. No shell is in between, no file is
/// written, and no start-up file of the user is read, so that the same script gives the same bytes.
///
/// @param file  the picture's file, for the messages
/// @param stop  asked several times a second; when it returns true, gnuplot is ended
/// @throws FileError    "FILE: not drawn: …": gnuplot is not installed, or its reason on one line
/// @throws Interrupted  where `stop` returned true
[[nodiscard]] std::string run_gnuplot(const std::string& script, const std::string& file,
                                      const std::function<bool()>& stop = {});

}  // namespace quadtune::report
