// SPDX-License-Identifier: Apache-2.0
/// An option that a file sets: its refusal names the place in the file.
#pragma once

#include <string>

#include "quadtune/errors.hpp"

namespace quadtune {

/// Calls `function`, which reads options that stand in a file.
/// @param where  "file:line"
/// @throws InvalidInput  in place of OptionError, with `where` before its message
template <class Function>
auto option_of_file(const std::string& where, Function&& function) {
  try {
    return function();
  } catch (const OptionError& error) {
    throw InvalidInput(where, error.what());
  }
}

}  // namespace quadtune
