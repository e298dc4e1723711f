// SPDX-License-Identifier: Apache-2.0
/// The error for an option that the content of a log requires.
#pragma once

#include <string>
#include <utility>

#include "quadtune/errors.hpp"

namespace quadtune {

/// An option that the content of a log requires is missing.
class MissingOption : public InvalidInput {
 public:
  /// @param option   its key, e.g. "rate"
  /// @param message  complete what(), e.g. "no sample rate; expected --rate HZ"
  MissingOption(std::string option, const std::string& message)
      : InvalidInput(Whole{}, std::move(option), message) {}

  [[nodiscard]] const std::string& option() const { return where(); }
};

}  // namespace quadtune
