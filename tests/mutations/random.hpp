// SPDX-License-Identifier: Apache-2.0
/// Random choices that do not depend on the compiler or the library.
#pragma once

#include <cstddef>
#include <cstdint>
#include <string>
#include <vector>

namespace quadtune::mutations {

/// SplitMix64 (Steele, Lea, Flood: Fast splittable pseudorandom number generators, 2014).
class Random {
 public:
  explicit Random(std::uint64_t seed) : state_(seed) {}
  /// The generator of one case of a seed; those of neighbouring cases are independent.
  Random(std::uint64_t seed, std::uint64_t number) : state_(Random(seed).next() ^ number) {
    state_ = next();
  }

  std::uint64_t next() {
    std::uint64_t z = state_ += 0x9e3779b97f4a7c15U;
    z = (z ^ (z >> 30U)) * 0xbf58476d1ce4e5b9U;
    z = (z ^ (z >> 27U)) * 0x94d049bb133111ebU;
    return z ^ (z >> 31U);
  }
  /// A number from 0 to n - 1; 0 if n is 0.
  std::size_t below(std::size_t n) { return n == 0 ? 0 : static_cast<std::size_t>(next() % n); }
  bool percent(unsigned share) { return next() % 100 < share; }
  /// A number from -1 to 1.
  double noise() { return static_cast<double>(below(20001)) / 10000 - 1; }

  template <typename List>
  const auto& of(const List& list) {
    return list[below(list.size())];
  }

 private:
  std::uint64_t state_;
};

}  // namespace quadtune::mutations
