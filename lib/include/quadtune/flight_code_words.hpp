// SPDX-License-Identifier: Apache-2.0
/// Checks the words that FlightCodeOptions holds, where a design file or an option gives them.
#pragma once

#include <string>
#include <vector>

namespace quadtune {

/// The maximum number of characters of a flight program's prefix.
inline constexpr std::size_t kLongestFlightCodeName = 24;

/// @throws InvalidInput  for a name that cannot be the prefix of the files, types and functions of
/// a
///                       C program: expected are lower-case letters, digits and _, a letter first,
///                       and no word of C or header of its library. `where` is where it was given.
void require_flight_code_name(const std::string& name, const std::string& where);

/// @throws InvalidInput  for other words than "cascaded-pid" and "state-feedback"
void require_flight_code_law(const std::string& law, const std::string& where);

/// "main", "mambo", "crazyflie", "px4".
[[nodiscard]] const std::vector<std::string>& flight_code_adapters();

/// @throws InvalidInput  for another word, naming those that exist and the nearest
void require_flight_code_adapter(const std::string& adapter, const std::string& where);

}  // namespace quadtune
