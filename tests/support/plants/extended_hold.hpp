// SPDX-License-Identifier: Apache-2.0
/// e^(A dt) and ∫ e^(Aτ) dτ B in extended precision, by the plainest series there is.
#pragma once

#include <Eigen/Core>
#include <cmath>

namespace quadtune::testing {

/// Both rounded to double at the end.
struct ExtendedHold {
  Eigen::MatrixXd E;
  Eigen::MatrixXd integral;
};

/// Taylor series at ‖A h‖ ≤ 1/8, then doublings of e^(Ah) - I. With 64 bits of mantissa, a few
/// hundred superfluous doublings would be needed to make an error visible in double.
inline ExtendedHold extended_hold(const Eigen::MatrixXd& A, const Eigen::MatrixXd& B, double dt) {
  using Extended = Eigen::Matrix<long double, Eigen::Dynamic, Eigen::Dynamic>;
  long double h = dt;
  int doublings = 0;
  while (A.cast<long double>().cwiseAbs().rowwise().sum().maxCoeff() * h > 0.125L) {
    h /= 2;
    ++doublings;
  }
  const Extended X = A.cast<long double>() * h;
  Extended term = Extended::Identity(A.rows(), A.rows());
  Extended P = term;
  for (int k = 1; k < 20; ++k) {
    term = (term * X / static_cast<long double>(k + 1)).eval();
    P += term;
  }
  Extended F = X * P;
  Extended G = P * B.cast<long double>() * h;
  for (; doublings > 0; --doublings) {
    G = (2 * G + F * G).eval();
    F = (2 * F + F * F).eval();
  }
  F.diagonal().array() += 1;
  return {F.cast<double>(), G.cast<double>()};
}

}  // namespace quadtune::testing
