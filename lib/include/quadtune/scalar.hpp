// SPDX-License-Identifier: Apache-2.0
/// The few functions by which code that runs on board is written once for every scalar: float and
/// double, which fly and simulate one vehicle, and Pack, which simulates several at once.
///
/// Such code has no `if` on a scalar: it computes both sides and takes one with select(). Sines,
/// logarithms and the like are called unqualified after `using std::sin;`.
#pragma once

#include <cmath>
#include <type_traits>
#include <utility>

namespace quadtune {

/// What a comparison of scalars gives: bool for a number, one bool a lane for a Pack.
template <class T>
struct MaskOfScalar {
  using type = bool;
};
template <class T>
using MaskOf = typename MaskOfScalar<T>::type;

/// a where the mask is true, else b. Both are computed; a NaN in the one not taken does no harm.
[[nodiscard]] constexpr double select(bool mask, double a, double b) noexcept {
  return mask ? a : b;
}
[[nodiscard]] constexpr float select(bool mask, float a, float b) noexcept { return mask ? a : b; }
/// The same for masks.
[[nodiscard]] constexpr bool select(bool mask, bool a, bool b) noexcept { return mask ? a : b; }

/// The smaller and the larger; b where a is NaN, a where b is NaN is not promised.
template <class T>
requires std::is_floating_point_v<T>
[[nodiscard]] constexpr T lesser(T a, T b) noexcept { return a < b ? a : b; }
template <class T>
requires std::is_floating_point_v<T>
[[nodiscard]] constexpr T greater(T a, T b) noexcept { return a > b ? a : b; }
/// x within low ≤ high; low where x is NaN.
template <class T>
[[nodiscard]] constexpr T clamped(const T& x, const T& low, const T& high) noexcept {
  return lesser(greater(x, low), high);
}

template <class T>
requires std::is_floating_point_v<T>
[[nodiscard]] inline bool is_finite(T x) noexcept { return std::isfinite(x); }
template <class T>
requires std::is_floating_point_v<T>
[[nodiscard]] inline T magnitude(T x) noexcept { return std::abs(x); }

/// Whether it holds in any lane, in every lane, in none. Lanes of a number: itself.
[[nodiscard]] constexpr bool any(bool mask) noexcept { return mask; }
[[nodiscard]] constexpr bool all(bool mask) noexcept { return mask; }
/// Lane by lane, for both kinds of mask; && and || of masks would not be.
[[nodiscard]] constexpr bool both(bool a, bool b) noexcept { return a && b; }
[[nodiscard]] constexpr bool either(bool a, bool b) noexcept { return a || b; }
[[nodiscard]] constexpr bool negated(bool a) noexcept { return !a; }

/// f(0), f(1) … f(N - 1), inlined, each index a constant: unlike a loop it lets the compiler keep
/// the elements of small arrays in registers.
template <int N, class Function>
[[gnu::always_inline]] inline void unrolled(Function&& f) {
  [&]<int... I>(std::integer_sequence<int, I...>) __attribute__((always_inline)) { (f(I), ...); }
  (std::make_integer_sequence<int, N>());
}

/// How many vehicles a scalar stands for.
template <class T>
inline constexpr int kLanesOf = 1;

/// One lane of a scalar, to read and to write.
template <class T>
requires std::is_floating_point_v<T>
[[nodiscard]] constexpr double lane(T x, int) noexcept { return static_cast<double>(x); }
template <class T>
requires std::is_floating_point_v<T>
constexpr void set_lane(T& x, int, double value) noexcept { x = static_cast<T>(value); }
[[nodiscard]] constexpr bool lane(bool mask, int) noexcept { return mask; }

}  // namespace quadtune
