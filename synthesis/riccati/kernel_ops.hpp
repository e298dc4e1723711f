// SPDX-License-Identifier: Apache-2.0
/// The arithmetic of riccati_doubling.hpp by the kernels of dense_kernels.hpp. Matrices are stored
/// row by row and padded with decoupled stable states to the size that the kernels require.
#pragma once

#include <Eigen/Core>
#include <array>
#include <cmath>
#include <utility>
#include <vector>

#include "quadtune/internal/small_matrix.hpp"
#include "riccati/dense_kernels.hpp"
#include "riccati/riccati_scaling.hpp"

namespace quadtune::internal {

/// @tparam Real  double, or float for approximations
template <int kSize, class Real = double>
class KernelOps {
  using K = Kernels<kSize, Real>;
  using V = typename K::V;
  static constexpr int W = K::W;

 public:
  using Square = VectorStorage<V, kSize * kSize / W>;
  using Panel = Square;  ///< (nx × nu), nu ≤ n, and small (nu × nu) matrices alike

  /// The size to which nx states and nu inputs are padded.
  static int padded(Eigen::Index nx, Eigen::Index nu) {
    return kSize > 0 ? kSize
                     : static_cast<int>((std::max(nx, nu) + K::kMultiple - 1) / K::kMultiple) *
                           K::kMultiple;
  }

  KernelOps(Eigen::Index nx, Eigen::Index nu)
      : nx_(static_cast<int>(nx)),
        nu_(static_cast<int>(nu)),
        k_(padded(nx, nu)),
        pivots_(static_cast<std::size_t>(k_.n())),
        scale_(k_.stride() / W),
        inverse_scale_(k_.stride() / W) {}

  [[nodiscard]] int size() const { return nx_; }
  [[nodiscard]] Square square() const { return Square(k_.n() * k_.stride() / W); }
  [[nodiscard]] Panel panel() const { return square(); }
  [[nodiscard]] Panel small() const { return square(); }

  template <class M>
  void load_square(const M& from, Square& to) const {
    load_matrix(from, nx_, nx_, to);
  }
  template <class M>
  void load_panel(const M& from, Panel& to) const {
    load_matrix(from, nx_, nu_, to);
  }
  template <class M>
  void load_small(const M& from, Panel& to) const {
    load_matrix(from, nu_, nu_, to);
  }

  /// Computes L⁻¹, where L is the lower triangle of `factor`.
  void invert_factor(const Eigen::MatrixXd& factor, Panel& inverse) const {
    invert_lower(nu_, factor, entries(inverse));
  }

  /// Computes the inverse of the Cholesky factor of S = R + BᵀXB. False if S is not positive
  /// definite.
  bool invert_inner(const Panel& R, const Panel& B, const Panel& XB, Panel& inverse) {
    k_.template multiply<true>(B.data(), XB.data(), scratch_.data(), nx_);
    const auto S = entries(scratch_);
    for (int j = 0; j < nu_; ++j)
      for (int i = j; i < nu_; ++i) S(i, j) += R[i * s() + j];
    const auto is_positive = [](double pivot, double entry) { return pivot > 1e-14 * entry; };
    if (!factor_cholesky(nu_, S, is_positive)) return false;
    invert_lower(nu_, S, entries(inverse));
    return true;
  }

  // Products. A panel has few columns; a small matrix multiplies one from the right.
  /// C = A B.
  void multiply(const Square& A, const Square& B, Square& C) const {
    k_.template multiply<false>(A.data(), B.data(), C.data());
  }
  /// C = Aᵀ B.
  void multiply_tn(const Square& A, const Square& B, Square& C) const {
    k_.template multiply<true>(A.data(), B.data(), C.data());
  }
  /// C = Aᵀ B, known to be symmetric.
  void multiply_tn_symmetric(const Square& A, const Square& B, Square& C) const {
    k_.template multiply_symmetric<true>(A.data(), B.data(), C.data(), k_.n());
  }
  /// C = A B, B a panel.
  void multiply_panel(const Square& A, const Panel& B, Panel& C) const {
    k_.template multiply_panel<false>(A.data(), B.data(), C.data(), k_.n(), panel_columns());
  }
  /// C = Aᵀ B, B a panel.
  void multiply_panel_tn(const Square& A, const Panel& B, Panel& C) const {
    k_.template multiply_panel<true>(A.data(), B.data(), C.data(), k_.n(), panel_columns());
  }
  /// C = A S, S small.
  void multiply_small(const Panel& A, const Panel& S, Panel& C) const {
    k_.template multiply_panel<false>(A.data(), S.data(), C.data(), nu_, panel_columns());
  }
  /// C = A Sᵀ, S small.
  void multiply_small_nt(const Panel& A, const Panel& S, Panel& C) {
    transpose(S, scratch_);
    multiply_small(A, scratch_, C);
  }
  /// C = A Bᵀ of two panels.
  void multiply_nt(const Panel& A, const Panel& B, Square& C) {
    transpose(B, scratch_);
    k_.template multiply<false>(A.data(), scratch_.data(), C.data(), nu_);
  }
  /// C = A Aᵀ of a panel.
  void multiply_nt(const Panel& A, Square& C) {
    transpose(A, scratch_);
    k_.template multiply_symmetric<false>(A.data(), scratch_.data(), C.data(), nu_);
  }

