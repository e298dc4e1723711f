// SPDX-License-Identifier: Apache-2.0
/// Runs gnuplot, which draws all pictures of the program.
#pragma once

#include <functional>
#include <string>

namespace quadtune::report {

/// Runs gnuplot with the script on its standard input and returns its standard output: the picture,
/// if the script sets a terminal and no output. It uses no shell, writes no file and reads no
/// start-up file of the user, so that the same script gives the same bytes.
///
/// @param file  name of the picture's file, for messages
/// @param stop  polled several times a second; if it returns true, gnuplot is terminated
/// @throws FileError    "FILE: not drawn: …": gnuplot is not installed, or its error message on one
///                      line
/// @throws Interrupted  if `stop` returned true
[[nodiscard]] std::string run_gnuplot(const std::string& script, const std::string& file,
                                      const std::function<bool()>& stop = {});

}  // namespace quadtune::report
