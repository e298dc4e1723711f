// SPDX-License-Identifier: Apache-2.0
/// The arithmetic of doubling_steps.hpp for several problems at once: every number is a vector with
/// one entry, or lane, for each problem (structure of arrays), so that no shuffle and no broadcast
/// is needed and a transpose costs nothing. There is no pivoting, because all lanes would have to
/// use the same pivots.
#pragma once

#include <Eigen/Core>
#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <utility>
#include <vector>

#include "quadtune/internal/small_matrix.hpp"
#include "riccati/riccati_scaling.hpp"

namespace quadtune::internal {

/// One number of each problem, as many problems as fit in a register.
#if defined(__AVX512F__)
inline constexpr int kLaneCount = 8;
#elif defined(__AVX__)
inline constexpr int kLaneCount = 4;
#else
inline constexpr int kLaneCount = 2;
#endif
using Lane = Vector<double, kLaneCount>;

inline Lane all_lanes(double x) { return broadcast<Lane>(x); }
inline Lane larger(Lane a, Lane b) { return a > b ? a : b; }
/// The largest of all lanes; NaN if one is NaN.
inline double largest(Lane v) {
  double result = v[0];
  for (int lane = 1; lane < kLaneCount; ++lane)
    if (!std::isnan(result) && !(v[lane] <= result)) result = v[lane];
  return result;
}

/// A matrix of lanes, row by row.
class LaneMatrix : public VectorStorage<Lane> {
 public:
  LaneMatrix(int rows, int columns)
      : VectorStorage(rows * columns), rows_(rows), columns_(columns) {}
  using VectorStorage::operator=;

  [[nodiscard]] int rows() const { return rows_; }
  [[nodiscard]] int columns() const { return columns_; }
  [[nodiscard]] Lane& operator()(int i, int j) { return begin()[i * columns_ + j]; }
  [[nodiscard]] const Lane& operator()(int i, int j) const { return begin()[i * columns_ + j]; }

 private:
  int rows_;
  int columns_;
};

/// Residuals of all lanes relative to the sum of the norms of the terms: in the caller's units, and
/// the larger of that and the residual in scaled states.
struct LaneResidual {
  Lane relative = all_lanes(std::numeric_limits<double>::quiet_NaN());
  Lane worst = relative;
};

class LaneOps {
 public:
  using Square = LaneMatrix;
  using Panel = LaneMatrix;  ///< (nx × nu), and small (nu × nu) matrices

  LaneOps(Eigen::Index nx, Eigen::Index nu)
      : nx_(static_cast<int>(nx)),
        nu_(static_cast<int>(nu)),
        n_(padded(nx_)),
        m_(padded(nu_)),
        scale_(static_cast<std::size_t>(n_), 1.0),
        inverse_scale_(scale_),
        factor_(n_, n_),
        small_(m_, m_) {
    for (std::vector<double>* M : {&rows_, &lane_columns_, &lane_G_, &lane_Q_})
      M->resize(static_cast<std::size_t>(nx_) * static_cast<std::size_t>(nx_));
  }

  [[nodiscard]] int size() const { return nx_; }
  [[nodiscard]] Square square() const { return {n_, n_}; }
  [[nodiscard]] Panel panel() const { return {n_, m_}; }
  [[nodiscard]] Panel small() const { return {m_, m_}; }

  /// Writes the matrix of a problem to one lane; the padding remains 0.
  static void load(const Eigen::MatrixXd& from, int lane, LaneMatrix& to) {
    for (int j = 0; j < from.cols(); ++j)
      for (int i = 0; i < from.rows(); ++i) to(i, j)[lane] = from(i, j);
  }

