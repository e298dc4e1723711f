// SPDX-License-Identifier: Apache-2.0
/// The arithmetic of riccati_doubling.hpp for up to N states, by the kernels of small_kernels.hpp.
/// Matrices are stored row by row and padded with decoupled stable states to N.
#pragma once

#include <Eigen/Core>
#include <array>
#include <cmath>
#include <memory>
#include <utility>

#include "riccati_scaling.hpp"
#include "small_kernels.hpp"

namespace quadtune::internal {

template <int N>
class FixedOps {
  using K = Kernels<N>;
  using V = typename K::V;
  static constexpr int W = K::W;

 public:
  struct alignas(64) Storage {
    std::array<double, static_cast<std::size_t>(N) * N> v{};
  };
  using Square = std::unique_ptr<Storage>;
  using Panel = Square;  ///< (nx × nu), nu ≤ N, and small (nu × nu) matrices alike

  FixedOps(Eigen::Index nx, Eigen::Index nu)
      : nx_(static_cast<int>(nx)), nu_(static_cast<int>(nu)) {}

  [[nodiscard]] int size() const { return nx_; }
  [[nodiscard]] Square square() const { return std::make_unique<Storage>(); }
  [[nodiscard]] Panel panel() const { return square(); }
  [[nodiscard]] Panel small() const { return square(); }

  template <class M>
  void load_square(const M& from, Square& to) const {
    load(from, nx_, nx_, to);
  }
  template <class M>
  void load_panel(const M& from, Panel& to) const {
    load(from, nx_, nu_, to);
  }
  template <class M>
  void load_small(const M& from, Panel& to) const {
    load(from, nu_, nu_, to);
  }

  /// L⁻¹ of the lower triangle of `factor`.
  void invert_factor(const Eigen::MatrixXd& factor, Panel& inverse) const {
    double* X = data(inverse);
    for (int j = 0; j < nu_; ++j) {
      for (int i = 0; i < j; ++i) X[i * N + j] = 0;
      X[j * N + j] = 1 / factor(j, j);
      for (int i = j + 1; i < nu_; ++i) {
        double sum = 0;
        for (int k = j; k < i; ++k) sum -= factor(i, k) * X[k * N + j];
        X[i * N + j] = sum / factor(i, i);
      }
    }
  }

  /// Inverse of the Cholesky factor of S = R + BᵀXB. False when S is not positive definite.
  bool invert_inner(const Panel& R, const Panel& B, const Panel& XB, Panel& inverse) {
    K::template multiply<true>(data(B), data(XB), data(scratch_), nx_);
    double* S = data(scratch_);
    for (int j = 0; j < nu_; ++j)
      for (int i = j; i < nu_; ++i) S[i * N + j] += data(R)[i * N + j];
    for (int j = 0; j < nu_; ++j) {
      const double before = S[j * N + j];
      for (int k = 0; k < j; ++k) S[j * N + j] -= S[j * N + k] * S[j * N + k];
      if (!(S[j * N + j] > 1e-14 * before)) return false;
      S[j * N + j] = std::sqrt(S[j * N + j]);
      for (int i = j + 1; i < nu_; ++i) {
        for (int k = 0; k < j; ++k) S[i * N + j] -= S[i * N + k] * S[j * N + k];
        S[i * N + j] /= S[j * N + j];
      }
    }
    double* X = data(inverse);
    for (int j = 0; j < nu_; ++j) {
      for (int i = 0; i < j; ++i) X[i * N + j] = 0;
      X[j * N + j] = 1 / S[j * N + j];
      for (int i = j + 1; i < nu_; ++i) {
        double sum = 0;
        for (int k = j; k < i; ++k) sum -= S[i * N + k] * X[k * N + j];
        X[i * N + j] = sum / S[i * N + i];
      }
    }
    return true;
  }

