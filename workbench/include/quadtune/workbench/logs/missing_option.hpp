// SPDX-License-Identifier: Apache-2.0
/// An option that the content of a log makes necessary.
#pragma once

#include <string>
#include <utility>

#include "quadtune/errors.hpp"

namespace quadtune {

/// An option is missing that the content of a log requires.
class MissingOption : public InvalidInput {
 public:
  /// @param option   its key, e.g. "rate"
  /// @param message  what() as a whole, e.g. "no sample rate came, expected --rate HZ"
  MissingOption(std::string option, const std::string& message)
      : InvalidInput(Whole{}, std::move(option), message) {}

  [[nodiscard]] const std::string& option() const { return where(); }
};

}  // namespace quadtune
