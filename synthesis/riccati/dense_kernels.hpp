// SPDX-License-Identifier: Apache-2.0
/// Dense kernels for the Riccati doubling: square matrices stored row by row, with rows in vector
/// registers. Small sizes are compile-time constants, so that all loops are unrolled.
#pragma once

#include <algorithm>
#include <cmath>
#include <limits>
#include <type_traits>
#include <utility>

#include "quadtune/internal/small_matrix.hpp"

namespace quadtune::internal {

/// Kernels for n × n matrices with the row stride stride(). All pointers are aligned to 64
/// bytes; outputs do not overlap inputs.
/// @tparam kSize  n, a multiple of 4; or 0 if n is a run-time multiple of kMultiple
/// @tparam Real   double, or float with kSize 0
template <int kSize, class Real = double>
class Kernels {
  static constexpr int kWidest = kRegisterBytes / static_cast<int>(sizeof(Real));

 public:
  static constexpr int kMultiple = 64 / static_cast<int>(sizeof(Real));
  static constexpr int W = kSize % kWidest == 0 ? kWidest : 4;
  using V = Vector<Real, W>;

  explicit Kernels(int n) : n_(n) {}

  [[nodiscard]] int n() const { return kSize > 0 ? kSize : n_; }
  /// Avoids a row stride that is a power of two, with which rows would conflict in the cache.
  [[nodiscard]] int stride() const {
    return kSize > 0 ? kSize : n_ % 64 == 0 ? n_ + kMultiple : n_;
  }

  /// C = A B, or C = Aᵀ B.
  template <bool kTransposeA>
  [[gnu::always_inline]] inline void multiply(const Real* __restrict A, const Real* __restrict B,
                                              Real* __restrict C) const {
    if constexpr (kSize == kInline)
      multiply_terms<kTransposeA>(A, B, C, std::integral_constant<int, kSize>());
    else if constexpr (kSize > 0)
      multiply_called<kTransposeA>(A, B, C, std::integral_constant<int, kSize>());
    else
      multiply_called<kTransposeA>(A, B, C, n());
  }

  /// The same, summed only over the first `inner` columns of A (rows of Aᵀ).
  template <bool kTransposeA>
  void multiply(const Real* __restrict A, const Real* __restrict B, Real* __restrict C,
                int inner) const {
    multiply_called<kTransposeA>(A, B, C, inner);
  }

  /// The same, for large matrices only for the first `columns` columns of B and C, a multiple of
  /// kMultiple; for small ones for all columns.
  template <bool kTransposeA>
  void multiply_panel(const Real* __restrict A, const Real* __restrict B, Real* __restrict C,
                      int inner, [[maybe_unused]] int columns) const {
    if constexpr (kSize > 0)
      multiply_called<kTransposeA>(A, B, C, inner);
    else
      by_panels(
          columns, [&]<int kVectors>(int j) __attribute__((always_inline)) {
            multiply_columns<kTransposeA, kVectors>(A, B, C, j, n(), inner);
          });
  }

  /// The same for a C that is known to be symmetric: if it is large, only the upper triangle is
  /// computed.
  template <bool kTransposeA>
  void multiply_symmetric(const Real* __restrict A, const Real* __restrict B, Real* __restrict C,
                          int inner) const {
    if constexpr (kSize > 0) {
      if (inner == n())
        multiply<kTransposeA>(A, B, C);
      else
        multiply<kTransposeA>(A, B, C, inner);
    } else {
      by_panels(n(), [&]<int kVectors>(int j) {
        multiply_columns<kTransposeA, kVectors>(A, B, C, j, j + kVectors * W, inner);
      });
      for (int i = 0; i < n(); i += 4) {
        for (int r = 1; r < 4; ++r)
          for (int c = 0; c < r; ++c) C[(i + r) * stride() + i + c] = C[(i + c) * stride() + i + r];
        for (int j = i + 4; j < n(); j += 4)
#pragma GCC unroll 4
          for (int r = 0; r < 4; ++r)
#pragma GCC unroll 4
            for (int c = 0; c < 4; ++c)
              C[(j + c) * stride() + i + r] = C[(i + r) * stride() + j + c];
      }
    }
  }

  /// T = Aᵀ.
  [[gnu::always_inline]] inline void transpose(const Real* __restrict A, Real* __restrict T) const {
    const int s = stride();
    for (int i = 0; i < n(); i += 4)
      for (int j = 0; j < n(); j += 4)
#pragma GCC unroll 4
        for (int r = 0; r < 4; ++r)
#pragma GCC unroll 4
          for (int c = 0; c < 4; ++c) T[(j + c) * s + i + r] = A[(i + r) * s + j + c];
  }