  // Products. `panel` is square times panel; `small` matrices multiply from the right.
  void multiply(const Square& A, const Square& B, Square& C) const {
    K::template multiply<false>(data(A), data(B), data(C));
  }
  void multiply_transposed(const Square& A, const Square& B, Square& C) const {
    K::template multiply<true>(data(A), data(B), data(C));
  }
  void panel(const Square& A, const Panel& B, Panel& C) const { multiply(A, B, C); }
  void panel_transposed(const Square& A, const Panel& B, Panel& C) const {
    multiply_transposed(A, B, C);
  }
  void times_small(const Panel& A, const Panel& S, Panel& C) const {
    K::template multiply<false>(data(A), data(S), data(C), nu_);
  }
  void times_small_transposed(const Panel& A, const Panel& S, Panel& C) {
    K::transpose(data(S), data(scratch_));
    K::template multiply<false>(data(A), data(scratch_), data(C), nu_);
  }
  /// C = A Bᵀ of two panels.
  void outer(const Panel& A, const Panel& B, Square& C) {
    K::transpose(data(B), data(scratch_));
    K::template multiply<false>(data(A), data(scratch_), data(C), nu_);
  }

  bool factor(Square& A) {
    K::transpose(data(A), data(factor_));
    return K::factor(data(factor_), pivots_.data());
  }
  void solve(Square& X) const { K::template solve<1>(data(factor_), pivots_.data(), {data(X)}); }
  void solve(Square& X, Square& Y) const {
    K::template solve<2>(data(factor_), pivots_.data(), {data(X), data(Y)});
  }

  // Entry by entry.
  void copy(const Square& from, Square& to) const { to->v = from->v; }
  void swap(Square& a, Square& b) const { std::swap(a, b); }
  void transpose(const Square& A, Square& T) const { K::transpose(data(A), data(T)); }
  void add(Square& A, const Square& B) const {
    for (int i = 0; i < N * N; i += W) K::store(at(A, i), K::load(at(A, i)) + K::load(at(B, i)));
  }
  void add_panel(Panel& A, const Panel& B) const { add(A, B); }
  void subtract(const Square& A, const Square& B, Square& C) const {
    for (int i = 0; i < N * N; i += W) K::store(at(C, i), K::load(at(A, i)) - K::load(at(B, i)));
  }
  void multiply_by(Square& A, double factor) const {
    const V f = K::broadcast(factor);
    for (int i = 0; i < N * N; i += W) K::store(at(A, i), K::load(at(A, i)) * f);
  }
  void identity(Square& A) const {
    A->v.fill(0);
    add_diagonal(A, 1);
  }
  void add_diagonal(Square& A, double value) const {
    for (int i = 0; i < N; ++i) A->v[i * N + i] += value;
  }
  /// Sets the diagonal of the states that are only padding.
  void set_padding(Square& A, double value) const {
    for (int i = nx_; i < N; ++i) A->v[i * N + i] = value;
  }
  /// S = factor · (M + Mᵀ)/2.
  void scaled_symmetric(const Square& M, double factor, Square& S) {
    K::transpose(data(M), data(scratch_));
    const V f = K::broadcast(0.5 * factor);
    for (int i = 0; i < N * N; i += W)
      K::store(at(S, i), (K::load(at(M, i)) + K::load(at(scratch_, i))) * f);
  }
  /// S ← S + (M + Mᵀ)/2; returns the norms of the change and of the sum.
  std::pair<double, double> add_symmetric(const Square& M, Square& S) {
    K::transpose(data(M), data(scratch_));
    const V half = K::broadcast(0.5);
    V changes = {};
    V sizes = {};
    for (int i = 0; i < N * N; i += W) {
      const V change = (K::load(at(M, i)) + K::load(at(scratch_, i))) * half;
      const V sum = K::load(at(S, i)) + change;
      K::store(at(S, i), sum);
      changes = multiply_add(change, change, changes);
      sizes = multiply_add(sum, sum, sizes);
    }
    return {std::sqrt(total(changes)), std::sqrt(total(sizes))};
  }

