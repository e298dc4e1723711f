// SPDX-License-Identifier: Apache-2.0
/// The arithmetic of riccati_doubling.hpp for any size, by Eigen.
#pragma once

#include <Eigen/Core>
#include <Eigen/LU>
#include <array>
#include <cmath>
#include <utility>

#include "riccati_scaling.hpp"

namespace quadtune::internal {

class EigenOps {
 public:
  using Square = Eigen::MatrixXd;
  using Panel = Eigen::MatrixXd;

  EigenOps(Eigen::Index nx, Eigen::Index nu)
      : nx_(nx),
        nu_(nu),
        lu_(nx),
        scratch_(nx, nx),
        columns_(nx, nx),
        absolute_G_(nx, nx),
        absolute_Q_(nx, nx),
        inner_(nu, nu),
        scale_(nx),
        inverse_scale_(nx) {}

  [[nodiscard]] Eigen::Index size() const { return nx_; }
  [[nodiscard]] Square square() const { return Square::Zero(nx_, nx_); }
  [[nodiscard]] Panel panel() const { return Panel::Zero(nx_, nu_); }
  [[nodiscard]] Panel small() const { return Panel::Zero(nu_, nu_); }

  template <class M>
  void load_square(const M& from, Square& to) const {
    to = from;
  }
  template <class M>
  void load_panel(const M& from, Panel& to) const {
    to = from;
  }
  template <class M>
  void load_small(const M& from, Panel& to) const {
    to = from;
  }

  void invert_factor(const Eigen::MatrixXd& factor, Panel& inverse) const {
    inverse.setIdentity();
    factor.triangularView<Eigen::Lower>().solveInPlace(inverse);
  }
  bool invert_inner(const Panel& R, const Panel& B, const Panel& XB, Panel& inverse) {
    inner_ = R;
    inner_.noalias() += B.transpose() * XB;
    for (Eigen::Index j = 0; j < nu_; ++j) {
      const double before = inner_(j, j);
      const double pivot = before - inner_.row(j).head(j).squaredNorm();
      if (!(pivot > 1e-14 * before)) return false;
      inner_(j, j) = std::sqrt(pivot);
      for (Eigen::Index i = j + 1; i < nu_; ++i)
        inner_(i, j) =
            (inner_(i, j) - inner_.row(i).head(j).dot(inner_.row(j).head(j))) / inner_(j, j);
    }
    invert_factor(inner_, inverse);
    return true;
  }

  void multiply(const Square& A, const Square& B, Square& C) const { C.noalias() = A * B; }
  void multiply_transposed(const Square& A, const Square& B, Square& C) const {
    C.noalias() = A.transpose() * B;
  }
  void panel(const Square& A, const Panel& B, Panel& C) const { C.noalias() = A * B; }
  void panel_transposed(const Square& A, const Panel& B, Panel& C) const {
    C.noalias() = A.transpose() * B;
  }
  void times_small(const Panel& A, const Panel& S, Panel& C) const { C.noalias() = A * S; }
  void times_small_transposed(const Panel& A, const Panel& S, Panel& C) const {
    C.noalias() = A * S.transpose();
  }
  void outer(const Panel& A, const Panel& B, Square& C) const { C.noalias() = A * B.transpose(); }

  bool factor(const Square& A) {
    lu_.compute(A);
    const auto diagonal = lu_.matrixLU().diagonal().array().abs();
    return diagonal.minCoeff() > 0 && diagonal.maxCoeff() <= 1e300;
  }
  void solve(Square& X) {
    scratch_.noalias() = lu_.permutationP() * X;
    lu_.matrixLU().triangularView<Eigen::UnitLower>().solveInPlace(scratch_);
    lu_.matrixLU().triangularView<Eigen::Upper>().solveInPlace(scratch_);
    X.swap(scratch_);
  }
  void solve(Square& X, Square& Y) {
    solve(X);
    solve(Y);
  }

  void copy(const Square& from, Square& to) const { to = from; }
  void swap(Square& a, Square& b) const { a.swap(b); }
  void transpose(const Square& A, Square& T) const { T = A.transpose(); }
  void add(Square& A, const Square& B) const { A += B; }
  void add_panel(Panel& A, const Panel& B) const { A += B; }
  void subtract(const Square& A, const Square& B, Square& C) const { C = A - B; }
  void multiply_by(Square& A, double factor) const { A *= factor; }
  void identity(Square& A) const { A.setIdentity(); }
  void add_diagonal(Square& A, double value) const { A.diagonal().array() += value; }
  void set_padding(Square&, double) const {}
  void scaled_symmetric(const Square& M, double factor, Square& S) const {
    S = (0.5 * factor) * (M + M.transpose());
  }
  std::pair<double, double> add_symmetric(const Square& M, Square& S) {
    scratch_ = 0.5 * (M + M.transpose());
    S += scratch_;
    return {scratch_.norm(), S.norm()};
  }

