// SPDX-License-Identifier: Apache-2.0
/// The default state feedback: LQI with actuator lag, whose weights are reduced until the flown
/// loop has the required margins. Theory: docs/theory.md, "LQI with actuators".
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

/// Required margins of each channel of the law at every nominal member of the family.
struct FlownMargins {
  double phase = 0.7853981633974483;  ///< [rad], 45°
  double gain = 2;                    ///< 6 dB, up and down
  double disk = 0.5;                  ///< disk margin alpha
};

/// The smallest ratio of a loop's margins to the required ones: 1 or more if all are met, 0 if the
/// loop is unstable.
[[nodiscard]] double share_of(const LoopMargins& margins, const FlownMargins& asked);

/// Options of flown_lqi().
struct FlownLqiOptions {
  double dt = 0.005;                                          ///< control period [s], > 0
  FlownMargins margins;                                       ///< that every loop must have
  std::vector<std::string> integrals = standard_integrals();  ///< states that are integrated
  /// None: by Bryson's rule, softened until the margins are met. Given weights are not changed.
  std::optional<ActuatorLqiWeights> weights = {};
  /// Number of control periods over which the law predicts, see ActuatorLqiOptions. None: the delay
  /// of commands and gyroscope, and 1, 2 and 4 periods more; of the laws that meet the margins, the
  /// one whose weights were changed least.
  std::optional<int> past = {};
  int min_past = 0;  ///< minimum of the tried numbers if `past` is none
};

/// A state feedback with its margins.
struct FlownLqi {
  ActuatorLqi lqi;                             ///< gains with the evidence of the solver
  ActuatorLqiWeights weights;                  ///< after softening
  std::array<double, 4> softened{1, 1, 1, 1};  ///< factors on R, in the order of kFlownAxes
  /// Divisors of the weights of px, py, pz and yaw and of their integrals, in the same order.
  std::array<double, 4> lowered{1, 1, 1, 1};
  std::vector<FlownFamilyMember> family;  ///< vehicles for which the law was designed
  /// For each group of axes (rows, in the order of kFlownAxes) at each member of the family.
  std::array<std::vector<LoopMargins>, 4> margins;
  bool met = false;  ///< whether every channel has its margins
  /// The smallest ratio of a channel's margin to the required one: ≥ 1 if met, 0 if unstable.
  double share = -1;
  std::vector<std::string> notes;  ///< about what was softened and what is not met, one sentence
                                   ///< each
};

/// The options for a design. Weights that it does not define follow Bryson's rule.
/// @throws NoSolution  as standard_axes()
[[nodiscard]] FlownLqiOptions flown_lqi_options(const Vehicle& vehicle, const LqiDesign& design);

/// The loop of one group of axes at a member, cut at the law's output. States of the law that
/// belong to other groups are omitted.
/// @param plant  of a member of the family
/// @param axis   group of axes
/// @param law    flown_law() of gains from the 12 states to the wrench
[[nodiscard]] PeriodicLti axis_loop(const FlownPlant& plant, FlownAxis axis,
                                    const DiscreteLti& law);

/// Designs LQI gains with actuator states for the wrench. Unless weights are given, the control
/// weight of a group of axes is doubled, at most five times, until its margins are met and every
/// member of the family is stable. If this does not suffice, the weights of its position and of the
/// integral are divided by 4 instead, at most three times: slow rotors require a slower outer loop,
/// not a weaker inner one. If the margins cannot be met, the result is the design that comes
/// closest.
/// @throws InvalidInput  as flown_family() and actuator_lqi()
/// @throws NoSolution    if the Riccati equation has no solution, with the culprit
[[nodiscard]] FlownLqi flown_lqi(const Vehicle& vehicle, const FlownLqiOptions& options = {});

}  // namespace quadtune