  // Norms and measures.
  [[nodiscard]] double norm1(const Square& A) const {
    V sums[K::kVectors] = {};
    for (int i = 0; i < N; ++i)
      for (int j = 0; j < K::kVectors; ++j) sums[j] += magnitude(K::load(at(A, i * N + j * W)));
    double largest = 0;
    for (int j = 0; j < N; ++j) largest = std::max(largest, sums[j / W][j % W]);
    return largest;
  }
  [[nodiscard]] double norm_frobenius(const Square& A) const {
    V sum = {};
    for (int i = 0; i < N * N; i += W)
      sum = multiply_add(K::load(at(A, i)), K::load(at(A, i)), sum);
    return std::sqrt(total(sum));
  }
  /// Norm of D⁻¹ M D⁻¹, M in scaled states: that of a solution in the caller's units.
  [[nodiscard]] double weighted_norm(const Square& M) const {
    V sum = {};
    for (int i = 0; i < N; ++i)
      for (int j = 0; j < N; j += W) {
        const V m = K::load(at(M, i * N + j)) * K::broadcast(inverse_scale_[i]) *
                    K::load(inverse_scale_.data() + j);
        sum = multiply_add(m, m, sum);
      }
    return std::sqrt(total(sum));
  }
  /// γ of the Cayley transform.
  [[nodiscard]] double speed(const Square& A, const Square& G, const Square& Q) const {
    alignas(64) std::array<double, N> rows;
    V columns[K::kVectors] = {};
    for (int i = 0; i < N; ++i) {
      V row = {};
      for (int j = 0; j < K::kVectors; ++j) {
        const V a = K::load(at(A, i * N + j * W));
        const V g = K::load(at(G, i * N + j * W));
        const V q = K::load(at(Q, i * N + j * W));
        row = multiply_add(a, a, multiply_add(g, g, row));
        columns[j] = multiply_add(a, a, multiply_add(q, q, columns[j]));
      }
      rows[i] = total(row);
    }
    GeometricSpeed speed;
    for (int i = 0; i < nx_; ++i) speed.add(rows[i], columns[i / W][i % W]);
    return speed.value();
  }

  /// AᵀX + (AᵀX)ᵀ - U + Q, given T = AᵀX.
  Residual residual_continuous(const Square& T, const Square& U, const Square& Q, Square& out) {
    K::transpose(data(T), data(scratch_));
    return measure(out, [&](int i, V* term) {
      term[0] = K::load(at(T, i));
      term[1] = K::load(at(scratch_, i));
      term[2] = -K::load(at(U, i));
      term[3] = K::load(at(Q, i));
    });
  }
  /// T - X - U + Q, given T = AᵀXA.
  Residual residual_discrete(const Square& T, const Square& X, const Square& U, const Square& Q,
                             Square& out) {
    return measure(out, [&](int i, V* term) {
      term[0] = K::load(at(T, i));
      term[1] = -K::load(at(X, i));
      term[2] = -K::load(at(U, i));
      term[3] = K::load(at(Q, i));
    });
  }

