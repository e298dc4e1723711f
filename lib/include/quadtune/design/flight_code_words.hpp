// SPDX-License-Identifier: Apache-2.0
/// Validates the strings of FlightCodeOptions that a design file or an option sets.
#pragma once

#include <string>
#include <vector>

namespace quadtune {

/// Maximum number of characters of the prefix of exported flight code.
inline constexpr std::size_t kMaxFlightCodeName = 24;

/// @throws InvalidInput  if the name cannot prefix the files, types and functions of a C program.
///                       It must consist of lower-case letters, digits and _, start with a letter,
///                       and be neither a C keyword nor the name of a C library header. `where` is
///                       the place of the name.
void require_flight_code_name(const std::string& name, const std::string& where);

/// @throws InvalidInput  unless the law is "cascaded-pid" or "state-feedback"
void require_flight_code_law(const std::string& law, const std::string& where);

/// "main", "mambo", "crazyflie", "px4".
[[nodiscard]] const std::vector<std::string>& flight_code_adapters();

/// @throws InvalidInput  for an unknown adapter, with the known ones and the nearest of them
void require_flight_code_adapter(const std::string& adapter, const std::string& where);

}  // namespace quadtune