  /// Factors P M = L U in place with partial pivoting. M is stored by columns, so that each column
  /// is contiguous. The inverse of the diagonal of U is stored. False if a pivot is 0 or not
  /// finite.
  bool factor(Real* __restrict M, int* __restrict pivots) const {
    const int block = n() <= kUnblocked ? n() : kBlock;
    for (int first = 0; first < n(); first += block) {
      const int last = std::min(first + block, n());
      if (!factor_block(M, pivots, first, last)) return false;
      for (int j = last; j < n(); j += 4) {
        for (int c = j; c < j + 4; ++c)
          for (int k = first; k < last; ++k)
            std::swap(M[c * stride() + k], M[c * stride() + pivots[k]]);
        solve_block(M, j, first, last);
        update_columns(M, j, first, last);
      }
    }
    return true;
  }

  /// X ← M⁻¹ X, with LU from factor().
  void solve(const Real* __restrict LU, const int* pivots, Real* __restrict X) const {
    for (int k = 0; k < n(); ++k) {
      if (pivots[k] == k) continue;
      for (int j = 0; j < n(); j += W) {
        Real* upper = X + k * stride() + j;
        Real* lower = X + pivots[k] * stride() + j;
        const V held = load<V>(upper);
        store(upper, load<V>(lower));
        store(lower, held);
      }
    }
    by_panels(n(), [&]<int kVectors>(int j) {
      constexpr int kRows = rows_with<kVectors>();
      for (int i = 0; i < n(); i += kRows) solve_lower<kVectors, kRows>(LU, X + j, i);
      for (int i = n() - kRows; i >= 0; i -= kRows) solve_upper<kVectors, kRows>(LU, X + j, i);
    });
  }

 private:
  /// rows[r]: 1 in the lanes from r on, 0 in the others.
  static constexpr auto make_masks() {
    struct Masks {
      alignas(64) Real rows[W][W] = {};
    } masks;
    for (int r = 0; r < W; ++r)
      for (int lane = r; lane < W; ++lane) masks.rows[r][lane] = 1;
    return masks;
  }
  static constexpr auto kMasks = make_masks();

  static constexpr int kBlock = kMultiple;  ///< columns that factor() eliminates together
  static constexpr int kUnblocked = 32;     ///< up to this size, columns one by one

  /// Number of rows per pass over a panel: as many as fit in the registers in addition to the row
  /// of the panel.
  template <int kVectors>
  static constexpr int rows_with() {
    constexpr int kRoom = kRegisters - kVectors - 1;
    if (kSize % 8 == 0 && 8 * kVectors <= kRoom) return 8;
    if (4 * kVectors <= kRoom) return 4;
    return 2 * kVectors <= kRoom ? 2 : 1;
  }

  /// Calls work.template operator()<vectors>(first column) for panels of up to three vectors, or of
  /// four if that leaves no remainder.
  template <class Work>
  [[gnu::always_inline]] inline void by_panels([[maybe_unused]] int columns,
                                               const Work& work) const {
    if constexpr (kSize > 0 && kSize / W <= 4) {
      work.template operator()<kSize / W>(0);
    } else {
      int j = 0;
      for (; columns - j >= 3 * W && columns - j != 4 * W; j += 3 * W)
        work.template operator()<3>(j);
      if (columns - j == 4 * W)
        work.template operator()<4>(j);
      else if (columns - j == 2 * W)
        work.template operator()<2>(j);
      else if (columns - j == W)
        work.template operator()<1>(j);
    }
  }

  static constexpr Real kHuge = std::numeric_limits<Real>::max() / 1000;

  /// At this size a function call costs more than the work itself, so the kernels are inlined.
  static constexpr int kInline = 4;

  template <bool kTransposeA, class Inner>
  [[gnu::noinline]] void multiply_called(const Real* __restrict A, const Real* __restrict B,
                                         Real* __restrict C, Inner inner) const {
    multiply_terms<kTransposeA>(A, B, C, inner);
  }

  template <bool kTransposeA, class Inner>
  [[gnu::always_inline]] inline void multiply_terms(const Real* __restrict A,
                                                    const Real* __restrict B, Real* __restrict C,
                                                    Inner inner) const {
    by_panels(
        n(), [&]<int kVectors>(int j) __attribute__((always_inline)) {
          multiply_columns<kTransposeA, kVectors>(A, B, C, j, n(), inner);
        });
  }

  /// Computes kVectors vectors of columns of C from column j on, for the first `rows` rows.
  template <bool kTransposeA, int kVectors, class Inner>
  [[gnu::always_inline]] inline void multiply_columns(const Real* __restrict A,
                                                      const Real* __restrict B, Real* __restrict C,
                                                      int j, int rows, Inner inner) const {
    constexpr int kRows = rows_with<kVectors>();
    for (int i = 0; i < rows; i += kRows)
      multiply_tile<kTransposeA, kVectors, kRows>(A, B, C, i, j, inner);
  }

  template <bool kTransposeA, int kVectors, int kRows, class Inner>
  [[gnu::always_inline]] inline void multiply_tile(const Real* __restrict A,
                                                   const Real* __restrict B, Real* __restrict C,
                                                   int i, int j, Inner inner) const {
    const int s = stride();
    Tile<V, kRows, kVectors> sum;
    const auto entries = kTransposeA ? entries_of<V>(A + i, 1, s) : entries_of<V>(A + i * s, s, 1);
    sum.add_product(0, inner, entries, vectors_of<V>(B + j, s));
    sum.each([&](int r, int v, V x) { store(C + (i + r) * s + j + v * W, x); });
  }

