// SPDX-License-Identifier: Apache-2.0
/// Elementary functions of packs, computed by IEEE 754 operations only, so that every lane gets
/// identical bytes whatever the number of lanes and the C library.
///
/// Errors are below 2 units in the last place, those of tan, asin, acos and atan2 below 4 and those
/// of pow below 3 (1 + |y log x|) (tests/lib/model/pack_math_test.cpp). Coefficients: [Cephes],
/// [fdlibm].
#pragma once

#include <limits>
#include <numbers>

#include "quadtune/simulation/pack.hpp"

namespace quadtune {
namespace internal {

/// c₀ xⁿ + … + cₙ, and a variant with leading coefficient 1.
template <int N, std::size_t Count>
[[nodiscard]] inline Pack<N> polynomial(Pack<N> x, const double (&c)[Count]) {
  Pack<N> sum = c[0];
  for (std::size_t i = 1; i < Count; ++i) sum = sum * x + Pack<N>(c[i]);
  return sum;
}
template <int N, std::size_t Count>
[[nodiscard]] inline Pack<N> monic_polynomial(Pack<N> x, const double (&c)[Count]) {
  Pack<N> sum = x + Pack<N>(c[0]);
  for (std::size_t i = 1; i < Count; ++i) sum = sum * x + Pack<N>(c[i]);
  return sum;
}

/// Whether bit `bit` of an integer-valued pack (|x| < 2⁵¹) is set.
template <int N>
[[nodiscard]] inline Mask<N> bit_is_set(Pack<N> x, int bit) {
  const typename Pack<N>::Bits bits = (x + Pack<N>(6755399441055744.0)).bits();
  const typename Pack<N>::Bits wanted = (bits >> bit) & 1;
  if constexpr (N == 1) {
    return Mask<1>(wanted != 0);
  } else {
    return Mask<N>::of(-wanted);
  }
}

template <int N>
struct SineAndCosine {
  Pack<N> sine;
  Pack<N> cosine;
};

/// For |x| ≤ 1e5; beyond that the argument reduction gradually loses accuracy.
template <int N>
[[nodiscard]] inline SineAndCosine<N> sine_and_cosine(Pack<N> x) {
  using P = Pack<N>;
  // π/2 as a sum of three numbers of 33, 33 and 53 bits: k times each of the first two is exact.
  constexpr double kPart1 = 1.57079632673412561417e+00;
  constexpr double kPart2 = 6.07710050630396597660e-11;
  constexpr double kPart3 = 2.02226624879595063154e-21;
  const P k = nearest(x * P(2 * std::numbers::inv_pi));
  const P r = ((x - k * P(kPart1)) - k * P(kPart2)) - k * P(kPart3);
  const P r2 = r * r;
  constexpr double kSine[] = {1.58969099521155010221e-10, -2.50507602534068634195e-08,
                              2.75573137070700676789e-06, -1.98412698298579493134e-04,
                              8.33333333332248946124e-03, -1.66666666666666324348e-01};
  constexpr double kCosine[] = {-1.13596475577881948265e-11, 2.08757232129817482790e-09,
                                -2.75573143513906633035e-07, 2.48015872894767294178e-05,
                                -1.38888888888741095749e-03, 4.16666666666666019037e-02};
  const P sine = r + r * r2 * polynomial(r2, kSine);
  const P cosine = (P(1) - P(0.5) * r2) + r2 * r2 * polynomial(r2, kCosine);
  const Mask<N> odd = bit_is_set(k, 0);
  const Mask<N> second = bit_is_set(k, 1);  // of the half turns
  const P s = select(odd, cosine, sine);
  const P c = select(odd, sine, cosine);
  return {select(second, -s, s), select(logical_or(logical_and(odd, logical_not(second)),
                                                   logical_and(second, logical_not(odd))),
                                        -c, c)};
}

}  // namespace internal

template <int N>
[[nodiscard]] inline Pack<N> sin(Pack<N> x) {
  return internal::sine_and_cosine(x).sine;
}
template <int N>
[[nodiscard]] inline Pack<N> cos(Pack<N> x) {
  return internal::sine_and_cosine(x).cosine;
}
template <int N>
[[nodiscard]] inline Pack<N> tan(Pack<N> x) {
  const internal::SineAndCosine<N> of = internal::sine_and_cosine(x);
  return of.sine / of.cosine;
}

template <int N>
[[nodiscard]] inline Pack<N> atan(Pack<N> x) {
  using P = Pack<N>;
  constexpr double kP[] = {-8.750608600031904122785e-1, -1.615753718733365076637e1,
                           -7.500855792314704667340e1, -1.228866684490136173410e2,
                           -6.485021904942025371773e1};
  constexpr double kQ[] = {2.485846490142306297962e1, 1.650270098316988542046e2,
                           4.328810604912902668951e2, 4.853903996359136964868e2,
                           1.945506571482613964425e2};
  // The part of π/2 beyond the precision of a double
  constexpr double kRest = 6.123233995736765886130e-17;
  const P a = abs_of(x);
  const Mask<N> large = a > P(2.41421356237309504880);  // tan 3π/8
  const Mask<N> middle = logical_and(logical_not(large), a > P(0.66));
  const P reduced = select(large, P(-1) / a, select(middle, (a - P(1)) / (a + P(1)), a));
  const P base = select(large, P(std::numbers::pi / 2), select(middle, P(std::numbers::pi / 4), 0));
  const P rest = select(large, P(kRest), select(middle, P(0.5 * kRest), 0));
  const P z = reduced * reduced;
  const P ratio = z * internal::polynomial(z, kP) / internal::monic_polynomial(z, kQ);
  const P angle = base + ((reduced * ratio + reduced) + rest);
  return select(x < P(0), -angle, angle);
}

/// In [-π, π]; 0 for y = x = 0, NaN if both are infinite. The sign of zeros is ignored.
template <int N>
[[nodiscard]] inline Pack<N> atan2(Pack<N> y, Pack<N> x) {
  using P = Pack<N>;
  const P ay = abs_of(y);
  const P ax = abs_of(x);
  const Mask<N> steep = ay > ax;
  const P max = max_of(ay, ax);
  const P ratio = select(max > P(0), min_of(ay, ax) / max, P(0));
  P angle = atan(ratio);
  angle = select(steep, P(std::numbers::pi / 2) - angle, angle);
  angle = select(x < P(0), P(std::numbers::pi) - angle, angle);
  const P result = select(y < P(0), -angle, angle);
  return select(logical_and(ay == ay, ax == ax), result, y + x);  // NaN stays NaN
}

/// For |x| ≤ 1; NaN otherwise.
template <int N>
[[nodiscard]] inline Pack<N> asin(Pack<N> x) {
  return atan2(x, sqrt((Pack<N>(1) - x) * (Pack<N>(1) + x)));
}
template <int N>
[[nodiscard]] inline Pack<N> acos(Pack<N> x) {
  return atan2(sqrt((Pack<N>(1) - x) * (Pack<N>(1) + x)), x);
}

/// Natural logarithm of normal numbers > 0; -∞ for 0, NaN for negative numbers.
template <int N>
[[nodiscard]] inline Pack<N> log(Pack<N> x) {
  using P = Pack<N>;
  using Bits = typename P::Bits;
  constexpr double kP[] = {1.01875663804580931796e-4, 4.97494994976747001425e-1,
                           4.70579119878881725854e0,  1.44989225341610930846e1,
                           1.79368678507819816313e1,  7.70838733755885391666e0};
  constexpr double kQ[] = {1.12873587189167450590e1, 4.52279145837532221105e1,
                           8.29875266912776603211e1, 7.11544750618563894466e1,
                           2.31251620126765340583e1};
  constexpr double kSqrtHalf = 0.70710678118654752440;
  // x = m 2^e with ½ ≤ m < 1, then m in √½ … √2.
  const Bits bits = x.bits();
  const Bits exponent = ((bits >> 52) & 0x7ff) - 1022;
  P m = P::of_bits((bits & 0x000fffffffffffffLL) | 0x3fe0000000000000LL);
  // Adding an integer below 2⁵¹ to the bits of 1.5 · 2⁵² puts that integer in the last places.
  P e = P::of_bits(exponent + P(6755399441055744.0).bits()) - P(6755399441055744.0);
  const Mask<N> low = m < P(kSqrtHalf);
  e = select(low, e - P(1), e);
  m = select(low, m + m, m) - P(1);
  const P z = m * m;
  P y = m * (z * internal::polynomial(m, kP) / internal::monic_polynomial(m, kQ));
  y = y - e * P(2.121944400546905827679e-4);
  y = y - P(0.5) * z;
  const P result = (m + y) + e * P(0.693359375);
  const double infinity = std::numeric_limits<double>::infinity();
  return select(x > P(0), select(x < P(infinity), result, P(infinity)),
                select(x == P(0), P(-infinity), P(std::numeric_limits<double>::quiet_NaN())));
}

/// 0 for x < -708, ∞ for x > 709.
template <int N>
[[nodiscard]] inline Pack<N> exp(Pack<N> x) {
  using P = Pack<N>;
  constexpr double kP[] = {1.26177193074810590878e-4, 3.02994407707441961300e-2,
                           9.99999999999999999910e-1};
  constexpr double kQ[] = {3.00198505138664455042e-6, 2.52448340349684104192e-3,
                           2.27265548208155028766e-1, 2.00000000000000000009e0};
  const P bounded = clamped(x, P(-708), P(709));
  const P n = nearest(bounded * P(std::numbers::log2e));
  const P r = (bounded - n * P(6.93145751953125e-1)) - n * P(1.42860682030941723212e-6);
  const P z = r * r;
  const P p = r * internal::polynomial(z, kP);
  const P ratio = p / (internal::polynomial(z, kQ) - p);
  const P y = P(1) + (ratio + ratio);
  const typename P::Bits power =
      ((n + P(6755399441055744.0)).bits() - P(6755399441055744.0).bits() + 1023) << 52;
  const P result = y * P::of_bits(power);
  return select(
      x < P(-708), P(0),
      select(x > P(709), P(std::numeric_limits<double>::infinity()), select(x == x, result, x)));
}

/// xʸ for x > 0.
template <int N>
[[nodiscard]] inline Pack<N> pow(Pack<N> x, Pack<N> y) {
  return exp(y * log(x));
}

}  // namespace quadtune
