// SPDX-License-Identifier: Apache-2.0
/// The option that an error of a library is about. The libraries name functions and their
/// parameters, which a user of the program does not know.
#pragma once

#include <optional>

#include "program/program.hpp"

namespace quadtune {
class InvalidInput;
}

namespace quadtune::cli {

/// "lqr: R has eigenvalue 0, …" becomes "--R has eigenvalue 0, …".
/// @param line  the parsed command line
/// @return  nothing if the place of the error is a file, a vehicle or the value of an option, or
///          if neither its message begins with the name of an option that was given, nor the
///          command is about matrices or a transfer function
[[nodiscard]] std::optional<UsageError> told_by_option(const InvalidInput& error,
                                                       const CommandLine& line);

}  // namespace quadtune::cli