  [[nodiscard]] double norm1(const Square& A) const {
    return A.cwiseAbs().colwise().sum().maxCoeff();
  }
  [[nodiscard]] double norm_frobenius(const Square& A) const { return A.norm(); }
  [[nodiscard]] double weighted_norm(const Square& M) const {
    double sum = 0;
    for (Eigen::Index j = 0; j < nx_; ++j)
      sum += (M.col(j).array() * inverse_scale_.array() * inverse_scale_[j]).square().sum();
    return std::sqrt(sum);
  }
  [[nodiscard]] double speed(const Square& A, const Square& G, const Square& Q) const {
    GeometricSpeed speed;
    for (Eigen::Index i = 0; i < nx_; ++i)
      speed.add(A.row(i).squaredNorm() + G.col(i).squaredNorm(),
                A.col(i).squaredNorm() + Q.col(i).squaredNorm());
    return speed.value();
  }

  Residual residual_continuous(const Square& T, const Square& U, const Square& Q,
                               Square& out) const {
    out = T + T.transpose() - U + Q;
    return measure(out, {&T, &T, &U, &Q});
  }
  Residual residual_discrete(const Square& T, const Square& X, const Square& U, const Square& Q,
                             Square& out) const {
    out = T - X - U + Q;
    return measure(out, {&T, &X, &U, &Q});
  }

  void balance(const Square& A, const Square& G, const Square& Q) {
    columns_ = A.cwiseAbs();
    scratch_ = columns_.transpose();
    absolute_G_ = G.cwiseAbs();
    absolute_Q_ = Q.cwiseAbs();
    const auto dot = [this](const double* a, const double* b) {
      return Eigen::Map<const Eigen::VectorXd>(a, nx_).dot(
          Eigen::Map<const Eigen::VectorXd>(b, nx_));
    };
    level_scales(scratch_.data(), columns_.data(), absolute_G_.data(), absolute_Q_.data(), nx_, nx_,
                 scale_.data(), inverse_scale_.data(), dot);
  }
  void scale_square(Square& A, int left, int right) const {
    const Eigen::VectorXd& rows = left > 0 ? scale_ : inverse_scale_;
    const Eigen::VectorXd& columns = right > 0 ? scale_ : inverse_scale_;
    for (Eigen::Index j = 0; j < nx_; ++j) A.col(j).array() *= rows.array() * columns[j];
  }
  void squared_scales(Square& S) const {
    S.setZero();
    S.diagonal() = scale_.cwiseAbs2();
  }
  void divide_rows_twice(const Square& X, Square& T) const {
    for (Eigen::Index j = 0; j < nx_; ++j)
      T.col(j).array() = X.col(j).array() * inverse_scale_.array().square();
  }
  void scale_panel(Panel& A, int left) const {
    const Eigen::VectorXd& rows = left > 0 ? scale_ : inverse_scale_;
    for (Eigen::Index j = 0; j < A.cols(); ++j) A.col(j).array() *= rows.array();
  }
  void store_solution(const Square& X, const Panel& Kt, Eigen::MatrixXd& to_X,
                      Eigen::MatrixXd& to_K) const {
    to_X = inverse_scale_.asDiagonal() * X * inverse_scale_.asDiagonal();
    to_K = Kt.transpose() * inverse_scale_.asDiagonal();
  }

 private:
  [[nodiscard]] Residual measure(const Square& M, const std::array<const Square*, 4>& terms) const {
    const auto weighted = [this](const Square& of) {
      const double norm = weighted_norm(of);
      return norm * norm;
    };
    Residual result;
    std::array<double, 4> scaled_terms;
    for (std::size_t t = 0; t < 4; ++t) {
      result.squared_terms[t] = weighted(*terms[t]);
      scaled_terms[t] = terms[t]->squaredNorm();
    }
    result.squared = weighted(M);
    result.relative = relative_size(result.squared, result.squared_terms);
    result.relative_scaled = relative_size(M.squaredNorm(), scaled_terms);
    return result;
  }

  Eigen::Index nx_;
  Eigen::Index nu_;
  Eigen::PartialPivLU<Eigen::MatrixXd> lu_;
  Square scratch_;
  Square columns_;
  Square absolute_G_;
  Square absolute_Q_;
  Eigen::MatrixXd inner_;
  Eigen::VectorXd scale_;
  Eigen::VectorXd inverse_scale_;
};

}  // namespace quadtune::internal
