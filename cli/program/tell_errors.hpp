// SPDX-License-Identifier: Apache-2.0
/// How a failing run is reported: one line, with --json an object, and an exit status.
#pragma once

#include <string>
#include <vector>

namespace quadtune::cli {

struct Context;

/// Registers this run as the one whose errors are reported, including those of a signal and of
/// std::terminate().
void begin_telling_errors(const Context& context);
void end_telling_errors();

/// Reports the exception that is being handled.
/// @param args  the command line after the program's name
/// @return      the exit status
int tell_exception(const Context& context, const std::vector<std::string>& args);

}  // namespace quadtune::cli
