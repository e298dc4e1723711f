// SPDX-License-Identifier: Apache-2.0
#include "quadtune/frequency_response.hpp"

#include <Eigen/Eigenvalues>
#include <utility>

#include "quadtune/internal/balance.hpp"

namespace quadtune {

using Eigen::Index;
using Eigen::MatrixXcd;
using Eigen::MatrixXd;

struct FrequencyResponse::Reduced {
  double dt = 0;  ///< 0: continuous
  MatrixXd H;     ///< upper Hessenberg
  MatrixXd B;
  MatrixXd C;
  MatrixXd D;
};

namespace {

/// Solves (λI - H) X = B for an upper Hessenberg H by Gaussian elimination; in each column the
/// larger of the two rows is the pivot.
MatrixXcd solve_hessenberg(const MatrixXd& H, std::complex<double> lambda, const MatrixXd& B) {
  const Index n = H.rows();
  MatrixXcd M = -H.cast<std::complex<double>>();
  M.diagonal().array() += lambda;
  MatrixXcd X = B.cast<std::complex<double>>();
  for (Index k = 0; k + 1 < n; ++k) {
    if (std::norm(M(k + 1, k)) > std::norm(M(k, k))) {
      M.row(k).tail(n - k).swap(M.row(k + 1).tail(n - k));
      X.row(k).swap(X.row(k + 1));
    }
    if (M(k + 1, k) == 0.0) continue;
    const std::complex<double> factor = M(k + 1, k) / M(k, k);
    M.row(k + 1).tail(n - k - 1) -= factor * M.row(k).tail(n - k - 1);
    X.row(k + 1) -= factor * X.row(k);
  }
  M.triangularView<Eigen::Upper>().solveInPlace(X);
  return X;
}

template <class Lti>
void reduce(const Lti& plant, MatrixXd& H, MatrixXd& B, MatrixXd& C, MatrixXd& D) {
  validate(plant, "frequency response");
  const Index nx = plant.A.rows();
  const Eigen::VectorXd d = internal::balance(plant.A);
  H = d.cwiseInverse().asDiagonal() * plant.A * d.asDiagonal();
  B = d.cwiseInverse().asDiagonal() * plant.B;
  C = plant.C.size() ? plant.C : MatrixXd::Identity(nx, nx);
  D = plant.D.size() ? plant.D : MatrixXd::Zero(C.rows(), plant.B.cols());
  C = (C * d.asDiagonal()).eval();
  if (nx < 3) return;
  const Eigen::HessenbergDecomposition<MatrixXd> hessenberg(H);
  const MatrixXd Q = hessenberg.matrixQ();
  H = hessenberg.matrixH();
  B = (Q.transpose() * B).eval();
  C = (C * Q).eval();
}

}  // namespace

FrequencyResponse::FrequencyResponse(const ContinuousLti& plant)
    : reduced_(std::make_unique<Reduced>()) {
  reduce(plant, reduced_->H, reduced_->B, reduced_->C, reduced_->D);
}
FrequencyResponse::FrequencyResponse(const DiscreteLti& plant)
    : reduced_(std::make_unique<Reduced>()) {
  reduce(plant, reduced_->H, reduced_->B, reduced_->C, reduced_->D);
  reduced_->dt = plant.dt;
}
FrequencyResponse::~FrequencyResponse() = default;
FrequencyResponse::FrequencyResponse(FrequencyResponse&&) noexcept = default;
FrequencyResponse& FrequencyResponse::operator=(FrequencyResponse&&) noexcept = default;

MatrixXcd FrequencyResponse::at(double w) const {
  return at_point(reduced_->dt > 0 ? std::polar(1.0, w * reduced_->dt)
                                   : std::complex<double>(0, w));
}

MatrixXcd FrequencyResponse::at_point(std::complex<double> lambda) const {
  return reduced_->C * solve_hessenberg(reduced_->H, lambda, reduced_->B) + reduced_->D;
}

}  // namespace quadtune
