// SPDX-License-Identifier: Apache-2.0
#include "gains/hover_slopes.hpp"

#include <algorithm>
#include <cmath>

namespace quadtune::internal {

HoverSlopes::HoverSlopes(const Vehicle& vehicle, InputKind kind)
    : law_(kind == InputKind::wrench         ? Law::wrench
           : kind == InputKind::rotor_thrust ? Law::thrust
           : kind == InputKind::command && vehicle.motor.law == CommandLaw::speed_squared
               ? Law::speed_squared
               : Law::speed),
      rotor_(vehicle.rotors.front()),
      load_(vehicle.mass * vehicle.gravity / static_cast<double>(vehicle.rotors.size())) {
  w0_ = speed(1);
}

// a2 w² + a1 w = load · nominal thrust.
double HoverSlopes::speed(double load) const {
  const double a1 = rotor_.thrust_a1;
  const double a2 = rotor_.thrust_a2;
  return (-a1 + std::sqrt(a1 * a1 + 4 * a2 * load_ * load)) / (2 * a2);
}

// Per τ: ∂T/∂w, or ∂T/∂(w²), or 1 where thrusts are commanded.
double HoverSlopes::thrust_factor(double w) const {
  const double slope = 2 * rotor_.thrust_a2 * w + rotor_.thrust_a1;
  if (law_ == Law::speed) return slope;
  return law_ == Law::speed_squared ? slope / (2 * w) : 1;
}

double HoverSlopes::torque_factor(double w) const {
  const double slope = 2 * rotor_.torque_d2 * w + rotor_.torque_d1;
  if (law_ == Law::speed) return slope;
  if (law_ == Law::speed_squared) return slope / (2 * w);
  return slope / (2 * rotor_.thrust_a2 * w + rotor_.thrust_a1);
}

Slopes HoverSlopes::at(double mass, double thrust) const {
  // The flight program distributes a wrench by the nominal curves, so the actual wrench is τ times
  // the commanded one.
  if (law_ == Law::wrench) return {thrust, thrust};
  const double w = speed(mass / thrust);
  return {thrust * thrust_factor(w) / thrust_factor(w0_),
          thrust * torque_factor(w) / torque_factor(w0_)};
}

// ∂T/∂w = τ √(a1² + 4 a2 T0 μ/τ) increases with μ and with τ; divided by μ it decreases with μ.
// ∂Q/∂w increases with μ and, since τ w is concave in τ, is concave in τ. Its minimum is therefore
// at a corner, and so is its maximum, unless it decreases at the upper end of τ; in that case the
// tangent there is an upper bound.
SlopeBounds HoverSlopes::over_speeds(double mass_low, double mass_high, double thrust_low,
                                     double thrust_high) const {
  SlopeBounds bounds;
  bounds.thrust = {at(mass_low, thrust_low).thrust, at(mass_high, thrust_high).thrust};
  bounds.thrust_over_mass = {at(mass_high, thrust_low).thrust / mass_high,
                             at(mass_low, thrust_high).thrust / mass_low};
  const double low_end = at(mass_high, thrust_low).torque;
  const double high_end = at(mass_high, thrust_high).torque;
  bounds.torque = {std::min(at(mass_low, thrust_low).torque, at(mass_low, thrust_high).torque),
                   std::max(low_end, high_end)};
  // d/dτ of 2 d2 τ w + d1 τ, where 2 a2 τ w = -a1 τ + √(a1² τ² + c τ), c = 4 a2 T0 μ.
  const double a1 = rotor_.thrust_a1;
  const double c = 4 * rotor_.thrust_a2 * load_ * mass_high;
  const double root = std::sqrt(a1 * a1 * thrust_high * thrust_high + c * thrust_high);
  const double rise =
      rotor_.torque_d2 / rotor_.thrust_a2 * (-a1 + (2 * a1 * a1 * thrust_high + c) / (2 * root)) +
      rotor_.torque_d1;
  bounds.torque.high +=
      std::max(0.0, -rise / torque_factor(w0_)) * (thrust_high - thrust_low) * (1 + 1e-12);
  return bounds;
}

SlopeBounds HoverSlopes::over(double mass_low, double mass_high, double thrust_low,
                              double thrust_high) const {
  if (law_ == Law::speed) return over_speeds(mass_low, mass_high, thrust_low, thrust_high);
  SlopeBounds bounds;
  bounds.thrust = bounds.torque = {thrust_low, thrust_high};
  if (law_ != Law::wrench) {
    // Each factor is monotone in w, which increases with μ/τ; that τ occurs in both is not used.
    const double slow = speed(mass_low / thrust_high);
    const double fast = speed(mass_high / thrust_low);
    const auto times_tau = [&](double a, double b, double nominal) {
      const auto [low, high] =
          std::minmax({thrust_low * a, thrust_low * b, thrust_high * a, thrust_high * b});
      return UncertainRange{low / nominal, high / nominal};
    };
    bounds.thrust = times_tau(thrust_factor(slow), thrust_factor(fast), thrust_factor(w0_));
    bounds.torque = times_tau(torque_factor(slow), torque_factor(fast), torque_factor(w0_));
  }
  bounds.thrust_over_mass = {bounds.thrust.low / mass_high, bounds.thrust.high / mass_low};
  return bounds;
}

}  // namespace quadtune::internal
