// SPDX-License-Identifier: Apache-2.0
/// Discretization methods of a PID controller.
#pragma once

#include <string>

namespace quadtune {

/// The expression that replaces s in the sampled controller.
enum class PidMethod {
  forward_euler,   ///< (z - 1) / dt
  backward_euler,  ///< (z - 1) / (dt z)
  tustin,          ///< (2/dt) (z - 1) / (z + 1)
};

/// "euler", "backward-euler", "tustin".
[[nodiscard]] std::string to_string(PidMethod method);
/// @throws InvalidInput  with the unknown name and the three valid ones.
[[nodiscard]] PidMethod pid_method(const std::string& name, const std::string& where);

}  // namespace quadtune
