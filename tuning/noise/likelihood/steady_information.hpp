// SPDX-License-Identifier: Apache-2.0
/// The information N of the adjoint pass over a stretch of steady gains, where a step is
/// N ← A N Aᵀ + W with constant A and W. It is computed by doubling; the number of products is the
/// number of binary digits of the length of the stretch.
#pragma once

#include <cmath>
#include <cstdint>

#include "noise/likelihood/small_algebra.hpp"

namespace quadtune::internal {

template <int N>
struct SteadyInformation {
  Square<N> last;  ///< N after all steps
  Square<N> sum;   ///< of N before each step
};

/// The map of `steps` steps: N becomes made + power N powerᵀ, and the sum of N before each step is
/// sum_made + the sum of the propagated initial N.
template <int N>
struct StepsBack {
  std::int64_t steps = 0;
  Square<N> power, made, sum_made;
  Square<N> sum_passed;  ///< sum for the initial N
};

/// Combines `late` after `early`. Returns whether `early` no longer depends on its start: N at its
/// end is independent of the initial N up to rounding.
template <int N>
bool join(const StepsBack<N>& early, const StepsBack<N>& late, StepsBack<N>& both) {
  // The N that `late` makes from 0 may be the initial N of `early`, and so on: all steps are equal,
  // so the two commute.
  StepsBack<N> result = late;
  propagate<N>(early.power, result.made, &early.made);
  propagate<N>(early.power, result.sum_made, &early.sum_made);
  propagate<N>(early.power, result.sum_passed, &early.sum_passed);
  bool forgotten = true;
  for (int j = 0; j < N; ++j)
    for (int i = j; i < N; ++i) {
      const auto kept = [&](const Square<N>& after, const Square<N>& before) {
        return std::abs(after(i, j) - before(i, j)) >
               1e-16 * std::sqrt(before(i, i)) * std::sqrt(before(j, j));
      };
      forgotten = forgotten && !kept(result.made, early.made) &&
                  !kept(result.sum_made, early.sum_made) &&
                  !kept(result.sum_passed, early.sum_passed);
    }
  const auto count = static_cast<double>(late.steps);
  for (int i = 0; i < N * N; ++i) result.sum_made.at[i] += count * early.made.at[i];
  for (int j = 0; j < N; ++j)
    multiply<N>(early.power, late.power.column(j), result.power.column(j));
  result.steps = early.steps + late.steps;
  both = result;
  return forgotten;
}

template <int N>
SteadyInformation<N> steady_information(const Square<N>& A, const Square<N>& W,
                                        const Square<N>& start, std::int64_t steps) {
  StepsBack<N> doubled;  // 1, 2, 4, ... steps
  doubled.steps = 1;
  doubled.power = A;
  doubled.made = W;
  doubled.sum_passed = start;
  StepsBack<N> all;
  for (int i = 0; i < N; ++i) all.power(i, i) = 1;
  for (std::int64_t left = steps; left > 0; left /= 2) {
    if (left % 2 == 1) join(doubled, all, all);
    if (left == 1) break;
    if (!join(doubled, doubled, doubled)) continue;
    // All further steps do not change N.
    const auto more = static_cast<double>(steps - doubled.steps);
    for (int i = 0; i < N * N; ++i) doubled.sum_made.at[i] += more * doubled.made.at[i];
    all = doubled;
    break;
  }
  SteadyInformation<N> result{start, all.sum_made};
  propagate<N>(all.power, result.last, &all.made);
  for (int i = 0; i < N * N; ++i) result.sum.at[i] += all.sum_passed.at[i];
  return result;
}

}  // namespace quadtune::internal
