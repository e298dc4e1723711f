// SPDX-License-Identifier: Apache-2.0
/// What a design, or its user, chooses of exported flight code.
#pragma once

#include <string>

namespace quadtune {

/// What is free in the exported program.
struct FlightCodeOptions {
  /// Prefix of its files, types and functions: a C identifier of at most 24 characters that begins
  /// with a lower-case letter; empty: that of the vehicle's name.
  std::string name = {};
  bool double_precision = false;  ///< numbers are `double`; usually `float`
  /// "cascaded-pid" or "state-feedback"; empty: the one that the design has.
  std::string law = {};
  /// "main", "mambo", "crazyflie" or "px4": files that join the program to that board; empty: none.
  std::string adapter = {};

  friend bool operator==(const FlightCodeOptions&, const FlightCodeOptions&) = default;
};

/// Whether a precision's name is "double" rather than "float".
/// @throws InvalidInput  naming the word and the two that exist
[[nodiscard]] bool is_double_precision(const std::string& name, const std::string& where);

}  // namespace quadtune
