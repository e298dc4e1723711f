// SPDX-License-Identifier: Apache-2.0
/// Change of the effectiveness of the rotors of a hovering vehicle when its mass and thrust differ
/// from the nominal values of the gains.
#pragma once

#include "quadtune/convention.hpp"
#include "quadtune/model/vehicle.hpp"
#include "quadtune/tuning/uncertain_vehicle.hpp"

namespace quadtune::internal {

/// Change of thrust and of drag torque per change of the command, relative to the nominal hover.
struct Slopes {
  double thrust = 1;
  double torque = 1;
};

/// Bounds of the slopes over a box of mass and thrust.
struct SlopeBounds {
  UncertainRange thrust;
  UncertainRange torque;
  UncertainRange thrust_over_mass;
};

/// Computes the slopes. T = τ (a2 w² + a1 w) carries μ times the nominal weight, so w follows from
/// μ/τ.
class HoverSlopes {
 public:
  /// @param vehicle  equal rotors with a2 > 0, hovering at one speed
  HoverSlopes(const Vehicle& vehicle, InputKind kind);

  /// @param mass    μ > 0;  @param thrust  τ > 0
  [[nodiscard]] Slopes at(double mass, double thrust) const;
  /// Exact for rotor speeds and wrenches, and for curves without a linear term; otherwise a bound.
  [[nodiscard]] SlopeBounds over(double mass_low, double mass_high, double thrust_low,
                                 double thrust_high) const;

 private:
  /// What the ratio of a slope depends on in addition to τ.
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
