// SPDX-License-Identifier: Apache-2.0
/// A cascade of PID loops: its gains, and what is asked of them.
#pragma once

#include <array>
#include <cstddef>
#include <optional>
#include <string>
#include <vector>

#include "quadtune/control/pid_method.hpp"

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

/// Gains that fly on a vehicle today.
struct PublishedCascade {
  std::string source;  ///< where they were published
  CascadeGains gains;
};

/// The loops of a multirotor's cascade. x and y give the references of pitch and roll.
enum class CascadeAxis { x, y, pitch, roll, yaw, altitude };
inline constexpr std::size_t kCascadeAxes = 6;

/// In this order wherever something is listed by axis.
inline constexpr std::array<CascadeAxis, kCascadeAxes> kAllCascadeAxes = {
    CascadeAxis::x,    CascadeAxis::y,   CascadeAxis::pitch,
    CascadeAxis::roll, CascadeAxis::yaw, CascadeAxis::altitude};

/// Where an axis stands in such a list.
[[nodiscard]] constexpr std::size_t index_of(CascadeAxis axis) {
  return static_cast<std::size_t>(axis);
}

/// "x", "y", "pitch", "roll", "yaw", "altitude": the names of the loops.
[[nodiscard]] std::string to_string(CascadeAxis axis);
/// All of them.
[[nodiscard]] std::vector<std::string> cascade_axis_names();
/// @throws InvalidInput  naming the word and the six that exist.
[[nodiscard]] CascadeAxis cascade_axis(const std::string& name, const std::string& where);

/// The loop of an axis with what it commands and in which unit, gains 0.
[[nodiscard]] PidLoop cascade_loop(CascadeAxis axis);

/// What is asked of one loop. What is not said follows from published gains where there are any and
/// no bandwidth is said either: their noise and the peak that a load leaves are not exceeded, nor
/// is their Ms, which is to be 2 % nearer to 1.
struct CascadeRequirement {
  /// Where the loop of the rate crosses 1 [rad/s], exactly. If it is not said: at most at a
  /// twentieth of the sample rate and at a third of the bandwidth of the loop inside.
  std::optional<double> bandwidth;
  double Ms_max = 1.4;        ///< max |S| of the loop, > 1
  double tracking_max = 1.3;  ///< max |value / set point|, > 1
  bool integral = true;       ///< false: the loop has no Ki
};

/// What a loop's gains may be.
enum class CascadeStructure {
  pid,  ///< Kp, Ki and Kd are free
  /// The value's error times a gain is the set point of a PI controller of the rate, as autopilots
  /// have it. With Kp, Ki and |Kd| these are the same feedback where Kp² ≥ 4 |Kd| Ki, and only
  /// there.
  p_pi,
};
/// "pid", "p-pi".
[[nodiscard]] std::string to_string(CascadeStructure structure);
/// @throws InvalidInput  naming the word and the two that exist.
[[nodiscard]] CascadeStructure cascade_structure(const std::string& name, const std::string& where);

/// The greatest Ki with which gains of the structure p_pi exist.
[[nodiscard]] constexpr double greatest_p_pi_integral(double Kp, double Kd) {
  return Kp * Kp / (4 * (Kd < 0 ? -Kd : Kd));
}

/// Longest delay of a sensor [samples]: each sample is a state of every loop that is tried.
inline constexpr int kMostDelaySamples = 40;

/// What is asked of a cascade, and with which clock and sensors it shall fly.
struct CascadeSpecification {
  double dt = 0;                                              ///< sample period [s], > 0
  PidMethod method = PidMethod::forward_euler;                ///< of the integrals
  std::optional<double> lag;                                  ///< of the motors [s]; the vehicle's
  std::array<double, kCascadeAxes> delay{};                   ///< of each loop's sensors [s]
  std::array<CascadeRequirement, kCascadeAxes> requirements;  ///< by axis
  CascadeStructure structure = CascadeStructure::pid;         ///< of every loop
  bool use_published = true;  ///< whether published gains bound the loops without a bandwidth
};

}  // namespace quadtune