  // Products. Rows and columns are multiples of kMultiple; the output must not alias an input.
  void multiply(const LaneMatrix& A, const LaneMatrix& B, LaneMatrix& C) const {
    product<false, false>(A, B, C);
  }
  void multiply_tn(const LaneMatrix& A, const LaneMatrix& B, LaneMatrix& C) const {
    product<true, false>(A, B, C);
  }
  /// C = A Bᵀ.
  void multiply_nt(const LaneMatrix& A, const LaneMatrix& B, LaneMatrix& C) const {
    product<false, true>(A, B, C);
  }
  /// C ← C - A Bᵀ.
  void subtract_product_nt(const LaneMatrix& A, const LaneMatrix& B, LaneMatrix& C) const {
    product<false, true, true>(A, B, C);
  }
  /// S ← S + AᵀB, the product known to be symmetric. Returns the maximum relative change over all
  /// lanes, and 1; NaN if a number is not finite.
  std::pair<double, double> add_product_tn(const Square& A, const Square& B, Square& S) const {
    return add_symmetric_product<true, false>(A, B, S);
  }
  /// S ← S + A Bᵀ, the product known to be symmetric.
  void add_product_nt(const Square& A, const Square& B, Square& S) const {
    add_symmetric_product<false, true>(A, B, S);
  }

  /// Factors A = L U for solve(), tile by tile. False if a pivot of any lane is 0 or not finite.
  /// The inverse of the diagonal of U is stored.
  bool factor(const Square& A) {
    factor_ = A;
    Lane smallest = all_lanes(std::numeric_limits<double>::infinity());
    for (int i = 0; i < n_; i += T) {
      for (int j = 0; j < i; j += T) solve_right(i, j);
      factor_diagonal(i, smallest);
      for (int j = i + T; j < n_; j += T) solve_lower(factor_, i, j);
    }
    for (int lane = 0; lane < kLaneCount; ++lane)
      if (!(smallest[lane] > 0) || !std::isfinite(smallest[lane])) return false;
    return true;
  }

  /// X ← A⁻¹ X.
  void solve(Square& X) const {
    for (int j = 0; j < X.columns(); j += T) {
      for (int i = 0; i < n_; i += T) solve_lower(X, i, j);
      for (int i = n_ - T; i >= 0; i -= T) solve_upper(X, i, j);
    }
  }

  /// Computes the inverse of the Cholesky factor of the small S. False if the S of any lane is not
  /// positive definite beyond rounding.
  bool invert_cholesky(const Panel& S, Panel& inverse) {
    small_ = S;
    const auto is_positive = [](Lane pivot, Lane entry) {
      for (int lane = 0; lane < kLaneCount; ++lane)
        if (!(pivot[lane] > kSmallestPivot * entry[lane])) return false;
      return true;
    };
    if (!factor_cholesky(nu_, small_, is_positive)) return false;
    invert_lower(nu_, small_, inverse);
    return true;
  }

  static void transpose(const Square& A, Square& to) {
    for (int i = 0; i < A.rows(); ++i)
      for (int j = 0; j < A.columns(); ++j) to(j, i) = A(i, j);
  }
  void set_identity(Square& A) const {
    A = 0;
    add_diagonal(A, 1);
  }
  void add_diagonal(Square& A, double value) const {
    for (int i = 0; i < n_; ++i) A(i, i) += all_lanes(value);
  }
  /// Sets the diagonal of the states that are only padding.
  void set_padding(Square& A, double value) const {
    for (int i = nx_; i < n_; ++i) A(i, i) = all_lanes(value);
  }
  /// S = factor · (M + Mᵀ)/2.
  static void scaled_symmetric(const Square& M, double factor, Square& S) {
    const Lane half = all_lanes(0.5 * factor);
    for (int i = 0; i < M.rows(); ++i)
      for (int j = i; j < M.columns(); ++j) S(i, j) = S(j, i) = (M(i, j) + M(j, i)) * half;
  }
  /// S ← S + (M + Mᵀ)/2.
  static void add_symmetric(const Square& M, Square& S) {
    for (int i = 0; i < M.rows(); ++i)
      for (int j = i; j < M.columns(); ++j)
        S(i, j) = S(j, i) = S(i, j) + (M(i, j) + M(j, i)) * all_lanes(0.5);
  }

