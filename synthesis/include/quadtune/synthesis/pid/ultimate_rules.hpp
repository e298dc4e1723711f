// SPDX-License-Identifier: Apache-2.0
/// PID gains from the limit of stability: the gain Ku at which a proportional loop oscillates, and
/// the period Tu of the oscillation, from a test in flight or from a model.
#pragma once

#include <limits>
#include <string>
#include <vector>

#include "quadtune/synthesis/pid/pid_gains.hpp"
#include "quadtune/synthesis/pid/pid_rules.hpp"
#include "quadtune/transfer_function.hpp"

namespace quadtune {

/// The oscillation at the limit of stability.
struct UltimatePoint {
  double gain = std::numeric_limits<double>::quiet_NaN();    ///< Ku [output / error]
  double period = std::numeric_limits<double>::quiet_NaN();  ///< Tu [s]
  std::string culprit;  ///< why the plant has no such point; empty if it has one

  /// Whether the plant oscillates at a finite gain.
  [[nodiscard]] bool exists() const { return culprit.empty(); }
};

/// Computes Ku and Tu of a plant: the smallest gain > 0 at which the loop Ku G loses its stability.
/// @throws InvalidInput  as OpenLoop
[[nodiscard]] UltimatePoint ultimate_point(const ContinuousTransferFunction& plant);

/// Names of the rules: "ziegler-nichols", "pessen", "some-overshoot", "no-overshoot" and
/// "tyreus-luyben".
[[nodiscard]] const std::vector<std::string>& ultimate_rules();

/// Computes gains by a rule from Ku and Tu:
///
///     ziegler-nichols   P 0.5 Ku; PI 0.45 Ku, Ti = Tu/1.2; PID 0.6 Ku, Ti = Tu/2, Td = Tu/8
///     pessen            PID 0.7 Ku, Ti = 0.4 Tu, Td = 0.15 Tu
///     some-overshoot    PID 0.33 Ku, Ti = Tu/2, Td = Tu/3
///     no-overshoot      PID 0.2 Ku, Ti = Tu/2, Td = Tu/3
///     tyreus-luyben     PI Ku/3.2, Ti = 2.2 Tu; PID Ku/2.2, Ti = 2.2 Tu, Td = Tu/6.3
///
/// @param rule             one of the names above
/// @param type             one that the rule has
/// @param ultimate_gain    Ku, not 0
/// @param ultimate_period  Tu [s], > 0
/// @param N                of the derivative filter Tf = Td/N, > 0
/// @throws InvalidInput  if the rule is unknown or has no such type, Ku is 0 or not finite, or Tu
///                       or N is not positive
/// Sources: Ziegler and Nichols 1942; Pessen 1994; Tyreus and Luyben 1992; the rules with little
/// overshoot as listed by McCormack and Godfrey 1998.
[[nodiscard]] PidGains ultimate_rule(const std::string& rule, PidType type, double ultimate_gain,
                                     double ultimate_period, double N = kPidFilterRatio);

}  // namespace quadtune
