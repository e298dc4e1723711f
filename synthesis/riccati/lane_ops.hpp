// SPDX-License-Identifier: Apache-2.0
/// The arithmetic of doubling_steps.hpp for several problems at once: every number is a vector with
/// one entry, or lane, for each problem (structure of arrays), so that no shuffle and no broadcast
/// is needed and a transpose costs nothing. No pivoting: lanes would have to pivot alike.
#pragma once

#include <Eigen/Core>
#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <utility>
#include <vector>

#include "riccati/dense_kernels.hpp"
#include "riccati/kernel_storage.hpp"
#include "riccati/riccati_scaling.hpp"

namespace quadtune::internal {

/// One number of each problem: as many as a register holds.
#if defined(__AVX512F__)
inline constexpr int kLaneCount = 8;
#elif defined(__AVX__)
inline constexpr int kLaneCount = 4;
#else
inline constexpr int kLaneCount = 2;
#endif
using Lane = VectorOf<double, kLaneCount>::type;

inline Lane all_lanes(double x) { return x - Lane{}; }
inline Lane magnitude(Lane v) { return v < Lane{} ? -v : v; }
inline Lane larger(Lane a, Lane b) { return a > b ? a : b; }
inline Lane square_root(Lane v) {
#if defined(__AVX512F__)
  return _mm512_sqrt_pd(v);
#elif defined(__FMA__)
  return _mm256_sqrt_pd(v);
#else
  for (int lane = 0; lane < kLaneCount; ++lane) v[lane] = std::sqrt(v[lane]);
  return v;
#endif
}
/// The largest of all lanes; NaN if one is NaN.
inline double largest(Lane v) {
  double result = v[0];
  for (int lane = 1; lane < kLaneCount; ++lane)
    if (!std::isnan(result) && !(v[lane] <= result)) result = v[lane];
  return result;
}

/// A matrix of lanes, row by row.
class LaneMatrix {
 public:
  LaneMatrix(int rows, int columns)
      : rows_(rows), columns_(columns), values_(rows, columns * kLaneCount) {}

  [[nodiscard]] int rows() const { return rows_; }
  [[nodiscard]] int columns() const { return columns_; }
  [[nodiscard]] int entries() const { return rows_ * columns_; }
  [[nodiscard]] Lane* data() { return reinterpret_cast<Lane*>(values_.data()); }
  [[nodiscard]] const Lane* data() const { return reinterpret_cast<const Lane*>(values_.data()); }
  [[nodiscard]] Lane& operator()(int i, int j) { return data()[i * columns_ + j]; }
  [[nodiscard]] const Lane& operator()(int i, int j) const { return data()[i * columns_ + j]; }

 private:
  int rows_;
  int columns_;
  KernelStorage<0, 0, double> values_;
};

/// Residuals of all lanes, relative to the sum of the norms of the terms: in the callers' units and
/// the worse of that and of the scaled one.
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

  /// Writes a problem's matrix into one lane; the padding stays 0.
  static void load(const Eigen::MatrixXd& from, int lane, LaneMatrix& to) {
    double* target = reinterpret_cast<double*>(to.data()) + lane;
    const int stride = to.columns() * kLaneCount;
    for (int j = 0; j < from.cols(); ++j)
      for (int i = 0; i < from.rows(); ++i) target[i * stride + j * kLaneCount] = from(i, j);
  }

  // Products. Rows and columns are multiples of kMultiple; what a product writes, it does not read.
  void multiply(const LaneMatrix& A, const LaneMatrix& B, LaneMatrix& C) const {
    product<false, false, Store::set>(A, B, C);
  }
  void multiply_transposed(const LaneMatrix& A, const LaneMatrix& B, LaneMatrix& C) const {
    product<true, false, Store::set>(A, B, C);
  }
  /// C = A Bᵀ.
  void outer(const LaneMatrix& A, const LaneMatrix& B, LaneMatrix& C) const {
    product<false, true, Store::set>(A, B, C);
  }
  /// C ← C - A Bᵀ.
  void subtract_outer(const LaneMatrix& A, const LaneMatrix& B, LaneMatrix& C) const {
    product<false, true, Store::subtract>(A, B, C);
  }
  /// S ← S + AᵀB, the product known to be symmetric; returns the largest share of any lane's sum
  /// that the change is, and 1, or NaN for numbers that are not finite.
  std::pair<double, double> add_product_tn(const Square& A, const Square& B, Square& S) const {
    return add_symmetric_product<true, false>(A, B, S);
  }
  /// S ← S + A Bᵀ, likewise.
  void add_product_nt(const Square& A, const Square& B, Square& S) const {
    add_symmetric_product<false, true>(A, B, S);
  }