  /// Factors A for solve(). False if A is singular or not finite.
  bool factor(const Square& A) {
    transpose(A, factor_);
    return k_.factor(factor_.data(), pivots_.data());
  }
  /// X ← A⁻¹ X with the A of the last factor().
  void solve(Square& X) const { k_.solve(factor_.data(), pivots_.data(), X.data()); }

  void transpose(const Square& A, Square& T) const { k_.transpose(A.data(), T.data()); }
  void set_identity(Square& A) const {
    A = 0;
    add_diagonal(A, 1);
  }
  void add_diagonal(Square& A, Real value) const {
    for (int i = 0; i < k_.n(); ++i) A.data()[i * s() + i] += value;
  }
  /// Sets the diagonal of the states that are only padding.
  void set_padding(Square& A, Real value) const {
    for (int i = nx_; i < k_.n(); ++i) A.data()[i * s() + i] = value;
  }
  /// S = factor · (M + Mᵀ)/2.
  void scaled_symmetric(const Square& M, Real factor, Square& S) {
    transpose(M, scratch_);
    const V f = broadcast<V>(Real(0.5) * factor);
    S.assign([&](int i) { return (M.begin()[i] + scratch_.begin()[i]) * f; });
  }
  /// S ← S + (M + Mᵀ)/2; returns the norms of the change and of the sum.
  std::pair<double, double> add_symmetric(const Square& M, Square& S) {
    transpose(M, scratch_);
    const V half = broadcast<V>(0.5);
    return add_measured(S, [&](int i) { return (M.begin()[i] + scratch_.begin()[i]) * half; });
  }

  /// S ← S + AᵀB, the product known to be symmetric; returns as add_symmetric().
  std::pair<double, double> add_product_tn(const Square& A, const Square& B, Square& S) {
    multiply_tn_symmetric(A, B, product_);
    return add_product(S);
  }
  /// S ← S + A Bᵀ, the product known to be symmetric.
  void add_product_nt(const Square& A, const Square& B, Square& S) {
    transpose(B, scratch_);
    k_.template multiply_symmetric<false>(A.data(), scratch_.data(), product_.data(), k_.n());
    add_product(S);
  }

  // Norms and residuals.
  [[nodiscard]] double norm1(const Square& A) const {
    Real largest = 0;
    for (int j = 0; j < row(); ++j) {
      V sums = {};
      for (int i = 0; i < k_.n(); ++i) sums += abs_of(at(A, i, j));
      for (int lane = 0; lane < W; ++lane) largest = std::max(largest, sums[lane]);
    }
    return largest;
  }
  [[nodiscard]] double norm_frobenius(const Square& A) const {
    V sum = {};
    for (int i = 0; i < A.size(); ++i) sum = multiply_add(A.begin()[i], A.begin()[i], sum);
    return std::sqrt(total(sum));
  }
  /// Norm of D⁻¹ M D⁻¹ for an M in scaled states, i.e. the norm of a solution in the caller's
  /// units.
  [[nodiscard]] double weighted_norm(const Square& M) const {
    V sum = {};
    for (int i = 0; i < k_.n(); ++i)
      for (int j = 0; j < row(); ++j) {
        const V m = at(M, i, j) * broadcast<V>(inverse_scale_[i]) * inverse_scale_.begin()[j];
        sum = multiply_add(m, m, sum);
      }
    return std::sqrt(total(sum));
  }
  /// γ of the Cayley transform.
  [[nodiscard]] double speed(const Square& A, const Square& G, const Square& Q) const {
    GeometricSpeed speed;
    for (int i = 0; i < nx_; i += W) {
      V squares = {};
      V sums = {};
      for (int k = 0; k < nx_; ++k) add_sizes(at(A, k, i / W), at(Q, k, i / W), squares, sums);
      for (int lane = 0; lane < std::min(W, nx_ - i); ++lane) {
        V row_squares = {};
        V row_sums = {};
        for (int j = 0; j < row(); ++j)
          add_sizes(at(A, i + lane, j), at(G, i + lane, j), row_squares, row_sums);
        speed.add(total(row_squares), total(row_sums));
        speed.add(squares[lane], sums[lane]);
      }
    }
    return speed.value();
  }

