// SPDX-License-Identifier: Apache-2.0
/// The integral of the uquad flight code, with three guards against windup.
#pragma once

#include <string>
#include <type_traits>

#include "quadtune/scalar.hpp"

namespace quadtune {

/// Validated by validate(); step() does not check.
template <class Scalar>
struct GuardedIntegralSettings {
  Scalar dt = 0;               ///< sample period [s], > 0
  Scalar error_limit = 0;      ///< the integral is frozen while |error| exceeds it [error], ≥ 0
  Scalar increment_limit = 0;  ///< of |error · dt| in one sample [error · s], ≥ 0
  Scalar integral_limit = 0;   ///< of |integral| [error · s], ≥ 0
};

/// The integral between two samples.
template <class Scalar>
struct GuardedIntegralState {
  Scalar integral = 0;  ///< ∫error [error · s]
};

/// One sample; returns the integral after it.
///
/// Far from the set point the integral is frozen and the proportional part acts alone. Near it, the
/// integral grows by the limited error · dt and saturates at its limit. All limits are symmetric. A
/// NaN error leaves the integral unchanged.
template <class Scalar>
Scalar step(const GuardedIntegralSettings<Scalar>& settings, GuardedIntegralState<Scalar>& state,
            Scalar error) noexcept {
  const MaskOf<Scalar> near = abs_of(error) <= settings.error_limit;  // false for NaN
  const Scalar increment =
      clamped(error * settings.dt, -settings.increment_limit, settings.increment_limit);
  const Scalar advanced =
      clamped(state.integral + increment, -settings.integral_limit, settings.integral_limit);
  state.integral = select(near, advanced, state.integral);
  return state.integral;
}

static_assert(std::is_trivially_copyable_v<GuardedIntegralState<float>>);
static_assert(std::is_trivially_copyable_v<GuardedIntegralState<double>>);

/// Checks that step() may use these settings: dt > 0 and finite, limits ≥ 0 (infinite: no limit).
/// @throws InvalidInput  "where: error_limit is -1, expected 0 or more because …"
void validate(const GuardedIntegralSettings<double>& settings, const std::string& where);

/// The same for single precision.
void validate(const GuardedIntegralSettings<float>& settings, const std::string& where);

}  // namespace quadtune