  // Norms.
  /// The maximum over all lanes.
  [[nodiscard]] static double norm1(const Square& A) {
    Lane max = {};
    for (int j = 0; j < A.columns(); ++j) {
      Lane sum = {};
      for (int i = 0; i < A.rows(); ++i) sum += abs_of(A(i, j));
      max = larger(sum, max);
    }
    return largest(max);
  }
  [[nodiscard]] static Lane squared_norm(const LaneMatrix& A) {
    Lane sum = {};
    for (int i = 0; i < A.size(); ++i) sum = multiply_add(A.begin()[i], A.begin()[i], sum);
    return sum;
  }

  // Scaling of the states, computed from the first lane; the others are assumed to be similar.
  void balance(const Square& A, const Square& G, const Square& Q) {
    std::size_t at = 0;
    for (int i = 0; i < nx_; ++i)
      for (int j = 0; j < nx_; ++j, ++at) {
        rows_[at] = std::abs(A(i, j)[0]);
        lane_columns_[at] = std::abs(A(j, i)[0]);
        lane_G_[at] = std::abs(G(i, j)[0]);
        lane_Q_[at] = std::abs(Q(i, j)[0]);
      }
    const auto dot = [n = nx_](const double* a, const double* b) {
      return Eigen::Map<const Eigen::VectorXd>(a, n).dot(Eigen::Map<const Eigen::VectorXd>(b, n));
    };
    level_scales(rows_.data(), lane_columns_.data(), lane_G_.data(), lane_Q_.data(), nx_, nx_,
                 scale_.data(), inverse_scale_.data(), dot);
  }
  /// γ of the Cayley transform of scaled matrices, for the first lane.
  [[nodiscard]] double speed(const Square& A, const Square& G, const Square& Q) const {
    GeometricSpeed speed;
    for (int i = 0; i < nx_; ++i) {
      double row_squares = 0;
      double row_sum = 0;
      double squares = 0;
      double sum = 0;
      for (int j = 0; j < nx_; ++j) {
        row_squares += A(i, j)[0] * A(i, j)[0] + G(i, j)[0] * G(i, j)[0];
        row_sum += std::abs(A(i, j)[0]) + std::abs(G(i, j)[0]);
        squares += A(j, i)[0] * A(j, i)[0] + Q(j, i)[0] * Q(j, i)[0];
        sum += std::abs(A(j, i)[0]) + std::abs(Q(j, i)[0]);
      }
      speed.add(row_squares, row_sum);
      speed.add(squares, sum);
    }
    return speed.value();
  }
  /// A_ij ← d_i^left A_ij d_j^right, with left and right ±1.
  void scale_square(Square& A, int left, int right) const {
    for (int i = 0; i < nx_; ++i)
      for (int j = 0; j < nx_; ++j) A(i, j) *= all_lanes(scale_of(i, left) * scale_of(j, right));
  }
  void scale_panel(Panel& A, int left) const {
    for (int i = 0; i < nx_; ++i)
      for (int j = 0; j < m_; ++j) A(i, j) *= all_lanes(scale_of(i, left));
  }
  [[nodiscard]] double inverse_scale(int i) const { return scale_of(i, -1); }

  /// Computes out = a + b - c + q and its norm relative to the terms, which a(i, j), … return.
  template <class Terms>
  LaneResidual measure(const Terms& terms, Square& out) const {
    std::array<Lane, 5> scaled{};
    std::array<Lane, 5> original{};
    for (int i = 0; i < nx_; ++i)
      for (int j = 0; j < nx_; ++j) {
        const std::array<Lane, 4> four = terms(i, j);
        const Lane sum = (four[0] + four[1]) + (four[2] + four[3]);
        out(i, j) = sum;
        const Lane weight = all_lanes(inverse_scale(i) * inverse_scale(j));
        for (std::size_t t = 0; t < 5; ++t) {
          const Lane term = t < 4 ? four[t] : sum;
          const Lane weighted = term * weight;
          scaled[t] = multiply_add(term, term, scaled[t]);
          original[t] = multiply_add(weighted, weighted, original[t]);
        }
      }
    LaneResidual result;
    result.relative = relative(original);
    result.worst = larger(relative(scaled), result.relative);
    return result;
  }