  // Scaling of the states.
  void balance(const Square& A, const Square& G, const Square& Q) {
    for (int i = 0; i < N * N; i += W) {
      K::store(at(scratch_, i), magnitude(K::load(at(A, i))));
      K::store(at(factor_, i), magnitude(K::load(at(G, i))));
      K::store(at(absolute_, i), magnitude(K::load(at(Q, i))));
    }
    K::transpose(data(scratch_), data(columns_));
    const auto dot = [](const double* a, const double* b) {
      V sum = {};
      for (int j = 0; j < N; j += W) sum = multiply_add(K::load(a + j), K::load(b + j), sum);
      return total(sum);
    };
    level_scales(data(scratch_), data(columns_), data(factor_), data(absolute_), N, N,
                 scale_.data(), inverse_scale_.data(), dot);
  }
  /// A_ij ← d_i^left A_ij d_j^right, with left and right ±1.
  void scale_square(Square& A, int left, int right) const {
    const auto& rows = left > 0 ? scale_ : inverse_scale_;
    const auto& columns = right > 0 ? scale_ : inverse_scale_;
    for (int i = 0; i < N; ++i) {
      const V r = K::broadcast(rows[i]);
      for (int j = 0; j < N; j += W)
        K::store(at(A, i * N + j), K::load(at(A, i * N + j)) * r * K::load(columns.data() + j));
    }
  }
  /// S = D², without the padding.
  void squared_scales(Square& S) const {
    S->v.fill(0);
    for (int i = 0; i < nx_; ++i) S->v[i * N + i] = scale_[i] * scale_[i];
  }
  /// T = D⁻² X.
  void divide_rows_twice(const Square& X, Square& T) const {
    for (int i = 0; i < N; ++i) {
      const V weight = K::broadcast(inverse_scale_[i] * inverse_scale_[i]);
      for (int j = 0; j < N; j += W) K::store(at(T, i * N + j), K::load(at(X, i * N + j)) * weight);
    }
  }
  void scale_panel(Panel& A, int left) const {
    const auto& rows = left > 0 ? scale_ : inverse_scale_;
    for (int i = 0; i < N; ++i)
      for (int j = 0; j < N; j += W)
        K::store(at(A, i * N + j), K::load(at(A, i * N + j)) * K::broadcast(rows[i]));
  }
  /// X = D⁻¹ X_z D⁻¹, K = K_z D⁻¹.
  void store_solution(const Square& X, const Panel& Kt, Eigen::MatrixXd& to_X,
                      Eigen::MatrixXd& to_K) const {
    to_X.resize(nx_, nx_);
    to_K.resize(nu_, nx_);
    for (int i = 0; i < nx_; ++i)
      for (int j = 0; j < nx_; ++j)
        to_X(j, i) = X->v[i * N + j] * (inverse_scale_[i] * inverse_scale_[j]);
    for (int i = 0; i < nx_; ++i)
      for (int j = 0; j < nu_; ++j) to_K(j, i) = Kt->v[i * N + j] * inverse_scale_[i];
  }

 private:
  static double* data(const Square& A) { return A->v.data(); }
  static double* at(const Square& A, int i) { return A->v.data() + i; }
  static V magnitude(V v) { return v < V{} ? -v : v; }
  static double total(V v) {
    double sum = 0;
    for (int i = 0; i < W; ++i) sum += v[i];
    return sum;
  }

  template <class M>
  void load(const M& from, int rows, int cols, Square& to) const {
    to->v.fill(0);
    const double* p = from.data();
    const Eigen::Index stride = from.outerStride();
    for (int j = 0; j < cols; ++j)
      for (int i = 0; i < rows; ++i) to->v[i * N + j] = p[j * stride + i];
  }

  /// Sums four terms into `out`; measures the sum against them.
  template <class Terms>
  Residual measure(Square& out, const Terms& terms) const {
    V scaled[5] = {};
    V original[5] = {};
    for (int i = 0; i < N; ++i) {
      const V row = K::broadcast(inverse_scale_[i]);
      for (int j = 0; j < N; j += W) {
        V term[5];
        terms(i * N + j, term);
        term[4] = (term[0] + term[1]) + (term[2] + term[3]);
        K::store(at(out, i * N + j), term[4]);
        const V weight = row * K::load(inverse_scale_.data() + j);
#pragma GCC unroll 5
        for (int t = 0; t < 5; ++t) {
          scaled[t] = multiply_add(term[t], term[t], scaled[t]);
          const V weighted = term[t] * weight;
          original[t] = multiply_add(weighted, weighted, original[t]);
        }
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
  Square scratch_ = square();
  Square factor_ = square();
  Square absolute_ = square();
  Square columns_ = square();
  std::array<int, N> pivots_{};
  alignas(64) std::array<double, N> scale_{};
  alignas(64) std::array<double, N> inverse_scale_{};
};

}  // namespace quadtune::internal
