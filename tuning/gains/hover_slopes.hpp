// SPDX-License-Identifier: Apache-2.0
/// How much more a hovering vehicle's rotors do for a law's command when its mass and its thrust
/// are not what the gains were made for.
#pragma once

#include "quadtune/convention.hpp"
#include "quadtune/model/vehicle.hpp"
#include "quadtune/tuning/uncertain_vehicle.hpp"

namespace quadtune::internal {

/// Ratios to the nominal hover of what a command adds to thrust, and to drag torque.
struct Slopes {
  double thrust = 1;
  double torque = 1;
};

/// Bounds of them over a box of mass and thrust.
struct SlopeBounds {
  UncertainRange thrust;
  UncertainRange torque;
  UncertainRange thrust_over_mass;
};

/// T = τ (a2 w² + a1 w) carries μ times the nominal weight, so w follows from μ/τ.
class HoverSlopes {
 public:
  /// @param vehicle  rotors alike with a2 > 0, hovering at one speed
  HoverSlopes(const Vehicle& vehicle, InputKind kind);

  /// @param mass    μ > 0;  @param thrust  τ > 0
  [[nodiscard]] Slopes at(double mass, double thrust) const;
  /// Exact for rotor speeds and wrenches, and for curves without a linear term; else a bound.
  [[nodiscard]] SlopeBounds over(double mass_low, double mass_high, double thrust_low,
                                 double thrust_high) const;

 private:
  /// What the ratio of a slope depends on beside τ.
  enum class Law { speed, speed_squared, thrust, wrench };

  [[nodiscard]] double speed(double load) const;
  [[nodiscard]] double thrust_factor(double w) const;
  [[nodiscard]] double torque_factor(double w) const;
  [[nodiscard]] SlopeBounds over_speeds(double mass_low, double mass_high, double thrust_low,
                                        double thrust_high) const;

  Law law_;
  Rotor rotor_;
  double load_ = 0;  // nominal thrust of one rotor [N]
  double w0_ = 0;    // nominal speed [rad/s]
};

}  // namespace quadtune::internal
