// SPDX-License-Identifier: Apache-2.0
/// Random numbers that depend on nothing but their place: seed, flight, stream and index. There is
/// no state, so no order of computation changes them.
///
/// Philox 4×32 with ten rounds [Salmon11]; normal numbers by Box and Muller's transform.
#pragma once

#include <array>
#include <cstdint>
#include <numbers>
#include <type_traits>

#include "quadtune/simulation/pack_math.hpp"

namespace quadtune {

/// Four random words for a counter of four words and a key of two.
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

/// Where the random numbers of some flights come from, a flight a lane.
template <int N>
struct RandomSource {
  std::uint64_t seed = 0;
  std::array<std::uint32_t, N> flight{};  ///< which of the flights with this seed
};

/// Two independent numbers a lane.
template <int N>
struct RandomPair {
  Pack<N> first;
  Pack<N> second;
};

/// Even in (0, 1), never an end: (k + ½) / 2⁵² for k of 52 bits.
/// @param stream  which quantity, e.g. the x axis of the gyroscope
/// @param index   which sample of it
template <int N>
[[nodiscard]] inline RandomPair<N> random_uniform(const RandomSource<N>& source,
                                                  std::uint32_t stream, std::uint64_t index) {
  // Written over arrays, so that the lanes are computed side by side.
  std::array<std::uint64_t, N> c0;
  std::array<std::uint64_t, N> c1;
  std::array<std::uint64_t, N> c2;
  std::array<std::uint64_t, N> c3;
  for (std::size_t i = 0; i < N; ++i) {
    c0[i] = static_cast<std::uint32_t>(index);
    c1[i] = static_cast<std::uint32_t>(index >> 32);
    c2[i] = stream;
    c3[i] = source.flight[i];
  }
  std::uint64_t k0 = static_cast<std::uint32_t>(source.seed);
  std::uint64_t k1 = static_cast<std::uint32_t>(source.seed >> 32);
  constexpr std::uint64_t kLow = 0xffffffff;
  for (int round = 0; round < 10; ++round) {
    for (std::size_t i = 0; i < N; ++i) {
      const std::uint64_t a = std::uint64_t{0xD2511F53} * c0[i];
      const std::uint64_t b = std::uint64_t{0xCD9E8D57} * c2[i];
      c0[i] = (b >> 32) ^ c1[i] ^ k0;
      c1[i] = b & kLow;
      c2[i] = (a >> 32) ^ c3[i] ^ k1;
      c3[i] = a & kLow;
    }
    k0 = (k0 + 0x9E3779B9) & kLow;
    k1 = (k1 + 0xBB67AE85) & kLow;
  }
  RandomPair<N> result;
  for (std::size_t i = 0; i < N; ++i) {
    constexpr double kStep = 1.0 / 4503599627370496.0;  // 2⁻⁵²
    const auto first = static_cast<std::int64_t>(((c1[i] << 32) | c0[i]) >> 12);
    const auto second = static_cast<std::int64_t>(((c3[i] << 32) | c2[i]) >> 12);
    set_lane(result.first, static_cast<int>(i), (static_cast<double>(first) + 0.5) * kStep);
    set_lane(result.second, static_cast<int>(i), (static_cast<double>(second) + 0.5) * kStep);
  }
  return result;
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