  /// Factors A = L U for solve(), T columns at a time; false when a pivot of some lane is 0 or not
  /// finite. The diagonal of U is left inverted.
  bool factor(const Square& A) {
    copy(A, factor_);
    Lane least = all_lanes(std::numeric_limits<double>::infinity());
    for (int k = 0; k < n_; k += T) {
      factor_diagonal(k, least);
      for (int j = k + T; j < n_; j += T) solve_right_of(k, j);
      for (int i = k + T; i < n_; i += T) solve_below(k, i);
      for (int i = k + T; i < n_; i += T)
        for (int j = k + T; j < n_; j += T) {
          Tile x;
          load_tile(factor_, i, j, x);
          subtract_terms(factor_, i, j, k, k + T, x);
          store_tile(x, i, j, factor_);
        }
    }
    for (int lane = 0; lane < kLaneCount; ++lane)
      if (!(least[lane] > 0) || !std::isfinite(least[lane])) return false;
    return true;
  }

  /// X ← A⁻¹ X.
  void solve(Square& X) const {
    for (int j = 0; j < X.columns(); j += T) {
      for (int i = 0; i < n_; i += T) solve_lower(X, i, j);
      for (int i = n_ - T; i >= 0; i -= T) solve_upper(X, i, j);
    }
  }

  /// L⁻¹ of the Cholesky factor of the small S, lane by lane as one; false where some lane's S is
  /// not positive beyond rounding.
  bool invert_cholesky(const Panel& S, Panel& inverse) {
    Panel& L = small_;
    copy(S, L);
    bool positive = true;
    for (int j = 0; j < nu_; ++j) {
      const Lane before = L(j, j);
      for (int k = 0; k < j; ++k) L(j, j) -= L(j, k) * L(j, k);
      const Lane pivot = L(j, j);
      for (int lane = 0; lane < kLaneCount; ++lane)
        positive = positive && pivot[lane] > kLeastPivot * before[lane];
      L(j, j) = square_root(pivot);
      for (int i = j + 1; i < nu_; ++i) {
        for (int k = 0; k < j; ++k) L(i, j) -= L(i, k) * L(j, k);
        L(i, j) /= L(j, j);
      }
    }
    fill(inverse, 0);
    for (int j = 0; j < nu_; ++j) {
      inverse(j, j) = 1 / L(j, j);
      for (int i = j + 1; i < nu_; ++i) {
        Lane sum = {};
        for (int k = j; k < i; ++k) sum -= L(i, k) * inverse(k, j);
        inverse(i, j) = sum / L(i, i);
      }
    }
    return positive;
  }

