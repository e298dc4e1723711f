// SPDX-License-Identifier: Apache-2.0
/// SIMD packs: several numbers that are computed with as one. Each lane belongs to a separate
/// flight.
///
/// Every operation is the IEEE 754 operation in each lane, the functions below consist of such
/// operations, and no operations are contracted (fused). The result of a lane therefore does not
/// depend on the number of lanes: simulations over Pack<1> and Pack<8> give identical bytes.
#pragma once

#include <Eigen/Core>
#include <bit>
#include <cmath>
#include <cstdint>
#include <limits>

#include "quadtune/scalar.hpp"

#if defined(__SSE2__)
#include <immintrin.h>
#endif

namespace quadtune {

/// Number of lanes of a register of the target machine.
#if defined(__AVX512F__)
inline constexpr int kPackLanes = 8;
#elif defined(__AVX__)
inline constexpr int kPackLanes = 4;
#else
inline constexpr int kPackLanes = 2;
#endif

template <int N>
struct PackTypes {
  typedef double Numbers __attribute__((vector_size(N * sizeof(double))));
  typedef std::int64_t Bits __attribute__((vector_size(N * sizeof(double))));
  typedef std::uint64_t Words __attribute__((vector_size(N * sizeof(double))));
};
template <>
struct PackTypes<1> {
  using Numbers = double;
  using Bits = std::int64_t;
  using Words = std::uint64_t;
};

/// One Boolean value per lane.
template <int N>
struct Mask {
  using Bits = typename PackTypes<N>::Bits;
  Bits bits{};  ///< all ones or all zeros in each lane

  Mask() = default;
  Mask(bool value) : bits(Bits{} - (value ? 1 : 0)) {}  // NOLINT: a constant is a mask too
  static Mask of(Bits from) {
    Mask m;
    m.bits = from;
    return m;
  }

  friend Mask logical_and(Mask a, Mask b) { return of(a.bits & b.bits); }
  friend Mask logical_or(Mask a, Mask b) { return of(a.bits | b.bits); }
  friend Mask logical_not(Mask a) { return of(~a.bits); }
  friend Mask select(Mask m, Mask a, Mask b) { return of((m.bits & a.bits) | (~m.bits & b.bits)); }
  friend bool lane(const Mask& m, int i) { return m.bits[i] != 0; }
  friend void set_lane(Mask& m, int i, bool value) { m.bits[i] = value ? -1 : 0; }
  friend bool any(const Mask& m) {
    std::int64_t result = 0;
    for (int i = 0; i < N; ++i) result |= m.bits[i];
    return result != 0;
  }
  friend bool all(const Mask& m) { return !any(logical_not(m)); }
};

template <>
struct Mask<1> {
  bool bits = false;

  Mask() = default;
  Mask(bool value) : bits(value) {}  // NOLINT: as above

  friend Mask logical_and(Mask a, Mask b) { return {a.bits && b.bits}; }
  friend Mask logical_or(Mask a, Mask b) { return {a.bits || b.bits}; }
  friend Mask logical_not(Mask a) { return {!a.bits}; }
  friend Mask select(Mask m, Mask a, Mask b) { return m.bits ? a : b; }
  friend bool lane(const Mask& m, int) { return m.bits; }
  friend void set_lane(Mask& m, int, bool value) { m.bits = value; }
  friend bool any(const Mask& m) { return m.bits; }
  friend bool all(const Mask& m) { return m.bits; }
};

template <int N>
struct Pack {
  using Numbers = typename PackTypes<N>::Numbers;
  using Bits = typename PackTypes<N>::Bits;
  Numbers v;

  Pack() = default;
  // Explicit copy operations copy numbers rather than bytes, so that GCC keeps more of them in
  // registers.
  Pack(const Pack& other) : v(other.v) {}
  Pack& operator=(const Pack& other) {
    v = other.v;
    return *this;
  }
  Pack(double x) : v(x - Numbers{}) {}           // NOLINT: a number is the same in every lane
  Pack(int x) : Pack(static_cast<double>(x)) {}  // NOLINT
  struct FromNumbers {};
  Pack(FromNumbers, Numbers from) : v(from) {}
  static Pack of(Numbers from) { return {FromNumbers{}, from}; }

  friend Pack operator+(Pack a, Pack b) { return of(a.v + b.v); }
  friend Pack operator-(Pack a, Pack b) { return of(a.v - b.v); }
  friend Pack operator*(Pack a, Pack b) { return of(a.v * b.v); }
  friend Pack operator/(Pack a, Pack b) { return of(a.v / b.v); }
  friend Pack operator-(Pack a) { return of(-a.v); }
  friend Pack operator+(Pack a) { return a; }
  Pack& operator+=(Pack b) { return *this = *this + b; }
  Pack& operator-=(Pack b) { return *this = *this - b; }
  Pack& operator*=(Pack b) { return *this = *this * b; }
  Pack& operator/=(Pack b) { return *this = *this / b; }