 private:
  /// Rows and columns of a tile of a product that is accumulated in registers.
  static constexpr int T = kRegisters >= 32 ? 4 : 2;
  static constexpr int kMultiple = 4;
  static constexpr double kSmallestPivot = 1e-10;

  static int padded(int size) { return (size + kMultiple - 1) / kMultiple * kMultiple; }

  [[nodiscard]] double scale_of(int i, int power) const {
    return power > 0 ? scale_[static_cast<std::size_t>(i)]
                     : inverse_scale_[static_cast<std::size_t>(i)];
  }

  static Lane relative(const std::array<Lane, 5>& squares) {
    Lane terms = {};
    for (std::size_t t = 0; t < 4; ++t) terms += square_root(squares[t]);
    const Lane size = square_root(squares[4]);
    return size == Lane{} ? Lane{} : size / terms;
  }

  using LaneTile = Tile<Lane, T, T>;

  /// (i, j) → entry (i, j) of A, or of Aᵀ, relative to (row, column).
  template <bool kTranspose>
  [[gnu::always_inline]] static inline auto entries_from(const LaneMatrix& A, int row, int column) {
    const int stride = A.columns();
    return [M = &(kTranspose ? A(column, row) : A(row, column)), stride](int i, int j) {
      return kTranspose ? M[j * stride + i] : M[i * stride + j];
    };
  }

  /// The tile of A B, Aᵀ B or A Bᵀ at (i, j).
  template <bool kTransposeA, bool kTransposeB>
  [[gnu::always_inline]] static inline void sum_tile(const LaneMatrix& A, const LaneMatrix& B,
                                                     int i, int j, LaneTile& sum) {
    sum.add_product(0, kTransposeA ? A.rows() : A.columns(), entries_from<kTransposeA>(A, i, 0),
                    entries_from<kTransposeB>(B, 0, j));
  }

  /// C = A B, or C ← C - A B, of matrices that may be transposed.
  template <bool kTransposeA, bool kTransposeB, bool kSubtract = false>
  [[gnu::noinline]] static void product(const LaneMatrix& A, const LaneMatrix& B, LaneMatrix& C) {
    for (int i = 0; i < C.rows(); i += T)
      for (int j = 0; j < C.columns(); j += T) {
        LaneTile sum;
        sum_tile<kTransposeA, kTransposeB>(A, B, i, j, sum);
        sum.each([&](int r, int c, Lane x) {
          Lane& target = C(i + r, j + c);
          target = kSubtract ? target - x : x;
        });
      }
  }

  /// Squared norms of a change and of the changed matrix.
  struct Sizes {
    Lane change = {};
    Lane sum = {};
  };

  /// Adds a tile to S at (i, j), and its transpose at (j, i) if it is off the diagonal.
  template <bool kDiagonal>
  [[gnu::always_inline]] static inline void add_tile(LaneTile& tile, int i, int j, Square& S,
                                                     Sizes& sizes) {
    const Lane times = all_lanes(kDiagonal ? 1 : 2);
    tile.each([&](int r, int c, Lane x) {
      const Lane change = kDiagonal ? (x + tile.at[c][r]) * all_lanes(0.5) : x;
      const Lane sum = S(i + r, j + c) + change;
      S(i + r, j + c) = sum;
      if constexpr (!kDiagonal) S(j + c, i + r) = sum;
      sizes.change = multiply_add(change * times, change, sizes.change);
      sizes.sum = multiply_add(sum * times, sum, sizes.sum);
    });
  }

  /// Computes the tiles on and above the diagonal and mirrors them.
  template <bool kTransposeA, bool kTransposeB>
  [[gnu::noinline]] static std::pair<double, double> add_symmetric_product(const LaneMatrix& A,
                                                                           const LaneMatrix& B,
                                                                           LaneMatrix& S) {
    Sizes sizes;
    for (int i = 0; i < S.rows(); i += T) {
      LaneTile diagonal;
      sum_tile<kTransposeA, kTransposeB>(A, B, i, i, diagonal);
      add_tile<true>(diagonal, i, i, S, sizes);
      for (int j = i + T; j < S.columns(); j += T) {
        LaneTile tile;
        sum_tile<kTransposeA, kTransposeB>(A, B, i, j, tile);
        add_tile<false>(tile, i, j, S, sizes);
      }
    }
    const double share =
        std::sqrt(largest(sizes.sum == Lane{} ? sizes.change : sizes.change / sizes.sum));
    return {share, std::isfinite(largest(sizes.sum)) && std::isfinite(share)
                       ? 1.0
                       : std::numeric_limits<double>::quiet_NaN()};
  }

