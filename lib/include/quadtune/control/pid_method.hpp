// SPDX-License-Identifier: Apache-2.0
/// Ways to sample a PID controller.
#pragma once

#include <string>

namespace quadtune {

/// What the sampled controller puts in the place of s.
enum class PidMethod {
  forward_euler,   ///< (z - 1) / dt
  backward_euler,  ///< (z - 1) / (dt z)
  tustin,          ///< (2/dt) (z - 1) / (z + 1)
};

/// "euler", "backward-euler", "tustin".
[[nodiscard]] std::string to_string(PidMethod method);
/// @throws InvalidInput  naming the word and the three that exist.
[[nodiscard]] PidMethod pid_method(const std::string& name, const std::string& where);

}  // namespace quadtune