  template <class Comparison>
  static Mask<N> mask(Comparison comparison) {
    if constexpr (N == 1) {
      return Mask<N>(comparison);
    } else {
      return Mask<N>::of((Bits)comparison);
    }
  }
  friend Mask<N> operator<(Pack a, Pack b) { return mask(a.v < b.v); }
  friend Mask<N> operator<=(Pack a, Pack b) { return mask(a.v <= b.v); }
  friend Mask<N> operator>(Pack a, Pack b) { return mask(a.v > b.v); }
  friend Mask<N> operator>=(Pack a, Pack b) { return mask(a.v >= b.v); }
  friend Mask<N> operator==(Pack a, Pack b) { return mask(a.v == b.v); }
  friend Mask<N> operator!=(Pack a, Pack b) { return mask(a.v != b.v); }

  friend Pack select(Mask<N> m, Pack a, Pack b) { return of(m.bits ? a.v : b.v); }
  friend Pack min_of(Pack a, Pack b) { return of(a.v < b.v ? a.v : b.v); }
  friend Pack max_of(Pack a, Pack b) { return of(a.v > b.v ? a.v : b.v); }
  friend Pack abs_of(Pack a) { return of(a.v < Numbers{} ? -a.v : a.v); }
  friend Pack abs(Pack a) { return abs_of(a); }
  friend Mask<N> is_finite(Pack a) { return abs_of(a) <= Pack(std::numeric_limits<double>::max()); }
  friend double lane(const Pack& a, int i) {
    if constexpr (N == 1) {
      return a.v;
    } else {
      return a.v[i];
    }
  }
  friend void set_lane(Pack& a, int i, double value) {
    if constexpr (N == 1) {
      a.v = value;
    } else {
      a.v[i] = value;
    }
  }

  /// Converts integers of magnitude at most 2⁵².
  static Pack of_whole(Bits from) {
    if constexpr (N == 1) {
      return of(static_cast<double>(from));
    } else {
      return of(__builtin_convertvector(from, Numbers));
    }
  }
  /// The bits of the numbers, for access to their exponents and mantissas.
  [[nodiscard]] Bits bits() const { return std::bit_cast<Bits>(v); }
  static Pack of_bits(Bits b) { return of(std::bit_cast<Numbers>(b)); }

  friend Pack sqrt(Pack a) {
    if constexpr (N == 1) return of(std::sqrt(a.v));
#if defined(__AVX512F__)
    if constexpr (N == 8) return of(_mm512_sqrt_pd(a.v));
#endif
#if defined(__AVX__)
    if constexpr (N == 4) return of(_mm256_sqrt_pd(a.v));
#endif
#if defined(__SSE2__)
    if constexpr (N == 2) return of(_mm_sqrt_pd(a.v));
#endif
    for (int i = 0; i < N; ++i) set_lane(a, i, std::sqrt(lane(a, i)));
    return a;
  }
  /// Rounds to the nearest integer, ties to even; |a| < 2⁵¹.
  friend Pack nearest(Pack a) {
    constexpr double kMagic = 6755399441055744.0;  // 1.5 · 2⁵²
    // Rounding, except for the sign of a zero.
    return (a + kMagic) - kMagic;
  }
};

template <int N>
struct MaskOfScalar<Pack<N>> {
  using type = Mask<N>;
};
template <int N>
inline constexpr int kLanesOf<Pack<N>> = N;

/// Applies f to each lane; for rare operations.
template <int N, class Function>
[[nodiscard]] Pack<N> map_lanes(Pack<N> a, Function&& f) {
  for (int i = 0; i < N; ++i) set_lane(a, i, f(lane(a, i)));
  return a;
}

}  // namespace quadtune

namespace Eigen {
template <int N>
struct NumTraits<quadtune::Pack<N>> : NumTraits<double> {
  using Real = quadtune::Pack<N>;
  using NonInteger = quadtune::Pack<N>;
  using Nested = quadtune::Pack<N>;
  using Literal = double;
  enum { RequireInitialization = 0 };
};
/// Allows a double times or over a matrix of packs; the number applies to every lane.
template <int N, class Operation>
struct ScalarBinaryOpTraits<quadtune::Pack<N>, double, Operation> {
  using ReturnType = quadtune::Pack<N>;
};
template <int N, class Operation>
struct ScalarBinaryOpTraits<double, quadtune::Pack<N>, Operation> {
  using ReturnType = quadtune::Pack<N>;
};
}  // namespace Eigen
