// SPDX-License-Identifier: Apache-2.0
/// Random numbers that are functions of seed, flight, stream and index only. There is no state, so
/// the order of computation does not matter.
///
/// Philox 4×32 with ten rounds [Salmon11]; normal numbers by the Box-Muller transform.
#pragma once

#include <array>
#include <cstdint>
#include <numbers>
#include <type_traits>

#include "quadtune/simulation/pack_math.hpp"

namespace quadtune {

/// Four random words from a counter of four words and a key of two.
[[nodiscard]] constexpr std::array<std::uint32_t, 4> philox(std::array<std::uint32_t, 4> counter,
                                                            std::array<std::uint32_t, 2> key) {
  for (int round = 0; round < 10; ++round) {
    const std::uint64_t a = std::uint64_t{0xD2511F53} * counter[0];
    const std::uint64_t b = std::uint64_t{0xCD9E8D57} * counter[2];
    counter = {
        static_cast<std::uint32_t>(b >> 32) ^ counter[1] ^ key[0], static_cast<std::uint32_t>(b),
        static_cast<std::uint32_t>(a >> 32) ^ counter[3] ^ key[1], static_cast<std::uint32_t>(a)};
    key = {key[0] + 0x9E3779B9, key[1] + 0xBB67AE85};
  }
  return counter;
}

/// Source of the random numbers of several flights, one flight per lane.
template <int N>
struct RandomSource {
  std::uint64_t seed = 0;
  std::array<std::uint32_t, N> flight{};  ///< number of the flight among those with this seed
};

/// Two independent numbers per lane.
template <int N>
struct RandomPair {
  Pack<N> first;
  Pack<N> second;
};

/// Uniform in the open interval (0, 1): (k + ½) / 2⁵² for an integer k of 52 bits.
/// @param stream  the quantity, e.g. the x axis of the gyroscope
/// @param index   number of its sample
template <int N>
[[nodiscard]] inline RandomPair<N> random_uniform(const RandomSource<N>& source,
                                                  std::uint32_t stream, std::uint64_t index) {
  // One word of 32 bits in each 64-bit lane.
  using Words = typename PackTypes<N>::Words;
  const Words zero{};
  Words c0 = zero + static_cast<std::uint32_t>(index);
  Words c1 = zero + static_cast<std::uint32_t>(index >> 32);
  Words c2 = zero + stream;
  Words c3;
  if constexpr (N == 1) {
    c3 = source.flight[0];
  } else {
    for (int i = 0; i < N; ++i) c3[i] = source.flight[static_cast<std::size_t>(i)];
  }
  std::uint64_t k0 = static_cast<std::uint32_t>(source.seed);
  std::uint64_t k1 = static_cast<std::uint32_t>(source.seed >> 32);
  constexpr std::uint64_t kLow = 0xffffffff;
  for (int round = 0; round < 10; ++round) {
    const Words a = c0 * std::uint64_t{0xD2511F53};
    const Words b = c2 * std::uint64_t{0xCD9E8D57};
    c0 = (b >> 32) ^ c1 ^ k0;
    c1 = b & kLow;
    c2 = (a >> 32) ^ c3 ^ k1;
    c3 = a & kLow;
    k0 = (k0 + 0x9E3779B9) & kLow;
    k1 = (k1 + 0xBB67AE85) & kLow;
  }
  using P = Pack<N>;
  const auto fraction = [](Words high, Words low) {
    const P k = P::of_whole((typename P::Bits)(((high << 32) | low) >> 12));
    return (k + P(0.5)) * P(1.0 / 4503599627370496.0);  // 2⁻⁵²
  };
  return {fraction(c1, c0), fraction(c3, c2)};
}

/// Normal with mean 0 and variance 1.
template <int N>
[[nodiscard]] inline RandomPair<N> random_normal(const RandomSource<N>& source,
                                                 std::uint32_t stream, std::uint64_t index) {
  using P = Pack<N>;
  const RandomPair<N> uniform = random_uniform(source, stream, index);
  const P radius = sqrt(P(-2) * log(uniform.first));
  const internal::SineAndCosine<N> angle =
      internal::sine_and_cosine(uniform.second * P(2 * std::numbers::pi));
  return {radius * angle.cosine, radius * angle.sine};
}

}  // namespace quadtune
