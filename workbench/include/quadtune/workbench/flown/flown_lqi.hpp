// SPDX-License-Identifier: Apache-2.0
/// The default state feedback: LQI with lagging actuators, whose weights are softened until the
/// flown loop has the margins that are asked for. Theory: docs/theory.md, "LQI with actuators".
#pragma once

#include <array>
#include <optional>
#include <string>
#include <vector>

#include "quadtune/design.hpp"
#include "quadtune/model/vehicle.hpp"
#include "quadtune/synthesis/actuator_lqi.hpp"
#include "quadtune/synthesis/margins.hpp"
#include "quadtune/workbench/design/standard_axes.hpp"
#include "quadtune/workbench/flown/flown_family.hpp"

namespace quadtune {

/// Margins that each channel of the law has at every nominal member of the family.
struct FlownMargins {
  double phase = 0.7853981633974483;  ///< [rad], 45°
  double gain = 2;                    ///< 6 dB, up and down
  double disk = 0.5;
};

/// The smallest share of those margins that a loop has: 1 or more if it has them all, 0 if it is
/// unstable.
[[nodiscard]] double share_of(const LoopMargins& margins, const FlownMargins& asked);

struct FlownLqiOptions {
  double dt = 0.005;  ///< control period [s], > 0
  FlownMargins margins;
  std::vector<std::string> integrals = standard_integrals();  ///< states that are integrated
  /// None: by Bryson's rule, softened until the margins are met. Weights that are given stay.
  std::optional<ActuatorLqiWeights> weights = {};
  /// Control periods by which the law predicts, see ActuatorLqiOptions. None: the delay of the
  /// gyroscope and up to four more, whichever gives the largest margins.
  std::optional<int> past = {};
  int least_past = 0;  ///< of what is tried where `past` is none
};

struct FlownLqi {
  ActuatorLqi lqi;
  ActuatorLqiWeights weights;                  ///< as softened
  std::array<double, 4> softened{1, 1, 1, 1};  ///< factors on R, in the order of kFlownAxes
  /// Divisors of the weights of px, py, pz and yaw and of their integrals, in the same order.
  std::array<double, 4> lowered{1, 1, 1, 1};
  std::vector<FlownFamilyMember> family;
  /// Of each group of axes (rows, in the order of kFlownAxes) at each member of the family.
  std::array<std::vector<LoopMargins>, 4> margins;
  bool met = false;  ///< whether every channel has its margins
  /// The smallest share of a margin that a channel has: 1 or more if met, 0 if unstable.
  double share = -1;
  std::vector<std::string> notes;  ///< what was softened and what is not met, one sentence each
};

/// What a design asks for. Weights that it has none of follow Bryson's rule.
/// @throws NoSolution  as standard_axes()
[[nodiscard]] FlownLqiOptions flown_lqi_options(const Vehicle& vehicle, const LqiDesign& design);

/// The loop of one group of axes at a member, cut at the law's output. The law's states of other
/// groups are left out.
/// @param law  flown_law() of gains in the 12 states and the wrench
[[nodiscard]] PeriodicLti axis_loop(const FlownPlant& plant, FlownAxis axis,
                                    const DiscreteLti& law);

/// Designs LQI gains with the memory of their actuators for the wrench. Unless weights are given,
/// the control weight of a group of axes is doubled, five times at most, until its margins are met
/// and every member of the family is stable. Where that does not do, the weights of its position
/// and of the integral are divided by 4 instead, three times at most: a slow rotor needs a slower
/// outer loop, not a weaker inner one. If the margins cannot be met the result is the design that
/// comes nearest.
/// @throws InvalidInput  as flown_family() and actuator_lqi()
/// @throws NoSolution    if the Riccati equation has no solution, with the culprit
[[nodiscard]] FlownLqi flown_lqi(const Vehicle& vehicle, const FlownLqiOptions& options = {});

}  // namespace quadtune
