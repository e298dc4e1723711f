// SPDX-License-Identifier: Apache-2.0
#include "riccati/riccati_lanes.hpp"

namespace quadtune::internal {

LaneDoubling::LaneDoubling(Eigen::Index nx, Eigen::Index nu) : DoublingSteps(nx, nu) {}

bool LaneDoubling::solve(Time time, const std::array<const RiccatiMatrices*, kLaneCount>& problems,
                         int max_iterations) {
  continuous_ = time == Time::continuous;
  stable_.fill(false);
  if (!load(problems)) return false;
  scale();
  if (continuous_ && !start_continuous(ops_.speed(At_, G_, Qt_))) return false;
  if (!continuous_) start_discrete();
  return iterate(max_iterations, kStands, iterations_) && polish();
}

/// A, B, Q, R, N as given; At, Qt of the problem without cross term; G = B R⁻¹ Bᵀ.
bool LaneDoubling::load(const std::array<const RiccatiMatrices*, kLaneCount>& problems) {
  cross_ = problems[0]->N.size() > 0;
  for (int lane = 0; lane < kLaneCount; ++lane) {
    const RiccatiMatrices& p = *problems[static_cast<std::size_t>(lane)];
    LaneOps::load(p.A, lane, A_);
    LaneOps::load(p.B, lane, B_);
    LaneOps::load(p.Q, lane, Q_);
    LaneOps::load(p.R, lane, R_);
    if (cross_) LaneOps::load(p.N, lane, N_);
  }
  ops_.set_padding(A_, 0);
  if (!ops_.invert_cholesky(R_, Linv_)) return false;
  ops_.outer(B_, Linv_, Bs_);  // Bs = B L⁻ᵀ, so that G = Bs Bsᵀ
  ops_.outer(Bs_, Bs_, G_);
  LaneOps::copy(A_, At_);
  LaneOps::copy(Q_, Qt_);
  if (cross_) {
    ops_.outer(N_, Linv_, Ns_);
    ops_.subtract_outer(Bs_, Ns_, At_);  // A - B R⁻¹ Nᵀ
    ops_.subtract_outer(Ns_, Ns_, Qt_);  // Q - N R⁻¹ Nᵀ
  }
  return true;
}

void LaneDoubling::scale() {
  ops_.balance(At_, G_, Qt_);
  for (Square* M : {&At_, &A_}) ops_.scale_square(*M, -1, 1);
  for (Square* M : {&Qt_, &Q_}) ops_.scale_square(*M, 1, 1);
  ops_.scale_square(G_, -1, -1);
  for (Panel* M : {&B_, &Bs_}) ops_.scale_panel(*M, -1);
  if (cross_)
    for (Panel* M : {&N_, &Ns_}) ops_.scale_panel(*M, 1);
}

LaneResidual LaneDoubling::evaluate() {
  if (continuous_) {
    // Y = X Bs + Ns; residual = AᵀX + XA - Y Yᵀ + Q
    ops_.multiply(H_, Bs_, Y_);
    if (cross_) LaneOps::add(Y_, Ns_);
    LaneOps::copy(Bs_, Bh_);
    LaneOps::copy(Linv_, inverse_);
    ops_.multiply_transposed(A_, H_, T_);
    ops_.outer(Y_, Y_, U_);
    return ops_.measure(
        [this](int i, int j) {
          return std::array{T_(i, j), T_(j, i), -U_(i, j), Q_(i, j)};
        },
        residual_);
  }
  // S = R + BᵀXB = L Lᵀ, F = AᵀXB + N, Y = F L⁻ᵀ; residual = AᵀXA - X - Y Yᵀ + Q
  ops_.multiply(H_, B_, XB_);
  ops_.multiply_transposed(B_, XB_, S_);
  LaneOps::add(S_, R_);
  if (!ops_.invert_cholesky(S_, inverse_)) return {};
  ops_.multiply_transposed(A_, XB_, Kt_);
  if (cross_) LaneOps::add(Kt_, N_);
  ops_.outer(Kt_, inverse_, Y_);
  ops_.outer(B_, inverse_, Bh_);
  ops_.multiply(H_, A_, V_);
  ops_.multiply_transposed(A_, V_, T_);
  ops_.outer(Y_, Y_, U_);
  return ops_.measure(
      [this](int i, int j) {
        return std::array{T_(i, j), -H_(i, j), -U_(i, j), Q_(i, j)};
      },
      residual_);
}

bool LaneDoubling::polish() {
  residual_of_ = evaluate();
  for (int step = 0;; ++step) {
    const double worst = largest(residual_of_.worst);
    if (std::isnan(worst)) return false;
    const bool refine = worst > kWorthRefining && step < kMaxNewtonSteps;
    if (!prove_stable(refine)) return false;
    if (!refine) return true;
    LaneOps::copy(H_, G_);  // to go back to; the proof is of this one
    LaneOps::add_symmetric(correction_, H_);
    const LaneResidual then = evaluate();
    const double refined = largest(then.worst);
    if (!(refined < worst)) {
      LaneOps::copy(G_, H_);
      residual_of_ = evaluate();
      return true;
    }
    residual_of_ = then;
    if (refined > 0.5 * worst) step = kMaxNewtonSteps;
  }
}

/// E = A - B K, or, continuous, its Cayley transform I + 2γ F with F = (A - B K - γI)⁻¹.
bool LaneDoubling::close_loop() {
  LaneOps::copy(A_, E_);
  ops_.subtract_outer(Bh_, Y_, E_);
  ops_.set_padding(E_, continuous_ ? -gamma_ : 0);
  if (!continuous_) return true;
  ops_.add_diagonal(E_, -gamma_);
  if (!ops_.factor(E_)) return false;
  ops_.identity(F_);
  ops_.solve(F_);
  LaneOps::copy(F_, E_);
  LaneOps::multiply_by(E_, 2 * gamma_);
  ops_.add_diagonal(E_, 1);
  return true;
}

bool LaneDoubling::prove_stable(bool refine) {
  if (!close_loop()) return false;
  if (refine) {
    // First term of Σ (Eᵏ)ᵀ M Eᵏ that solves the closed loop's Lyapunov equation: 2γ Fᵀ M F, or M.
    LaneOps::copy(residual_, correction_);
    if (continuous_) {
      ops_.multiply(correction_, F_, T_);
      ops_.multiply_transposed(F_, T_, correction_);
      LaneOps::multiply_by(correction_, 2 * gamma_);
    }
  }
  const double small = refine ? kVanished : kContracts;
  for (int i = 0; i < kMaxSquarings; ++i) {
    const Lane size = square_root(LaneOps::squared_norm(E_));
    bool decided = true;
    for (int lane = 0; lane < kLaneCount; ++lane) {
      const double norm = size[lane];
      stable_[static_cast<std::size_t>(lane)] = norm <= small;
      decided = decided && !(norm > small && norm < 1e100);  // NaN is decided
    }
    if (decided) return true;
    if (refine) {
      ops_.multiply(correction_, E_, T_);
      ops_.add_product_tn(E_, T_, correction_);
    }
    ops_.multiply(E_, E_, T_);
    LaneOps::swap(E_, T_);
  }
  return true;
}

void LaneDoubling::store(int lane, Eigen::MatrixXd& X, Eigen::MatrixXd& K) const {
  for (Eigen::Index j = 0; j < X.cols(); ++j)
    for (Eigen::Index i = 0; i < X.rows(); ++i) {
      const int r = static_cast<int>(i);
      const int c = static_cast<int>(j);
      X(i, j) = H_(r, c)[lane] * (ops_.inverse_scale(r) * ops_.inverse_scale(c));
    }
  // Kᵀ = Y L⁻¹ in scaled states
  for (Eigen::Index j = 0; j < K.cols(); ++j)
    for (Eigen::Index i = 0; i < K.rows(); ++i) {
      double sum = 0;
      for (int k = static_cast<int>(i); k < static_cast<int>(K.rows()); ++k)
        sum += Y_(static_cast<int>(j), k)[lane] * inverse_(k, static_cast<int>(i))[lane];
      K(i, j) = sum * ops_.inverse_scale(static_cast<int>(j));
    }
}

}  // namespace quadtune::internal
