// SPDX-License-Identifier: Apache-2.0
/// The Mambo's cascade as `quadtune pid mambo` designs it, for flights that do not wait for the
/// design. tests/cli/cascade_test.cpp compares the numbers with the command.
#pragma once

#include <array>
#include <string>

#include "quadtune/simulation/flight.hpp"

namespace quadtune::testing {

struct DesignedLoop {
  const char* name;
  double Kp, Ki, Kd;  ///< as PidLoop
};

/// As printed by the command, with four digits.
inline constexpr std::array<DesignedLoop, kCascadeAxes> kDesignedMambo = {
    {{"roll", 0.01078, 0.02777, -0.001508},
     {"pitch", 0.01324, 0.03435, -0.001623},
     {"yaw", 0.004025, 0.004904, -0.001079},
     {"altitude", 0.8048, 0.5537, -0.3858},
     {"y", 0.1834, 0.03979, -0.1684},
     {"x", -0.2237, -0.05286, 0.1841}}};

inline CascadeController designed_mambo_cascade() {
  CascadeController controller;
  controller.gains = load_vehicle("mambo").published_cascade->gains;
  for (PidLoop& loop : controller.gains.loops)
    for (const DesignedLoop& designed : kDesignedMambo)
      if (loop.name == designed.name) {
        loop.Kp = designed.Kp;
        loop.Ki = designed.Ki;
        loop.Kd = designed.Kd;
      }
  controller.back_calculation = 2;
  return controller;
}

}  // namespace quadtune::testing
