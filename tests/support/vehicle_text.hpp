// SPDX-License-Identifier: Apache-2.0
/// The text of a small vehicle file, for tests of single keys.
#pragma once

#include <string>

namespace quadtune::testing {

/// A plus of four rotors.
/// @param shared  lines in [rotor];  @param own  lines in the first of [[rotors]]
/// @param motor   lines in [motor];  @param more  tables at the end
[[nodiscard]] inline std::string vehicle_text(const std::string& shared,
                                              const std::string& own = "",
                                              const std::string& motor = "",
                                              const std::string& more = "") {
  const auto rotor = [](const char* position, const char* spin) {
    return std::string("[[rotors]]\nposition_m = ") + position + "\nspin = \"" + spin + "\"\n";
  };
  return "name = \"plus\"\n[body]\nmass_kg = 1.0\ninertia_kg_m2 = [1e-2, 1e-2, 1.5e-2]\n"
         "[rotor]\nthrust_a2_N_s2_per_rad2 = 5e-5\ntorque_d2_N_m_s2_per_rad2 = 1e-6\n" +
         shared + "\n[motor]\ncommand = \"speed\"\nmin_rad_s = 50\nmax_rad_s = 400\n" + motor +
         "\n" + rotor("[0.3, 0, 0]", "cw") + own + "\n" + rotor("[0, 0.3, 0]", "ccw") +
         rotor("[-0.3, 0, 0]", "cw") + rotor("[0, -0.3, 0]", "ccw") + more;
}

}  // namespace quadtune::testing