  /// L U of the tile at (k, k), given the tiles above and to its left.
  [[gnu::always_inline]] inline void factor_diagonal(int k, Lane& smallest) {
    LaneTile x = less_product(factor_, k, k, 0, k);
#pragma GCC unroll 4
    for (int p = 0; p < T; ++p) {
      const Lane size = abs_of(x.at[p][p]);
      smallest = size < smallest || size != size ? size : smallest;
      x.at[p][p] = 1 / x.at[p][p];
#pragma GCC unroll 4
      for (int r = p + 1; r < T; ++r) {
        x.at[r][p] *= x.at[p][p];
#pragma GCC unroll 4
        for (int c = p + 1; c < T; ++c)
          x.at[r][c] = subtract_product(x.at[r][p], x.at[p][c], x.at[r][c]);
      }
    }
    store_tile(x, k, k, factor_);
  }

  /// L of the tile at (i, k), below the diagonal, given the tiles above and to its left.
  [[gnu::always_inline]] inline void solve_right(int i, int k) {
    LaneTile x = less_product(factor_, i, k, 0, k);
#pragma GCC unroll 4
    for (int c = 0; c < T; ++c) {
#pragma GCC unroll 4
      for (int p = 0; p < c; ++p)
#pragma GCC unroll 4
        for (int r = 0; r < T; ++r)
          x.at[r][c] = subtract_product(x.at[r][p], factor_(k + p, k + c), x.at[r][c]);
#pragma GCC unroll 4
      for (int r = 0; r < T; ++r) x.at[r][c] *= factor_(k + c, k + c);
    }
    store_tile(x, i, k, factor_);
  }

  /// L⁻¹ X of the tile at (i, j), given the rows above.
  [[gnu::always_inline]] inline void solve_lower(Square& X, int i, int j) const {
    LaneTile x = less_product(X, i, j, 0, i);
    x.solve_unit_lower(entries_from<false>(factor_, i, i));
    store_tile(x, i, j, X);
  }

  /// U⁻¹ X of the tile at (i, j), given the rows below.
  [[gnu::always_inline]] inline void solve_upper(Square& X, int i, int j) const {
    LaneTile x = less_product(X, i, j, i + T, n_);
    const auto u = entries_from<false>(factor_, i, i);
#pragma GCC unroll 4
    for (int r = T - 1; r >= 0; --r) {
#pragma GCC unroll 4
      for (int q = r + 1; q < T; ++q) x.subtract_row(r, q, u(r, q));
      x.multiply_row(r, u(r, r));
    }
    store_tile(x, i, j, X);
  }

  /// The tile of X at (i, j) minus the product of row i of the factors and column j of X over the
  /// inner indices [first, last).
  [[gnu::always_inline]] inline LaneTile less_product(const Square& X, int i, int j, int first,
                                                      int last) const {
    LaneTile x;
    x.set(entries_from<false>(X, i, j));
    x.subtract_product_of(first, last, entries_from<false>(factor_, i, 0),
                          entries_from<false>(X, 0, j));
    return x;
  }
  [[gnu::always_inline]] static inline void store_tile(LaneTile& x, int i, int j, Square& X) {
    x.each([&](int r, int c, Lane from) { X(i + r, j + c) = from; });
  }

  int nx_;
  int nu_;
  int n_;  ///< states, padded
  int m_;  ///< inputs, padded
  std::vector<double> scale_;
  std::vector<double> inverse_scale_;
  Square factor_;
  Panel small_;
  std::vector<double> rows_, lane_columns_, lane_G_, lane_Q_;  ///< of the first lane, for balance()
};

}  // namespace quadtune::internal