  /// AᵀX + (AᵀX)ᵀ - U + Q, given T = AᵀX.
  Residual residual_continuous(const Square& T, const Square& U, const Square& Q, Square& out) {
    transpose(T, scratch_);
    return measure(T, scratch_, 1, U, Q, out);
  }
  /// T - X - U + Q, given T = AᵀXA.
  Residual residual_discrete(const Square& T, const Square& X, const Square& U, const Square& Q,
                             Square& out) {
    return measure(T, X, -1, U, Q, out);
  }

  /// Writes factor · M for an M of other kernels. The padding is not copied.
  template <class OtherOps>
  void convert(const OtherOps& other, const typename OtherOps::Square& M, double factor,
               Square& to) const {
    to = 0;
    for (int i = 0; i < nx_; ++i)
      for (int j = 0; j < nx_; ++j)
        to.data()[i * s() + j] = static_cast<Real>(factor * M[i * other.stride() + j]);
  }
  [[nodiscard]] int stride() const { return k_.stride(); }

  // Scaling of the states.
  void balance(const Square& A, const Square& G, const Square& Q) {
    scratch_.assign([&](int i) { return abs_of(A.begin()[i]); });
    factor_.assign([&](int i) { return abs_of(G.begin()[i]); });
    absolute_.assign([&](int i) { return abs_of(Q.begin()[i]); });
    transpose(scratch_, columns_);
    const auto dot = [this](const double* a, const double* b) {
      V sum = {};
      for (int j = 0; j < s(); j += W) sum = multiply_add(load<V>(a + j), load<V>(b + j), sum);
      return total(sum);
    };
    level_scales(scratch_.data(), columns_.data(), factor_.data(), absolute_.data(), k_.n(), s(),
                 scale_.data(), inverse_scale_.data(), dot);
  }
  /// Largest scale over smallest.
  [[nodiscard]] double scale_spread() const {
    const auto [low, high] = std::minmax_element(scale_.data(), scale_.data() + nx_);
    return *high / *low;
  }
  /// A_ij ← d_i^left A_ij d_j^right, with left and right ±1.
  void scale_square(Square& A, int left, int right) const {
    const auto& rows = left > 0 ? scale_ : inverse_scale_;
    const auto& columns = right > 0 ? scale_ : inverse_scale_;
    for (int i = 0; i < k_.n(); ++i)
      for (int j = 0; j < row(); ++j)
        at(A, i, j) = at(A, i, j) * broadcast<V>(rows[i]) * columns.begin()[j];
  }
  /// A_ij ← d_i^left A_ij
  void scale_panel(Panel& A, int left) const {
    const auto& rows = left > 0 ? scale_ : inverse_scale_;
    for (int i = 0; i < k_.n(); ++i)
      for (int j = 0; j < row(); ++j) at(A, i, j) *= broadcast<V>(rows[i]);
  }
  /// S = D², without the padding.
  void set_squared_scales(Square& S) const {
    S = 0;
    for (int i = 0; i < nx_; ++i) S.data()[i * s() + i] = scale_[i] * scale_[i];
  }
  /// T = D⁻² X.
  void divide_rows_twice(const Square& X, Square& T) const {
    for (int i = 0; i < k_.n(); ++i) {
      const V weight = broadcast<V>(inverse_scale_[i] * inverse_scale_[i]);
      for (int j = 0; j < row(); ++j) at(T, i, j) = at(X, i, j) * weight;
    }
  }
  /// X = D⁻¹ X_z D⁻¹, K = K_z D⁻¹.
  void store_solution(const Square& X, const Panel& Kt, Eigen::MatrixXd& to_X,
                      Eigen::MatrixXd& to_K) const {
    to_X.resize(nx_, nx_);
    to_K.resize(nu_, nx_);
    for (int i = 0; i < nx_; ++i)
      for (int j = 0; j < nx_; ++j)
        to_X(j, i) = X[i * s() + j] * (inverse_scale_[i] * inverse_scale_[j]);
    for (int i = 0; i < nx_; ++i)
      for (int j = 0; j < nu_; ++j) to_K(j, i) = Kt[i * s() + j] * inverse_scale_[i];
  }

