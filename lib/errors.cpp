// SPDX-License-Identifier: Apache-2.0
#include "quadtune/errors.hpp"

namespace quadtune {

InvalidInput::InvalidInput(const std::string& where, const std::string& message)
    : std::invalid_argument(where.empty() ? message : where + ": " + message),
      where_(where),
      message_(message) {}

}  // namespace quadtune
