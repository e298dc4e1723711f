// SPDX-License-Identifier: Apache-2.0
/// Options of exported C flight code, set by a design file or on the command line.
#pragma once

#include <string>

namespace quadtune {

/// Options of the exported program.
struct FlightCodeOptions {
  /// Prefix of its files, types and functions: a C identifier of at most 24 characters that begins
  /// with a lower-case letter. Empty: derived from the vehicle's name.
  std::string name = {};
  bool double_precision = false;  ///< true: numbers are `double`; false: `float`
  /// "cascaded-pid" or "state-feedback"; empty: the law of the design.
  std::string law = {};
  /// "main", "mambo", "crazyflie" or "px4": adds the files that connect the program to that board.
  /// Empty: none.
  std::string adapter = {};

  friend bool operator==(const FlightCodeOptions&, const FlightCodeOptions&) = default;
};

/// Whether a precision is "double" and not "float".
/// @throws InvalidInput  with the unknown name and the two valid ones
[[nodiscard]] bool is_double_precision(const std::string& name, const std::string& where);

}  // namespace quadtune
