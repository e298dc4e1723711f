// SPDX-License-Identifier: Apache-2.0
/// The arithmetic of riccati_doubling.hpp by the kernels of dense_kernels.hpp. Matrices are stored
/// row by row and padded with decoupled stable states to the size that the kernels want.
#pragma once

#include <Eigen/Core>
#include <array>
#include <cmath>
#include <utility>
#include <vector>

#include "riccati/dense_kernels.hpp"
#include "riccati/kernel_storage.hpp"
#include "riccati/riccati_scaling.hpp"

namespace quadtune::internal {

/// @tparam Real  double, or float for what need not be exact
template <int kSize, class Real = double>
class KernelOps {
  using K = Kernels<kSize, Real>;
  using V = typename K::V;
  static constexpr int W = K::W;

 public:
  using Square = KernelStorage<kSize, kSize, Real>;
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
        scale_(1, k_.stride()),
        inverse_scale_(1, k_.stride()) {}

  [[nodiscard]] int size() const { return nx_; }
  [[nodiscard]] Square square() const { return Square(k_.n(), k_.stride()); }
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
      for (int i = 0; i < j; ++i) X[i * s() + j] = 0;
      X[j * s() + j] = 1 / factor(j, j);
      for (int i = j + 1; i < nu_; ++i) {
        double sum = 0;
        for (int k = j; k < i; ++k) sum -= factor(i, k) * X[k * s() + j];
        X[i * s() + j] = sum / factor(i, i);
      }
    }
  }

  /// Inverse of the Cholesky factor of S = R + BᵀXB. False when S is not positive definite.
  bool invert_inner(const Panel& R, const Panel& B, const Panel& XB, Panel& inverse) {
    k_.template multiply<true>(data(B), data(XB), data(scratch_), nx_);
    double* S = data(scratch_);
    for (int j = 0; j < nu_; ++j)
      for (int i = j; i < nu_; ++i) S[i * s() + j] += data(R)[i * s() + j];
    for (int j = 0; j < nu_; ++j) {
      const double before = S[j * s() + j];
      for (int k = 0; k < j; ++k) S[j * s() + j] -= S[j * s() + k] * S[j * s() + k];
      if (!(S[j * s() + j] > 1e-14 * before)) return false;
      S[j * s() + j] = std::sqrt(S[j * s() + j]);
      for (int i = j + 1; i < nu_; ++i) {
        for (int k = 0; k < j; ++k) S[i * s() + j] -= S[i * s() + k] * S[j * s() + k];
        S[i * s() + j] /= S[j * s() + j];
      }
    }
    double* X = data(inverse);
    for (int j = 0; j < nu_; ++j) {
      for (int i = 0; i < j; ++i) X[i * s() + j] = 0;
      X[j * s() + j] = 1 / S[j * s() + j];
      for (int i = j + 1; i < nu_; ++i) {
        double sum = 0;
        for (int k = j; k < i; ++k) sum -= S[i * s() + k] * X[k * s() + j];
        X[i * s() + j] = sum / S[i * s() + i];
      }
    }
    return true;
  }

  // Products. `panel` is square times panel; `small` matrices multiply from the right.
  void multiply(const Square& A, const Square& B, Square& C) const {
    k_.template multiply<false>(data(A), data(B), data(C));
  }
  void multiply_transposed(const Square& A, const Square& B, Square& C) const {
    k_.template multiply<true>(data(A), data(B), data(C));
  }
  /// C = Aᵀ B, known to be symmetric.
  void multiply_transposed_symmetric(const Square& A, const Square& B, Square& C) const {
    k_.template multiply_symmetric<true>(data(A), data(B), data(C), k_.n());
  }
  void panel(const Square& A, const Panel& B, Panel& C) const {
    k_.template multiply_panel<false>(data(A), data(B), data(C), k_.n(), panel_columns());
  }
  void panel_transposed(const Square& A, const Panel& B, Panel& C) const {
    k_.template multiply_panel<true>(data(A), data(B), data(C), k_.n(), panel_columns());
  }
  void times_small(const Panel& A, const Panel& S, Panel& C) const {
    k_.template multiply_panel<false>(data(A), data(S), data(C), nu_, panel_columns());
  }
  void times_small_transposed(const Panel& A, const Panel& S, Panel& C) {
    k_.transpose(data(S), data(scratch_));
    k_.template multiply_panel<false>(data(A), data(scratch_), data(C), nu_, panel_columns());
  }
  /// C = A Bᵀ of two panels.
  void outer(const Panel& A, const Panel& B, Square& C) {
    k_.transpose(data(B), data(scratch_));
    k_.template multiply<false>(data(A), data(scratch_), data(C), nu_);
  }

  /// C = A Aᵀ of a panel.
  void outer(const Panel& A, Square& C) {
    k_.transpose(data(A), data(scratch_));
    k_.template multiply_symmetric<false>(data(A), data(scratch_), data(C), nu_);
  }

  bool factor(Square& A) {
    k_.transpose(data(A), data(factor_));
    return k_.factor(data(factor_), pivots_.data());
  }
  void solve(Square& X) const { k_.solve(data(factor_), pivots_.data(), data(X)); }

  // Entry by entry.
  // Copies go by the kernels' own vectors: wider loads would have to wait for narrower stores.
  void copy(const Square& from, Square& to) const {
    for (int i = 0; i < entries(); i += W) K::store(at(to, i), K::load(at(from, i)));
  }
  void swap(Square& a, Square& b) const {
    if constexpr (kSize > 0) {
      for (int i = 0; i < entries(); i += W) {
        const V held = K::load(at(a, i));
        K::store(at(a, i), K::load(at(b, i)));
        K::store(at(b, i), held);
      }
    } else {
      std::swap(a, b);
    }
  }
  void transpose(const Square& A, Square& T) const { k_.transpose(data(A), data(T)); }
  void add(Square& A, const Square& B) const {
    for (int i = 0; i < entries(); i += W)
      K::store(at(A, i), K::load(at(A, i)) + K::load(at(B, i)));
  }
  void add_panel(Panel& A, const Panel& B) const { add(A, B); }
  void subtract(const Square& A, const Square& B, Square& C) const {
    for (int i = 0; i < entries(); i += W)
      K::store(at(C, i), K::load(at(A, i)) - K::load(at(B, i)));
  }
  void multiply_by(Square& A, Real factor) const {
    const V f = K::broadcast(factor);
    for (int i = 0; i < entries(); i += W) K::store(at(A, i), K::load(at(A, i)) * f);
  }
  void identity(Square& A) const {
    A.fill(0);
    add_diagonal(A, 1);
  }
  void add_diagonal(Square& A, Real value) const {
    for (int i = 0; i < k_.n(); ++i) data(A)[i * s() + i] += value;
  }
  /// Sets the diagonal of the states that are only padding.
  void set_padding(Square& A, Real value) const {
    for (int i = nx_; i < k_.n(); ++i) data(A)[i * s() + i] = value;
  }
  /// S = factor · (M + Mᵀ)/2.
  void scaled_symmetric(const Square& M, Real factor, Square& S) {
    k_.transpose(data(M), data(scratch_));
    const V f = K::broadcast(Real(0.5) * factor);
    for (int i = 0; i < entries(); i += W)
      K::store(at(S, i), (K::load(at(M, i)) + K::load(at(scratch_, i))) * f);
  }
  /// S ← S + (M + Mᵀ)/2; returns the norms of the change and of the sum.
  std::pair<double, double> add_symmetric(const Square& M, Square& S) {
    k_.transpose(data(M), data(scratch_));
    const V half = K::broadcast(0.5);
    return add_measured(
        S, [&](int i) { return (K::load(at(M, i)) + K::load(at(scratch_, i))) * half; });
  }

  /// S ← S + AᵀB, the product known to be symmetric; returns as add_symmetric().
  std::pair<double, double> add_product_tn(const Square& A, const Square& B, Square& S) {
    k_.template multiply_symmetric<true>(data(A), data(B), data(product_), k_.n());
    return add_product(S);
  }
  /// S ← S + A Bᵀ, the product known to be symmetric.
  void add_product_nt(const Square& A, const Square& B, Square& S) {
    k_.transpose(data(B), data(scratch_));
    k_.template multiply_symmetric<false>(data(A), data(scratch_), data(product_), k_.n());
    add_product(S);
  }

  // Norms and measures.
  [[nodiscard]] double norm1(const Square& A) {
    Real largest = 0;
    for (int j = 0; j < s(); j += W) {
      V sums = {};
      for (int i = 0; i < k_.n(); ++i) sums += magnitude(K::load(at(A, i * s() + j)));
      for (int lane = 0; lane < W; ++lane) largest = std::max(largest, sums[lane]);
    }
    return largest;
  }
  [[nodiscard]] double norm_frobenius(const Square& A) const {
    V sum = {};
    for (int i = 0; i < entries(); i += W)
      sum = multiply_add(K::load(at(A, i)), K::load(at(A, i)), sum);
    return std::sqrt(total(sum));
  }
  /// Norm of D⁻¹ M D⁻¹, M in scaled states: that of a solution in the caller's units.
  [[nodiscard]] double weighted_norm(const Square& M) const {
    V sum = {};
    for (int i = 0; i < k_.n(); ++i)
      for (int j = 0; j < s(); j += W) {
        const V m = K::load(at(M, i * s() + j)) * K::broadcast(inverse_scale_[i]) *
                    K::load(inverse_scale_.data() + j);
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
      for (int k = 0; k < nx_; ++k)
        add_sizes(K::load(at(A, k * s() + i)), K::load(at(Q, k * s() + i)), squares, sums);
      for (int lane = 0; lane < std::min(W, nx_ - i); ++lane) {
        V row_squares = {};
        V row_sums = {};
        for (int j = 0; j < s(); j += W) {
          const int row = (i + lane) * s() + j;
          add_sizes(K::load(at(A, row)), K::load(at(G, row)), row_squares, row_sums);
        }
        speed.add(total(row_squares), total(row_sums));
        speed.add(squares[lane], sums[lane]);
      }
    }
    return speed.value();
  }

  /// AᵀX + (AᵀX)ᵀ - U + Q, given T = AᵀX.
  Residual residual_continuous(const Square& T, const Square& U, const Square& Q, Square& out) {
    k_.transpose(data(T), data(scratch_));
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

  /// Writes factor · M, M of other kernels, of which the padding is not copied.
  template <class OtherOps>
  void convert(const OtherOps& other, const typename OtherOps::Square& M, double factor,
               Square& to) const {
    to.fill(0);
    for (int i = 0; i < nx_; ++i)
      for (int j = 0; j < nx_; ++j)
        data(to)[i * s() + j] = static_cast<Real>(factor * M.data()[i * other.stride() + j]);
  }
  [[nodiscard]] int stride() const { return k_.stride(); }

  // Scaling of the states.
  void balance(const Square& A, const Square& G, const Square& Q) {
    for (int i = 0; i < entries(); i += W) {
      K::store(at(scratch_, i), magnitude(K::load(at(A, i))));
      K::store(at(factor_, i), magnitude(K::load(at(G, i))));
      K::store(at(absolute_, i), magnitude(K::load(at(Q, i))));
    }
    k_.transpose(data(scratch_), data(columns_));
    const auto dot = [this](const double* a, const double* b) {
      V sum = {};
      for (int j = 0; j < s(); j += W) sum = multiply_add(K::load(a + j), K::load(b + j), sum);
      return total(sum);
    };
    level_scales(data(scratch_), data(columns_), data(factor_), data(absolute_), k_.n(), s(),
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
    for (int i = 0; i < k_.n(); ++i) {
      const V r = K::broadcast(rows[i]);
      for (int j = 0; j < s(); j += W)
        K::store(at(A, i * s() + j), K::load(at(A, i * s() + j)) * r * K::load(columns.data() + j));
    }
  }
  /// S = D², without the padding.
  void squared_scales(Square& S) const {
    S.fill(0);
    for (int i = 0; i < nx_; ++i) data(S)[i * s() + i] = scale_[i] * scale_[i];
  }
  /// T = D⁻² X.
  void divide_rows_twice(const Square& X, Square& T) const {
    for (int i = 0; i < k_.n(); ++i) {
      const V weight = K::broadcast(inverse_scale_[i] * inverse_scale_[i]);
      for (int j = 0; j < s(); j += W)
        K::store(at(T, i * s() + j), K::load(at(X, i * s() + j)) * weight);
    }
  }
  void scale_panel(Panel& A, int left) const {
    const auto& rows = left > 0 ? scale_ : inverse_scale_;
    for (int i = 0; i < k_.n(); ++i)
      for (int j = 0; j < s(); j += W)
        K::store(at(A, i * s() + j), K::load(at(A, i * s() + j)) * K::broadcast(rows[i]));
  }
  /// X = D⁻¹ X_z D⁻¹, K = K_z D⁻¹.
  void store_solution(const Square& X, const Panel& Kt, Eigen::MatrixXd& to_X,
                      Eigen::MatrixXd& to_K) const {
    to_X.resize(nx_, nx_);
    to_K.resize(nu_, nx_);
    for (int i = 0; i < nx_; ++i)
      for (int j = 0; j < nx_; ++j)
        to_X(j, i) = data(X)[i * s() + j] * (inverse_scale_[i] * inverse_scale_[j]);
    for (int i = 0; i < nx_; ++i)
      for (int j = 0; j < nu_; ++j) to_K(j, i) = data(Kt)[i * s() + j] * inverse_scale_[i];
  }

 private:
  [[nodiscard]] int s() const { return k_.stride(); }
  [[nodiscard]] int entries() const { return k_.n() * k_.stride(); }
  [[nodiscard]] int panel_columns() const {
    return (nu_ + K::kMultiple - 1) / K::kMultiple * K::kMultiple;
  }
  static Real* data(Square& A) { return A.data(); }
  static const Real* data(const Square& A) { return A.data(); }
  static Real* at(Square& A, int i) { return A.data() + i; }
  static const Real* at(const Square& A, int i) { return A.data() + i; }
  static V magnitude(V v) { return v < V{} ? -v : v; }
  static Real total(V v) {
    Real sum = 0;
    for (int i = 0; i < W; ++i) sum += v[i];
    return sum;
  }

  static void add_sizes(V a, V b, V& squares, V& sums) {
    squares = multiply_add(a, a, multiply_add(b, b, squares));
    sums += magnitude(a) + magnitude(b);
  }

  template <class M>
  void load(const M& from, int rows, int cols, Square& to) const {
    to.fill(0);
    const double* p = from.data();
    const Eigen::Index stride = from.outerStride();
    for (int j = 0; j < cols; ++j)
      for (int i = 0; i < rows; ++i) data(to)[i * s() + j] = p[j * stride + i];
  }

  /// S ← S + product_, whose halves are equal already where the kernels computed only one.
  std::pair<double, double> add_product(Square& S) {
    if constexpr (kSize > 0) return add_symmetric(product_, S);
    return add_measured(S, [&](int i) { return K::load(at(product_, i)); });
  }
  template <class Change>
  std::pair<double, double> add_measured(Square& S, const Change& change_at) const {
    V changes = {};
    V sizes = {};
    for (int i = 0; i < entries(); i += W) {
      const V change = change_at(i);
      const V sum = K::load(at(S, i)) + change;
      K::store(at(S, i), sum);
      changes = multiply_add(change, change, changes);
      sizes = multiply_add(sum, sum, sizes);
    }
    return {std::sqrt(total(changes)), std::sqrt(total(sizes))};
  }

  /// Sums four terms into `out`; measures the sum against them.
  template <class Terms>
  Residual measure(Square& out, const Terms& terms) const {
    V scaled[5] = {};
    V original[5] = {};
    for (int i = 0; i < k_.n(); ++i) {
      const V row = K::broadcast(inverse_scale_[i]);
      for (int j = 0; j < s(); j += W) {
        V term[5];
        terms(i * s() + j, term);
        term[4] = (term[0] + term[1]) + (term[2] + term[3]);
        K::store(at(out, i * s() + j), term[4]);
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
  K k_;
  std::vector<int> pivots_;
  KernelStorage<1, kSize, Real> scale_;
  KernelStorage<1, kSize, Real> inverse_scale_;
  Square scratch_ = square();
  Square product_ = square();
  Square factor_ = square();
  Square absolute_ = square();
  Square columns_ = square();
};

}  // namespace quadtune::internal
