// SPDX-License-Identifier: Apache-2.0
/// How a run that fails tells it: one line, with --json an object, and an exit status.
#pragma once

#include <string>
#include <vector>

namespace quadtune::cli {

struct Context;

/// From now on errors are those of this run: also what a signal, or std::terminate(), ends.
void begin_telling_errors(const Context& context);
void end_telling_errors();

/// Tells of the exception that is being handled.
/// @param args  the command line after the program's name
/// @return      the exit status
int tell_exception(const Context& context, const std::vector<std::string>& args);

}  // namespace quadtune::cli
