// SPDX-License-Identifier: Apache-2.0
/// The gains of a cascade of PID loops, and the requirements that they are designed for.
#pragma once

#include <array>
#include <cstddef>
#include <optional>
#include <string>
#include <vector>

#include "quadtune/control/pid_method.hpp"

namespace quadtune {

/// One loop: output = Kp · error + Ki · ∫error + Kd · (rate + rate_lead · rate').
///
/// Here rate is the measured rate and rate' its derivative behind a first-order low pass. Kd has a
/// plus sign, so Kp and Kd of a damped loop have opposite signs.
struct PidLoop {
  std::string name;    ///< "x", "y", "pitch", "roll", "yaw" or "altitude"
  std::string output;  ///< name of the commanded quantity, e.g. "tau_y"
  std::string unit;    ///< of the output per unit of error, e.g. "N m/rad"
  double Kp = 0;       ///< [unit]
  double Ki = 0;       ///< [unit / s]
  double Kd = 0;       ///< [unit · s]
  /// Lead time of the rate [s], ≥ 0; 0: the rate alone. Autopilots call Kd · rate_lead the
  /// derivative gain of the rate.
  double rate_lead = 0;
  double rate_filter = 0;  ///< time constant of the low pass of rate' [s], ≥ 0
};

/// All loops of one flight controller.
struct CascadeGains {
  std::vector<PidLoop> loops;  ///< one for each loop that the controller has
  double dt = 0;               ///< sample period [s]
};

/// Published gains with which a vehicle flies today.
struct PublishedCascade {
  std::string source;  ///< where they were published
  CascadeGains gains;  ///< the published gains
};

/// The loops of a multirotor's cascade. The loops x and y command the references of pitch and roll.
enum class CascadeAxis { x, y, pitch, roll, yaw, altitude };
inline constexpr std::size_t kCascadeAxes = 6;  ///< number of values of CascadeAxis

/// The order of every list by axis.
inline constexpr std::array<CascadeAxis, kCascadeAxes> kAllCascadeAxes = {
    CascadeAxis::x,    CascadeAxis::y,   CascadeAxis::pitch,
    CascadeAxis::roll, CascadeAxis::yaw, CascadeAxis::altitude};

/// The index of an axis in such a list.
[[nodiscard]] constexpr std::size_t index_of(CascadeAxis axis) {
  return static_cast<std::size_t>(axis);
}

/// "x", "y", "pitch", "roll", "yaw", "altitude": the names of the loops.
[[nodiscard]] std::string to_string(CascadeAxis axis);
/// The names of all axes, in the order of kAllCascadeAxes.
[[nodiscard]] std::vector<std::string> cascade_axis_names();
/// @throws InvalidInput  with the unknown name and the six valid ones.
[[nodiscard]] CascadeAxis cascade_axis(const std::string& name, const std::string& where);

/// The loop of an axis with its output and unit set and all gains 0.
[[nodiscard]] PidLoop cascade_loop(CascadeAxis axis);

/// Requirements on one loop. If no bandwidth is given and published gains exist, they supply the
/// limits: the noise and the peak deviation under a load must not exceed those of the published
/// gains, and Ms - 1 must be at least 2 % smaller than theirs.
struct CascadeRequirement {
  /// The frequency at which the rate loop crosses gain 1 [rad/s], met exactly. If it is not given,
  /// the crossover is at most a twentieth of the sample rate and at most a third of the bandwidth
  /// of the inner loop.
  std::optional<double> bandwidth;
  double Ms_max = 1.4;        ///< max |S| of the loop, > 1
  double tracking_max = 1.3;  ///< max |value / set point|, > 1
  bool integral = true;       ///< false: the loop has no Ki
};

/// Constraints on the gains of a loop.
enum class CascadeStructure {
  pid,  ///< Kp, Ki and Kd are free
  /// A proportional controller of the value commands the set point of a PI controller of the rate,
  /// as in most autopilots. With Kp, Ki and |Kd| the two are the same feedback if and only if
  /// Kp² ≥ 4 |Kd| Ki.
  p_pi,
};
/// "pid", "p-pi".
[[nodiscard]] std::string to_string(CascadeStructure structure);
/// @throws InvalidInput  with the unknown name and the two valid ones.
[[nodiscard]] CascadeStructure cascade_structure(const std::string& name, const std::string& where);

/// The maximum Ki for which gains of the structure p_pi exist.
[[nodiscard]] constexpr double max_p_pi_integral(double Kp, double Kd) {
  return Kp * Kp / (4 * (Kd < 0 ? -Kd : Kd));
}

/// Maximum delay of a sensor [samples]: each sample adds a state to every loop that is evaluated.
inline constexpr int kMaxDelaySamples = 40;

/// Requirements on a cascade, with the control period, motor lag and sensor delays it flies with.
struct CascadeSpecification {
  double dt = 0;                                ///< sample period [s], > 0
  PidMethod method = PidMethod::forward_euler;  ///< of the integrals
  /// Motor lag [s]; empty: that of the vehicle.
  std::optional<double> lag;
  std::array<double, kCascadeAxes> delay{};                   ///< of each loop's sensors [s]
  std::array<CascadeRequirement, kCascadeAxes> requirements;  ///< by axis
  CascadeStructure structure = CascadeStructure::pid;         ///< of every loop
  bool use_published = true;  ///< whether published gains bound the loops without a bandwidth
};

}  // namespace quadtune