 private:
  [[nodiscard]] int s() const { return k_.stride(); }
  /// Vectors of one row.
  [[nodiscard]] int row() const { return s() / W; }
  [[nodiscard]] int panel_columns() const {
    return (nu_ + K::kMultiple - 1) / K::kMultiple * K::kMultiple;
  }
  /// Vector j of row i.
  V& at(Square& A, int i, int j) const { return A.begin()[i * row() + j]; }
  const V& at(const Square& A, int i, int j) const { return A.begin()[i * row() + j]; }
  /// (i, j) → entry (i, j).
  auto entries(Square& A) const {
    return [M = A.data(), stride = s()](int i, int j) -> Real& { return M[i * stride + j]; };
  }

  static void add_sizes(V a, V b, V& squares, V& sums) {
    squares = multiply_add(a, a, multiply_add(b, b, squares));
    sums += abs_of(a) + abs_of(b);
  }

  template <class M>
  void load_matrix(const M& from, int rows, int cols, Square& to) const {
    to = 0;
    const double* p = from.data();
    const Eigen::Index stride = from.outerStride();
    for (int j = 0; j < cols; ++j)
      for (int i = 0; i < rows; ++i) to.data()[i * s() + j] = p[j * stride + i];
  }

  /// S ← S + product_. If the kernels computed only one triangle, product_ is already symmetric.
  std::pair<double, double> add_product(Square& S) {
    if constexpr (kSize > 0) return add_symmetric(product_, S);
    return add_measured(S, [&](int i) { return product_.begin()[i]; });
  }
  template <class Change>
  std::pair<double, double> add_measured(Square& S, const Change& change_at) const {
    V changes = {};
    V sizes = {};
    for (int i = 0; i < S.size(); ++i) {
      const V change = change_at(i);
      const V sum = S.begin()[i] + change;
      S.begin()[i] = sum;
      changes = multiply_add(change, change, changes);
      sizes = multiply_add(sum, sum, sizes);
    }
    return {std::sqrt(total(changes)), std::sqrt(total(sizes))};
  }

  /// Computes out = T + sign · M - U + Q, and its norm relative to these four terms.
  Residual measure(const Square& T, const Square& M, Real sign, const Square& U, const Square& Q,
                   Square& out) const {
    V scaled[5] = {};
    V original[5] = {};
    for (int i = 0; i < k_.n(); ++i)
      for (int j = 0; j < row(); ++j) {
        V term[5] = {at(T, i, j), at(M, i, j) * broadcast<V>(sign), -at(U, i, j), at(Q, i, j)};
        term[4] = (term[0] + term[1]) + (term[2] + term[3]);
        at(out, i, j) = term[4];
        const V weight = broadcast<V>(inverse_scale_[i]) * inverse_scale_.begin()[j];
#pragma GCC unroll 5
        for (int t = 0; t < 5; ++t) {
          scaled[t] = multiply_add(term[t], term[t], scaled[t]);
          const V weighted = term[t] * weight;
          original[t] = multiply_add(weighted, weighted, original[t]);
        }
      }
    Residual result;
    std::array<double, 4> scaled_terms;
    for (std::size_t t = 0; t < 4; ++t) {
      result.squared_terms[t] = total(original[t]);
      scaled_terms[t] = total(scaled[t]);
    }
    result.squared = total(original[4]);
    result.relative = relative_size(result.squared, result.squared_terms);
    result.relative_scaled = relative_size(total(scaled[4]), scaled_terms);
    return result;
  }

  int nx_;
  int nu_;
  K k_;
  std::vector<int> pivots_;
  VectorStorage<V, kSize / W> scale_;
  VectorStorage<V, kSize / W> inverse_scale_;
  Square scratch_ = square();
  Square product_ = square();
  Square factor_ = square();
  Square absolute_ = square();
  Square columns_ = square();
};

}  // namespace quadtune::internal
