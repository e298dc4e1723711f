// SPDX-License-Identifier: Apache-2.0
/// Gains of a cascade of PID loops.
#pragma once

#include <string>
#include <vector>

namespace quadtune {

/// One loop: output = Kp · error + Ki · ∫error + Kd · measured rate.
///
/// The derivative acts on the measured rate with its own sign, so a loop that damps has Kp and Kd
/// of opposite sign.
struct PidLoop {
  std::string name;    ///< "x", "y", "pitch", "roll", "yaw" or "altitude"
  std::string output;  ///< what it commands, e.g. "tau_y"
  std::string unit;    ///< of the output per unit of the error, e.g. "N m/rad"
  double Kp = 0;       ///< [unit]
  double Ki = 0;       ///< [unit / s]
  double Kd = 0;       ///< [unit · s]
};

/// All loops of one flight controller.
struct CascadeGains {
  std::vector<PidLoop> loops;
  double dt = 0;  ///< sample period [s]
};

}  // namespace quadtune
