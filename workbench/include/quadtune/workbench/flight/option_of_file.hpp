// SPDX-License-Identifier: Apache-2.0
/// Reports an invalid option of a file with its place in the file.
#pragma once

#include <string>

#include "quadtune/errors.hpp"

namespace quadtune {

/// Calls `function`, which uses options that were read from a file.
/// @param where  "file:line"
/// @throws InvalidInput  instead of OptionError, with `where` before its message
template <class Function>
auto option_of_file(const std::string& where, Function&& function) {
  try {
    return function();
  } catch (const OptionError& error) {
    throw InvalidInput(where, error.what());
  }
}

}  // namespace quadtune