  /// Eliminates the columns [first, last) over all rows below. Swaps rows only in the columns
  /// before `last`.
  bool factor_block(Real* __restrict M, int* __restrict pivots, int first, int last) const {
    for (int k = first; k < last; ++k) {
      Real* column = M + k * stride();
      int pivot = k;
      Real largest = std::abs(column[k]);
      for (int i = k + 1; i < n(); ++i) {
        const Real size = std::abs(column[i]);
        if (size > largest) {
          largest = size;
          pivot = i;
        }
      }
      pivots[k] = pivot;
      if (!(largest > 0) || !(largest <= kHuge)) return false;
      if (pivot != k)
        for (int j = 0; j < last; ++j) std::swap(M[j * stride() + k], M[j * stride() + pivot]);
      // Rows up to k in the first vector are not eliminated: their multipliers are 0.
      const Real inverse = 1 / column[k];
      const V scale = broadcast<V>(inverse);
      const int aligned = (k + 1) / W * W;
      V multipliers = {};
      if (aligned < n()) {
        const V mask = load<V>(kMasks.rows[k + 1 - aligned]);
        const V entries = load<V>(column + aligned);
        multipliers = entries * mask * scale;
        store(column + aligned, multiply_add(entries, broadcast<V>(1) - mask, multipliers));
      }
      for (int i = aligned + W; i < n(); i += W) store(column + i, load<V>(column + i) * scale);
      column[k] = inverse;
      if (aligned == n()) continue;
      for (int j = k + 1; j < last; ++j) {
        Real* target = M + j * stride();
        const V factor = broadcast<V>(target[k]);
        store(target + aligned, subtract_product(factor, multipliers, load<V>(target + aligned)));
        for (int i = aligned + W; i < n(); i += W)
          store(target + i, subtract_product(factor, load<V>(column + i), load<V>(target + i)));
      }
    }
    return true;
  }

  /// Applies U12 ← L11⁻¹ U12 to the rows [first, last) of four columns from j on.
  void solve_block(Real* __restrict M, int j, int first, int last) const {
    const int s = stride();
    for (int k = first; k < last; ++k) {
      const Real* l = M + k * s;
      Real* u = M + j * s;
      for (int i = k + 1; i < last; ++i)
#pragma GCC unroll 4
        for (int c = 0; c < 4; ++c) u[c * s + i] -= l[i] * u[c * s + k];
    }
  }

  /// Subtracts L21 U12 from four columns from j on, below the block [first, last).
  void update_columns(Real* __restrict M, int j, int first, int last) const {
    int i = last;
    for (; n() - i >= 4 * W; i += 4 * W) update_tile<4>(M, i, j, first, last);
    for (; i < n(); i += W) update_tile<1>(M, i, j, first, last);
  }

  /// The same for kVectors vectors of rows from i on.
  template <int kVectors>
  [[gnu::always_inline]] inline void update_tile(Real* __restrict M, int i, int j, int first,
                                                 int last) const {
    const int s = stride();
    Tile<V, 4, kVectors> x;
    x.set(vectors_of<V>(M + j * s + i, s));
    x.subtract_product_of(first, last, entries_of<V>(M + j * s, s, 1), vectors_of<V>(M + i, s));
    x.each([&](int c, int v, V from) { store(M + (j + c) * s + i + v * W, from); });
  }

  /// Computes kRows rows of L⁻¹ X from row i on, given the rows above. X points to the first column
  /// of the panel.
  template <int kVectors, int kRows>
  void solve_lower(const Real* __restrict LU, Real* __restrict X, int i) const {
    const int s = stride();
    const auto entry = entries_of<V>(LU + i, 1, s);  // LU is stored by columns
    Tile<V, kRows, kVectors> x;
    x.set(vectors_of<V>(X + i * s, s));
    x.subtract_product_of(0, i, entry, vectors_of<V>(X, s));
    x.solve_unit_lower([&](int r, int q) { return entry(r, i + q); });
    x.each([&](int r, int v, V from) { store(X + (i + r) * s + v * W, from); });
  }

  /// Computes kRows rows of U⁻¹ X from row i on, given the rows below.
  template <int kVectors, int kRows>
  void solve_upper(const Real* __restrict LU, Real* __restrict X, int i) const {
    const int s = stride();
    const auto entry = entries_of<V>(LU + i, 1, s);
    Tile<V, kRows, kVectors> x;
    x.set(vectors_of<V>(X + i * s, s));
    x.subtract_product_of(i + kRows, n(), entry, vectors_of<V>(X, s));
#pragma GCC unroll 8
    for (int r = kRows - 1; r >= 0; --r) {
#pragma GCC unroll 8
      for (int q = kRows - 1; q > r; --q) x.subtract_row(r, q, entry(r, i + q));
      x.multiply_row(r, entry(r, i + r));
    }
    x.each([&](int r, int v, V from) { store(X + (i + r) * s + v * W, from); });
  }

  int n_;
};

}  // namespace quadtune::internal
