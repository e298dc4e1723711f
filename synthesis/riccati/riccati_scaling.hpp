// SPDX-License-Identifier: Apache-2.0
/// The scale of each state that levels the equation's matrices against one another.
#pragma once

#include <Eigen/Core>
#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

namespace quadtune::internal {

/// Finds powers of two d such that in z, x = diag(d) z, the rows and columns of the Hamiltonian
/// matrix [A -G; -Q -Aᵀ] have about the same sums: Osborne's balancing, kept symplectic, so that it
/// also sets the ratio of ‖Q‖ to ‖G‖.
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
  // All states alike first: G/s² and Q s² of the same size.
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

/// The measures of a residual matrix: squared norms in the caller's units, and relative to the
/// terms in those units and in the scaled ones. A default one is that of no solution.
struct Residual {
  double squared = std::numeric_limits<double>::quiet_NaN();
  std::array<double, 4> squared_terms{};
  double relative = std::numeric_limits<double>::quiet_NaN();
  double relative_scaled = std::numeric_limits<double>::quiet_NaN();

  [[nodiscard]] double worst() const { return std::max(relative, relative_scaled); }
};

/// √squared over the sum of the roots of `terms`.
inline double relative_size(double squared, const std::array<double, 4>& terms) {
  if (squared == 0) return 0;
  double sum = 0;
  for (const double term : terms) sum += std::sqrt(term);
  return std::sqrt(squared) / sum;
}

/// Collects a speed γ [1/s] for the Cayley transform, near √(slowest · fastest closed-loop pole),
/// for which the doubling takes the fewest steps: the geometric mean of the sizes of the rows [A G]
/// and columns [A; Q] of the balanced problem. The size of a row is its norm ‖h‖₂ where one entry
/// rules; of p about equal entries, most of which cancel in a slow pole, it is ‖h‖₂ p^(-1/4), with
/// p = ‖h‖₁²/‖h‖₂². The exponent was found by trial on random problems of 12 to 192 states.
class GeometricSpeed {
 public:
  /// Of one row or column: Σ h², Σ |h|.
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
