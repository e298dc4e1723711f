// SPDX-License-Identifier: Apache-2.0
/// Functions with which on-board code is written once for all scalars: float and double, which fly
/// and simulate one vehicle, and Pack, which simulates several vehicles at once.
///
/// Such code must not branch on a scalar: it computes both alternatives and picks one with
/// select(). Elementary functions are called unqualified after `using std::sin;`.
#pragma once

#include <cmath>
#include <type_traits>
#include <utility>

namespace quadtune {

/// The result type of a comparison: bool for a number, one bool per lane for a Pack.
template <class T>
struct MaskOfScalar {
  using type = bool;  ///< bool, or the masks of a Pack
};

/// The result type of a comparison of two T.
template <class T>
using MaskOf = typename MaskOfScalar<T>::type;

/// a if the mask is true, else b. Both are evaluated; a NaN in the other one has no effect.
[[nodiscard]] constexpr double select(bool mask, double a, double b) noexcept {
  return mask ? a : b;
}

/// The same for single precision.
[[nodiscard]] constexpr float select(bool mask, float a, float b) noexcept { return mask ? a : b; }
/// The same for masks.
[[nodiscard]] constexpr bool select(bool mask, bool a, bool b) noexcept { return mask ? a : b; }

/// The minimum of a and b. If a is NaN the result is b; the result is unspecified if b is NaN.
template <class T>
requires std::is_floating_point_v<T>
[[nodiscard]] constexpr T min_of(T a, T b) noexcept { return a < b ? a : b; }

/// The maximum of a and b; for NaN as min_of().
template <class T>
requires std::is_floating_point_v<T>
[[nodiscard]] constexpr T max_of(T a, T b) noexcept { return a > b ? a : b; }
/// x limited to [low, high]; low if x is NaN.
template <class T>
[[nodiscard]] constexpr T clamped(const T& x, const T& low, const T& high) noexcept {
  return min_of(max_of(x, low), high);
}

/// Whether x is neither NaN nor infinite.
template <class T>
requires std::is_floating_point_v<T>
[[nodiscard]] inline bool is_finite(T x) noexcept { return std::isfinite(x); }

/// |x|.
template <class T>
requires std::is_floating_point_v<T>
[[nodiscard]] inline T abs_of(T x) noexcept { return std::abs(x); }

/// Whether the mask is true in any lane. A number has one lane.
[[nodiscard]] constexpr bool any(bool mask) noexcept { return mask; }

/// Whether the mask is true in every lane.
[[nodiscard]] constexpr bool all(bool mask) noexcept { return mask; }
/// Whether both masks are true, lane by lane, for both kinds of mask; && and || do not work on a
/// Pack's masks.
[[nodiscard]] constexpr bool logical_and(bool a, bool b) noexcept { return a && b; }

/// Whether at least one of two masks is true, lane by lane.
[[nodiscard]] constexpr bool logical_or(bool a, bool b) noexcept { return a || b; }

/// Whether the mask is false, lane by lane.
[[nodiscard]] constexpr bool logical_not(bool a) noexcept { return !a; }

/// Calls f(0), f(1) … f(N - 1), inlined, with constant indices: unlike a loop, this lets the
/// compiler keep the elements of small arrays in registers.
template <int N, class Function>
[[gnu::always_inline]] inline void unrolled(Function&& f) {
  [&]<int... I>(std::integer_sequence<int, I...>) __attribute__((always_inline)) { (f(I), ...); }
  (std::make_integer_sequence<int, N>());
}

/// The number of vehicles that a scalar represents.
template <class T>
inline constexpr int kLanesOf = 1;

/// The only lane of a number.
template <class T>
requires std::is_floating_point_v<T>
[[nodiscard]] constexpr double lane(T x, int) noexcept { return static_cast<double>(x); }

/// Writes the only lane of a number.
template <class T>
requires std::is_floating_point_v<T>
constexpr void set_lane(T& x, int, double value) noexcept { x = static_cast<T>(value); }

/// The only lane of a mask.
[[nodiscard]] constexpr bool lane(bool mask, int) noexcept { return mask; }

}  // namespace quadtune
