// SPDX-License-Identifier: Apache-2.0
/// Pack with the functions that on-board code calls.
#pragma once

#if __has_include("quadtune/simulation/pack_math.hpp")
#include "quadtune/simulation/pack_math.hpp"
#else
#include <cmath>

#include "quadtune/simulation/pack.hpp"

// Computed lane by lane until there are packed implementations.
namespace quadtune {
template <int N>
Pack<N> sin(Pack<N> a) {
  return map_lanes(a, [](double x) { return std::sin(x); });
}
template <int N>
Pack<N> cos(Pack<N> a) {
  return map_lanes(a, [](double x) { return std::cos(x); });
}
template <int N>
Pack<N> exp(Pack<N> a) {
  return map_lanes(a, [](double x) { return std::exp(x); });
}
template <int N>
Pack<N> log(Pack<N> a) {
  return map_lanes(a, [](double x) { return std::log(x); });
}
template <int N>
Pack<N> atan2(Pack<N> y, Pack<N> x) {
  for (int i = 0; i < N; ++i) set_lane(y, i, std::atan2(lane(y, i), lane(x, i)));
  return y;
}
}  // namespace quadtune
#endif

namespace quadtune::testing {

/// Lane `i` of every entry.
template <class Derived>
auto lane_of(const Eigen::MatrixBase<Derived>& packs, int i) {
  Eigen::Matrix<double, Derived::RowsAtCompileTime, Derived::ColsAtCompileTime> result(
      packs.rows(), packs.cols());
  for (Eigen::Index k = 0; k < packs.size(); ++k) result(k) = lane(packs.derived()(k), i);
  return result;
}

}  // namespace quadtune::testing
