// SPDX-License-Identifier: Apache-2.0
/// A battery model: voltage under load and its effect on the motors, and charge.
#pragma once

#include <algorithm>

#include "quadtune/scalar.hpp"

namespace quadtune {

/// Parameters of a battery together with motors and speed controllers.
struct Battery {
  double capacity = 0;        ///< [A s], > 0
  double full_voltage = 0;    ///< open-circuit, fully charged [V], > empty_voltage
  double empty_voltage = 0;   ///< open-circuit, at zero charge [V], > 0
  double resistance = 0;      ///< internal [ohm], ≥ 0
  double cutoff_voltage = 0;  ///< under load; the flight must end below it [V]
  double efficiency = 0.7;    ///< power at the shafts over power drawn by the motors, (0, 1]
  double idle_power = 0;      ///< of the electronics [W], ≥ 0
  /// The voltage at which the motors reach the vehicle's maximum speed [V].
  double rated_voltage = 0;
  /// true: the speed controllers hold the speeds, and only the maximum speed depends on the
  /// voltage. false: all speeds are proportional to the voltage, and thrust to its square.
  bool regulated = true;

  friend bool operator==(const Battery&, const Battery&) = default;
};

/// The state of a battery.
template <class T>
struct BatteryState {
  T charge = T(0);   ///< drawn so far [A s]
  T voltage = T(0);  ///< under load [V]
  T current = T(0);  ///< [A]
};

/// A full battery without load.
template <class T>
[[nodiscard]] BatteryState<T> full_battery(const Battery& battery) {
  return {T(0), T(battery.full_voltage), T(0)};
}

/// One step under a load held for dt.
///
/// The open-circuit voltage V₀ decreases linearly with the charge drawn. With V = V₀ - R I and V I
/// = P, the current is the smaller root. A power above V₀²/4R cannot be supplied: the voltage is
/// then V₀/2 and the current V₀/2R.
/// @param battery      accepted by validate()
/// @param state        of the last step; receives the new one
/// @param shaft_power  of all rotors [W], ≥ 0
/// @param dt           [s], > 0
template <class T>
void step(const Battery& battery, BatteryState<T>& state, const T& shaft_power, double dt) {
  using std::sqrt;
  const T used = clamped(state.charge * T(1 / battery.capacity), T(0), T(1));
  const T open = T(battery.full_voltage) - used * T(battery.full_voltage - battery.empty_voltage);
  const T power = shaft_power * T(1 / battery.efficiency) + T(battery.idle_power);
  const T root = open * open - power * T(4 * battery.resistance);
  state.voltage = (open + sqrt(max_of(root, T(0)))) * T(0.5);
  state.current =
      select(root < T(0), state.voltage * T(1 / battery.resistance), power / state.voltage);
  state.charge += state.current * T(dt);
}

/// Ratio of the maximum motor speed at the present voltage to that at the rated voltage.
template <class T>
[[nodiscard]] T voltage_ratio(const Battery& battery, const BatteryState<T>& state) {
  return state.voltage * T(1 / battery.rated_voltage);
}

}  // namespace quadtune