  // Entry by entry.
  static void fill(LaneMatrix& A, double value) {
    std::fill_n(A.data(), A.entries(), all_lanes(value));
  }
  static void copy(const LaneMatrix& from, LaneMatrix& to) {
    std::copy_n(from.data(), from.entries(), to.data());
  }
  static void swap(LaneMatrix& a, LaneMatrix& b) { std::swap(a, b); }
  static void transpose(const Square& A, Square& to) {
    for (int i = 0; i < A.rows(); ++i)
      for (int j = 0; j < A.columns(); ++j) to(j, i) = A(i, j);
  }
  static void add(LaneMatrix& A, const LaneMatrix& B) {
    for (int i = 0; i < A.entries(); ++i) A.data()[i] += B.data()[i];
  }
  static void multiply_by(LaneMatrix& A, double factor) {
    for (int i = 0; i < A.entries(); ++i) A.data()[i] *= all_lanes(factor);
  }
  void identity(Square& A) const {
    fill(A, 0);
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
  /// The largest of any lane.
  [[nodiscard]] static double norm1(const Square& A) {
    Lane most = {};
    for (int j = 0; j < A.columns(); ++j) {
      Lane sum = {};
      for (int i = 0; i < A.rows(); ++i) sum += magnitude(A(i, j));
      most = larger(sum, most);
    }
    return largest(most);
  }
  [[nodiscard]] static Lane squared_norm(const LaneMatrix& A) {
    Lane sum = {};
    for (int i = 0; i < A.entries(); ++i) sum = multiply_add(A.data()[i], A.data()[i], sum);
    return sum;
  }

  // Scaling of the states, by the first lane: the others' are alike.
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

  /// out = a + b - c + q, measured against its terms, where a(i, j), … give the terms.
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
  enum class Store { set, subtract };

  /// Rows and columns of a product that are summed in registers together.
  static constexpr int T = kRegisters >= 32 ? 4 : 2;
  static constexpr int kMultiple = 4;
  static constexpr double kLeastPivot = 1e-10;

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

  using Tile = Lane[T][T];

  /// Sums the T × T tile of A B, Aᵀ B or A Bᵀ at (i, j) over all inner terms.
  template <bool kTransposeA, bool kTransposeB>
  [[gnu::always_inline]] static inline void sum_tile(const LaneMatrix& A, const LaneMatrix& B,
                                                     int i, int j, Tile& sum) {
    const int inner = kTransposeA ? A.rows() : A.columns();
    const int lda = A.columns();
    const int ldb = B.columns();
    const Lane* a = kTransposeA ? &A(0, i) : &A(i, 0);
    const Lane* b = kTransposeB ? &B(j, 0) : &B(0, j);
    for (int k = 0; k < inner; ++k) {
      Lane row[T];
#pragma GCC unroll 4
      for (int c = 0; c < T; ++c) row[c] = kTransposeB ? b[c * ldb + k] : b[k * ldb + c];
#pragma GCC unroll 4
      for (int r = 0; r < T; ++r) {
        const Lane entry = kTransposeA ? a[k * lda + r] : a[r * lda + k];
#pragma GCC unroll 4
        for (int c = 0; c < T; ++c) sum[r][c] = multiply_add(entry, row[c], sum[r][c]);
      }
    }
  }

  template <bool kTransposeA, bool kTransposeB, Store kStore>
  [[gnu::noinline]] static void product(const LaneMatrix& A, const LaneMatrix& B, LaneMatrix& C) {
    for (int i = 0; i < C.rows(); i += T)
      for (int j = 0; j < C.columns(); j += T) {
        Tile sum = {};
        sum_tile<kTransposeA, kTransposeB>(A, B, i, j, sum);
#pragma GCC unroll 4
        for (int r = 0; r < T; ++r)
#pragma GCC unroll 4
          for (int c = 0; c < T; ++c) {
            Lane& target = C(i + r, j + c);
            target = kStore == Store::set ? sum[r][c] : target - sum[r][c];
          }
      }
  }

  /// Squared norms of a change and of what it leads to.
  struct Sizes {
    Lane change = {};
    Lane sum = {};
  };

  /// Adds a tile to S at (i, j), and its mirror where it is off the diagonal.
  template <bool kDiagonal>
  [[gnu::always_inline]] static inline void add_tile(const Tile& tile, int i, int j, Square& S,
                                                     Sizes& sizes) {
    const Lane times = all_lanes(kDiagonal ? 1 : 2);
#pragma GCC unroll 4
    for (int r = 0; r < T; ++r)
#pragma GCC unroll 4
      for (int c = 0; c < T; ++c) {
        const Lane change = kDiagonal ? (tile[r][c] + tile[c][r]) * all_lanes(0.5) : tile[r][c];
        const Lane sum = S(i + r, j + c) + change;
        S(i + r, j + c) = sum;
        if constexpr (!kDiagonal) S(j + c, i + r) = sum;
        sizes.change = multiply_add(change * times, change, sizes.change);
        sizes.sum = multiply_add(sum * times, sum, sizes.sum);
      }
  }

  /// Computes the tiles on and above the diagonal and mirrors them.
  template <bool kTransposeA, bool kTransposeB>
  [[gnu::noinline]] static std::pair<double, double> add_symmetric_product(const LaneMatrix& A,
                                                                           const LaneMatrix& B,
                                                                           LaneMatrix& S) {
    Sizes sizes;
    for (int i = 0; i < S.rows(); i += T) {
      Tile diagonal = {};
      sum_tile<kTransposeA, kTransposeB>(A, B, i, i, diagonal);
      add_tile<true>(diagonal, i, i, S, sizes);
      for (int j = i + T; j < S.columns(); j += T) {
        Tile tile = {};
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

  /// L U of the T × T block at (k, k).
  [[gnu::always_inline]] inline void factor_diagonal(int k, Lane& least) {
    Tile x;
    load_tile(factor_, k, k, x);
#pragma GCC unroll 4
    for (int p = 0; p < T; ++p) {
      const Lane size = magnitude(x[p][p]);
      least = size < least || size != size ? size : least;
      x[p][p] = 1 / x[p][p];
#pragma GCC unroll 4
      for (int r = p + 1; r < T; ++r) {
        x[r][p] *= x[p][p];
#pragma GCC unroll 4
        for (int c = p + 1; c < T; ++c) x[r][c] = subtract_product(x[r][p], x[p][c], x[r][c]);
      }
    }
    store_tile(x, k, k, factor_);
  }

  /// L11⁻¹ of the block at (k, j).
  [[gnu::always_inline]] inline void solve_right_of(int k, int j) {
    Tile x;
    load_tile(factor_, k, j, x);
    forward(k, x);
    store_tile(x, k, j, factor_);
  }

  /// The block at (i, k) times U11⁻¹.
  [[gnu::always_inline]] inline void solve_below(int k, int i) {
    Tile x;
    load_tile(factor_, i, k, x);
#pragma GCC unroll 4
    for (int c = 0; c < T; ++c) {
#pragma GCC unroll 4
      for (int p = 0; p < c; ++p)
#pragma GCC unroll 4
        for (int r = 0; r < T; ++r)
          x[r][c] = subtract_product(x[r][p], factor_(k + p, k + c), x[r][c]);
#pragma GCC unroll 4
      for (int r = 0; r < T; ++r) x[r][c] *= factor_(k + c, k + c);
    }
    store_tile(x, i, k, factor_);
  }

  /// L11⁻¹ of a tile by the T × T block at (i, i).
  [[gnu::always_inline]] inline void forward(int i, Tile& x) const {
#pragma GCC unroll 4
    for (int r = 1; r < T; ++r)
#pragma GCC unroll 4
      for (int k = 0; k < r; ++k)
#pragma GCC unroll 4
        for (int c = 0; c < T; ++c)
          x[r][c] = subtract_product(factor_(i + r, i + k), x[k][c], x[r][c]);
  }

  /// L⁻¹ of the rows i … i + T - 1 of the columns j … j + T - 1, the rows above being done.
  [[gnu::always_inline]] inline void solve_lower(Square& X, int i, int j) const {
    Tile x;
    load_tile(X, i, j, x);
    subtract_terms(X, i, j, 0, i, x);
    forward(i, x);
    store_tile(x, i, j, X);
  }

  /// U⁻¹ likewise, the rows below being done.
  [[gnu::always_inline]] inline void solve_upper(Square& X, int i, int j) const {
    Tile x;
    load_tile(X, i, j, x);
    subtract_terms(X, i, j, i + T, n_, x);
#pragma GCC unroll 4
    for (int r = T - 1; r >= 0; --r) {
#pragma GCC unroll 4
      for (int k = r + 1; k < T; ++k)
#pragma GCC unroll 4
        for (int c = 0; c < T; ++c)
          x[r][c] = subtract_product(factor_(i + r, i + k), x[k][c], x[r][c]);
#pragma GCC unroll 4
      for (int c = 0; c < T; ++c) x[r][c] *= factor_(i + r, i + r);
    }
    store_tile(x, i, j, X);
  }

  [[gnu::always_inline]] inline void subtract_terms(const Square& X, int i, int j, int first,
                                                    int last, Tile& x) const {
    for (int k = first; k < last; ++k) {
      const Lane* row = &X(k, j);
#pragma GCC unroll 4
      for (int r = 0; r < T; ++r) {
        const Lane entry = factor_(i + r, k);
#pragma GCC unroll 4
        for (int c = 0; c < T; ++c) x[r][c] = subtract_product(entry, row[c], x[r][c]);
      }
    }
  }

  [[gnu::always_inline]] static inline void load_tile(const Square& X, int i, int j, Tile& x) {
#pragma GCC unroll 4
    for (int r = 0; r < T; ++r)
#pragma GCC unroll 4
      for (int c = 0; c < T; ++c) x[r][c] = X(i + r, j + c);
  }
  [[gnu::always_inline]] static inline void store_tile(const Tile& x, int i, int j, Square& X) {
#pragma GCC unroll 4
    for (int r = 0; r < T; ++r)
#pragma GCC unroll 4
      for (int c = 0; c < T; ++c) X(i + r, j + c) = x[r][c];
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
