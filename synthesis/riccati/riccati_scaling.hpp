// SPDX-License-Identifier: Apache-2.0
/// Balances the matrices of the equation by a scale of each state.
#pragma once

#include <Eigen/Core>
#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

namespace quadtune::internal {

/// Computes powers of two d such that in z, x = diag(d) z, the rows and columns of the Hamiltonian
/// matrix [A -G; -Q -Aᵀ] have approximately the same sums. This is Osborne's balancing, restricted
/// to symplectic scalings, so that it also determines the ratio of ‖Q‖ to ‖G‖.
///
/// @param rows     |A| with row i at rows + i·stride
/// @param columns  |A| with column i at columns + i·stride
/// @param G, Q     |G| and |Q|, symmetric
/// @param scale    (n) out: d
/// @param inverse  (n) out: 1/d
/// @param dot      (const double*, const double*) → the inner product of n numbers
template <class Dot>
void level_scales(const double* rows, const double* columns, const double* G, const double* Q,
                  Eigen::Index n, Eigen::Index stride, double* scale, double* inverse,
                  const Dot& dot) {
  constexpr int kSweeps = 10;
  // Start with one scale s for all states: G/s² and Q s² have the same magnitude.
  std::fill_n(scale, n, 1.0);
  double sum_G = 0;
  double sum_Q = 0;
  for (Eigen::Index i = 0; i < n; ++i) {
    sum_G += dot(G + i * stride, scale);
    sum_Q += dot(Q + i * stride, scale);
  }
  const double ratio = sum_G / sum_Q;
  const int common = ratio > 0 && std::isfinite(ratio) ? std::ilogb(ratio) / 4 : 0;
  std::fill_n(scale, n, std::ldexp(1.0, common));
  std::fill_n(inverse, n, std::ldexp(1.0, -common));
  bool changed = true;
  for (int sweep = 0; changed && sweep < kSweeps; ++sweep) {
    changed = false;
    for (Eigen::Index i = 0; i < n; ++i) {
      const Eigen::Index at = i * stride;
      const double diagonal = rows[at + i];
      const double row = inverse[i] * (dot(rows + at, scale) + dot(G + at, inverse)) - diagonal;
      const double column = scale[i] * (dot(columns + at, inverse) + dot(Q + at, scale)) - diagonal;
      const double quotient = row / column;
      if (!(quotient > 0) || !std::isfinite(quotient)) continue;
      const int half = std::ilogb(quotient) / 2;
      if (half == 0) continue;
      scale[i] *= std::ldexp(1.0, half);
      inverse[i] *= std::ldexp(1.0, -half);
      changed = true;
    }
  }
}

/// Norms of a residual matrix: squared in the caller's units, and relative to the terms in those
/// units and in the scaled ones. The default value means that there is no solution.
struct Residual {
  double squared = std::numeric_limits<double>::quiet_NaN();
  std::array<double, 4> squared_terms{};
  double relative = std::numeric_limits<double>::quiet_NaN();
  double relative_scaled = std::numeric_limits<double>::quiet_NaN();

  [[nodiscard]] double worst() const { return std::max(relative, relative_scaled); }
};

/// √squared / sum of the square roots of `terms`.
inline double relative_size(double squared, const std::array<double, 4>& terms) {
  if (squared == 0) return 0;
  double sum = 0;
  for (const double term : terms) sum += std::sqrt(term);
  return std::sqrt(squared) / sum;
}

/// Accumulates the shift γ [1/s] of the Cayley transform. It approximates √(slowest · fastest
/// closed-loop pole), for which doubling needs the fewest steps, by the geometric mean of the sizes
/// of the rows [A G] and columns [A; Q] of the balanced problem. The size of a row h is ‖h‖₂
/// p^(-1/4), where p = ‖h‖₁²/‖h‖₂² is the effective number of its entries: with one dominant entry
/// it is ‖h‖₂; p similar entries largely cancel in a slow pole. The exponent was determined
/// empirically on random problems with 12 to 192 states.
class GeometricSpeed {
 public:
  /// Adds one row or column, given Σ h² and Σ |h|.
  void add(double squares, double sum) {
    if (!(squares > 0)) return;
    logarithms_ += 2 * (std::log(squares) - std::log(sum));
    ++count_;
  }
  [[nodiscard]] double value() const {
    return count_ == 0 ? 1.0 : std::exp(logarithms_ / (2.0 * count_));
  }

 private:
  double logarithms_ = 0;
  int count_ = 0;
};

}  // namespace quadtune::internal
