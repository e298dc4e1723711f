// SPDX-License-Identifier: Apache-2.0
#include "kernel/exponential_kernel.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <utility>

#include "kernel/padded_product.hpp"

namespace quadtune::internal {
namespace {

using Eigen::Index;

// A Taylor polynomial of φ(X) = (e^X - I) X⁻¹ = Σ Xᵏ/(k+1)! and its range of validity: the sum of
// the omitted terms is below 2⁻⁵⁴ as long as α ≤ theta, α = max(‖X²‖^½, ‖X³‖^⅓) [Al-Mohy, Higham
// 2009, theorem 4.2: ‖Xᵏ‖ ≤ αᵏ for k ≥ 2]. Degrees 3r + 2 use I, X and X² fully and cost r products
// in addition to X³.
struct Degree {
  int degree;
  double theta;
};
constexpr std::array<Degree, 6> kDegrees{{
    {2, 1.1003482912616375e-05},
    {5, 0.008085904480516035},
    {8, 0.08362085238227049},
    {11, 0.28893581117980704},
    {14, 0.6356709251667247},
    {17, 1.1084348681247873},  // above this, a doubling costs less than more terms
}};

constexpr std::array<double, 18> inverse_factorials() {
  std::array<double, 18> c{};  // 1/(k+1)!
  double factorial = 1;        // exact up to 18!
  for (int k = 0; k < 18; ++k) {
    factorial *= k + 1;
    c[static_cast<std::size_t>(k)] = 1 / factorial;
  }
  return c;
}
constexpr std::array<double, 18> kInverseFactorial = inverse_factorials();

bool within(double X2_norm, double X3_norm, double theta) {
  return X2_norm <= theta * theta && X3_norm <= theta * theta * theta;
}

// If ‖e^(Ah)‖ is smaller, squaring it is more accurate than squaring e^(Ah) - I.
constexpr double kDecayed = 0.5;

}  // namespace

Index ExponentialKernel::storage_size(Index n, Index nu) {
  return 6 * padded(n) * padded(n) + 2 * padded(n) * padded(nu);
}

ExponentialKernel::ExponentialKernel(Index n, Index nu, double* storage)
    : n_(n), nu_(nu), ld_(padded(n)), cols_(padded(nu)), size_(ld_ * ld_) {
  // The results are zero in the padding because these three are.
  I_ = storage;
  X_ = I_ + size_;
  H_ = X_ + size_;
  std::fill(I_, H_ + ld_ * cols_, 0.0);
  for (Index i = 0; i < n_; ++i) I_[i + i * ld_] = 1;
  G_ = H_ + ld_ * cols_;
  X2_ = G_ + ld_ * cols_;
  X3_ = X2_ + size_;
  P_ = X3_ + size_;
  F_ = P_ + size_;
}

ExponentialStatus ExponentialKernel::solve(const Eigen::Ref<const Eigen::MatrixXd>& A,
                                           const Eigen::Ref<const Eigen::MatrixXd>& B, double dt,
                                           Eigen::Ref<Eigen::MatrixXd> E,
                                           Eigen::Ref<Eigen::MatrixXd> integral) {
  has_identity_ = false;
  load(A, B, dt);
  int doublings = 0;
  // An infinity or NaN in X propagates to X³, because 0 · ∞ is NaN.
  if (!look_at_powers()) {
    doublings = load_scaled(A, dt);
    if (!look_at_powers()) return no_result(E, integral);
  }
  doublings += halve();
  const auto* chosen = std::find_if(kDegrees.begin(), kDegrees.end() - 1, [&](const Degree& d) {
    return within(X2_norm_, X3_norm_, d.theta);
  });
  series(chosen->degree);
  double_up(doublings);
  const bool finite =
      std::isfinite(norm(G_, ld_, cols_)) && (doublings == 0 || std::isfinite(norm(F_, ld_, n_)));
  if (!finite) return no_result(E, integral);
  store(E, integral);
  return ExponentialStatus::solved;
}

void ExponentialKernel::load(const Eigen::Ref<const Eigen::MatrixXd>& A,
                             const Eigen::Ref<const Eigen::MatrixXd>& B, double dt) {
  copy_scaled(dt, A.data(), A.outerStride(), X_, ld_, n_, n_);
  copy_scaled(1, B.data(), B.outerStride(), H_, ld_, n_, nu_);
  step_ = dt;
}

// For ‖A dt‖ that overflows, or whose powers do: X = A dt / 2^s with ‖X‖ ≤ 1. Returns s.
int ExponentialKernel::load_scaled(const Eigen::Ref<const Eigen::MatrixXd>& A, double dt) {
  if (!A.allFinite()) return 0;
  // Scales A and dt to about 1 first, because their product may overflow.
  const int A_exponent = std::ilogb(A.cwiseAbs().maxCoeff());
  const int dt_exponent = std::ilogb(dt);
  const int doublings = A_exponent + dt_exponent + std::ilogb(static_cast<double>(n_)) + 3;
  const int rest = A_exponent + dt_exponent - doublings;
  const double near_one = std::scalbn(dt, -dt_exponent);
  for (Index j = 0; j < n_; ++j)
    for (Index i = 0; i < n_; ++i)
      X_[i + j * ld_] = std::scalbn(std::scalbn(A(i, j), -A_exponent) * near_one, rest);
  step_ = std::scalbn(dt, -doublings);
  return doublings;
}

bool ExponentialKernel::look_at_powers() {
  multiply(X_, X_, X2_, ld_, n_, ld_, Start::zero);
  multiply(X_, X2_, X3_, ld_, n_, ld_, Start::zero);
  X2_norm_ = norm(X2_, ld_, n_);
  X3_norm_ = norm(X3_, ld_, n_);
  return std::isfinite(X2_norm_) && std::isfinite(X3_norm_);
}

// Halves X until the highest degree is accurate; returns the number of halvings. Powers of two are
// exact.
int ExponentialKernel::halve() {
  int halvings = 0;
  for (; !within(X2_norm_, X3_norm_, kDegrees.back().theta); ++halvings) {
    X2_norm_ /= 4;
    X3_norm_ /= 8;
  }
  if (halvings == 0) return 0;
  const double half = std::scalbn(1.0, -halvings);
  scale(half, X_, X_, size_);
  scale(half * half, X2_, X2_, size_);
  scale(half * half * half, X3_, X3_, size_);
  step_ *= half;
  return halvings;
}

// P = φ(X), F = X P = e^X - I, G = step · P B.
void ExponentialKernel::series(int degree) {
  const auto block = [this](int k) {
    const double* c = &kInverseFactorial[static_cast<std::size_t>(k)];
    return Combination{c[0], I_, c[1], X_, c[2], X2_};
  };
  // Horner's rule in X³ [Paterson, Stockmeyer 1973].
  combine(block(degree - 2), P_, size_);
  for (int k = degree - 5; k >= 0; k -= 3) {
    multiply(P_, X3_, F_, ld_, n_, ld_, block(k));
    std::swap(P_, F_);
  }
  multiply(X_, P_, F_, ld_, n_, ld_, Start::zero);
  multiply(P_, H_, G_, ld_, n_, cols_, Start::zero);
  scale(step_, G_, G_, ld_ * cols_);
}

// G(2h) = G + e^(Ah) G = 2 G + F G
void ExponentialKernel::double_integral() {
  scale(has_identity_ ? 1 : 2, G_, H_, ld_ * cols_);
  multiply(F_, G_, H_, ld_, n_, cols_, Start::result);
  std::swap(G_, H_);
}

// From h to 2h: e^(2Ah) - I = 2 F + F². F keeps the digits of a slow mode, which rounding would
// remove from e^(Ah) = 1 + small. Once all modes have decayed, e^(Ah) itself is small and is used
// instead.
void ExponentialKernel::double_up(int times) {
  for (; times > 0; --times) {
    double_integral();
    scale(has_identity_ ? 0 : 2, F_, P_, size_);
    multiply(F_, F_, P_, ld_, n_, ld_, Start::result);
    std::swap(P_, F_);
    if (has_identity_ || times == 1) continue;
    combine({1, I_, 1, F_, 0, F_}, P_, size_);
    if (norm(P_, ld_, n_) <= kDecayed) {
      std::swap(P_, F_);
      has_identity_ = true;
    }
  }
}

void ExponentialKernel::store(Eigen::Ref<Eigen::MatrixXd> E,
                              Eigen::Ref<Eigen::MatrixXd> integral) const {
  copy_scaled(1, F_, ld_, E.data(), E.outerStride(), n_, n_);
  if (!has_identity_) E.diagonal().array() += 1;
  copy_scaled(1, G_, ld_, integral.data(), integral.outerStride(), n_, nu_);
}

ExponentialStatus ExponentialKernel::no_result(Eigen::Ref<Eigen::MatrixXd> E,
                                               Eigen::Ref<Eigen::MatrixXd> integral) {
  E.setConstant(std::numeric_limits<double>::quiet_NaN());
  integral.setConstant(std::numeric_limits<double>::quiet_NaN());
  return ExponentialStatus::overflow;
}

ExponentialStatus exponential_and_integral(const Eigen::Ref<const Eigen::MatrixXd>& A,
                                           const Eigen::Ref<const Eigen::MatrixXd>& B, double dt,
                                           Eigen::Ref<Eigen::MatrixXd> E,
                                           Eigen::Ref<Eigen::MatrixXd> integral) {
  constexpr Index kOnStack = 2048;  // 16 KiB: 16 states with 16 inputs
  alignas(64) double stack[kOnStack];
  Eigen::VectorXd heap;
  const Index needed = ExponentialKernel::storage_size(A.rows(), B.cols());
  if (needed > kOnStack) heap.resize(needed);
  ExponentialKernel kernel(A.rows(), B.cols(), needed > kOnStack ? heap.data() : stack);
  return kernel.solve(A, B, dt, E, integral);
}

}  // namespace quadtune::internal
