// SPDX-License-Identifier: Apache-2.0
#include "certify/enclosed_hold.hpp"

#include <cmath>
#include <limits>

namespace quadtune::internal {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;

constexpr int kTerms = 16;
constexpr int kMaxDoublings = 40;

// Σ_{j>N} r^j/(j+1)! ≤ 2 r^(N+1)/(N+2)! for r ≤ 1: the remainder of the series of ∫ e^(Xs) ds.
double remainder(double r) {
  double term = 2;
  for (int j = 1; j <= kTerms + 1; ++j) term *= r / j;
  return bounded_above(term / (kTerms + 2));
}

double row_sum(const ConstRef& R) {
  return R.size() == 0 ? 0 : bounded_above(R.rowwise().sum().maxCoeff());
}

}  // namespace

EnclosedHold enclosed_hold(const Enclosure& A, const NumberEnclosure& t) {
  const Index n = A.rows();
  const Enclosure one{MatrixXd(MatrixXd::Identity(n, n))};
  double r = bounded_above(row_sum(A.magnitude()) * (std::abs(t.mid) + t.rad));
  int doublings = 0;
  while (r > 0.5 && doublings < kMaxDoublings) {
    r /= 2;
    ++doublings;
  }
  const double part = std::ldexp(1.0, -doublings);
  const NumberEnclosure h{t.mid * part, t.rad * part};
  const Enclosure X = h * A;
  Enclosure P = one;  // Σ X^j/(j+1)!, by Horner's scheme
  for (int j = kTerms; j >= 1; --j) P = one + X * P / (j + 1.0);
  // Beyond 1/2 (too many doublings, or entries that are not finite) there is no bound.
  const double left_out = r <= 0.5 ? remainder(r) : std::numeric_limits<double>::infinity();
  P.rad.array() += left_out;
  EnclosedHold hold{one + X * P, h * P};
  for (; doublings > 0; --doublings) {
    hold.Gamma = hold.Gamma + hold.Phi * hold.Gamma;
    hold.Phi = hold.Phi * hold.Phi;
  }
  return hold;
}

HoldSize hold_size(const ConstRef& size, double longest) {
  const EnclosedHold hold = enclosed_hold(Enclosure(size), {longest, 0});
  return {hold.Phi.magnitude(), hold.Gamma.magnitude()};
}

// The upper right block of exp([X Y 0; 0 X Y; 0 0 X]) is ∂²/2.
MatrixXd exponential_curvature(const ConstRef& size, const ConstRef& change, double longest) {
  const Index n = size.rows();
  MatrixXd blocks = MatrixXd::Zero(3 * n, 3 * n);
  for (Index i = 0; i < 3; ++i) blocks.block(i * n, i * n, n, n) = size;
  for (Index i = 0; i < 2; ++i) blocks.block(i * n, (i + 1) * n, n, n) = change;
  return 2 * hold_size(blocks, longest).Phi.topRightCorner(n, n);
}

}  // namespace quadtune::internal
