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
  if (continuous_ && !start_continuous(ops_.speed(A_tilde_, G_, Q_tilde_))) return false;
  if (!continuous_) start_discrete();
  return iterate(max_iterations, kTolerance, iterations_) && polish();
}

/// Loads A, B, Q, R, N, and computes Ã, Q̃ of the problem without cross term and G = B R⁻¹ Bᵀ.
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
  ops_.multiply_nt(B_, Linv_, Bs_);  // Bs = B L⁻ᵀ, so that G = Bs Bsᵀ
  ops_.multiply_nt(Bs_, Bs_, G_);
  A_tilde_ = A_;
  Q_tilde_ = Q_;
  if (cross_) {
    ops_.multiply_nt(N_, Linv_, Ns_);
    ops_.subtract_product_nt(Bs_, Ns_, A_tilde_);  // A - B R⁻¹ Nᵀ
    ops_.subtract_product_nt(Ns_, Ns_, Q_tilde_);  // Q - N R⁻¹ Nᵀ
  }
  return true;
}

void LaneDoubling::scale() {
  ops_.balance(A_tilde_, G_, Q_tilde_);
  for (Square* M : {&A_tilde_, &A_}) ops_.scale_square(*M, -1, 1);
  for (Square* M : {&Q_tilde_, &Q_}) ops_.scale_square(*M, 1, 1);
  ops_.scale_square(G_, -1, -1);
  for (Panel* M : {&B_, &Bs_}) ops_.scale_panel(*M, -1);
  if (cross_)
    for (Panel* M : {&N_, &Ns_}) ops_.scale_panel(*M, 1);
}

LaneResidual LaneDoubling::evaluate() {
  if (continuous_) {
    // Y = X B L⁻ᵀ + N L⁻ᵀ
    ops_.multiply(H_, Bs_, Y_);
    if (cross_) Y_ += Ns_;
    Bh_ = Bs_;
    inverse_ = Linv_;
    // residual = AᵀX + XA - Y Yᵀ + Q
    ops_.multiply_tn(A_, H_, T_);
    ops_.multiply_nt(Y_, Y_, U_);
    return ops_.measure(
        [this](int i, int j) {
          return std::array{T_(i, j), T_(j, i), -U_(i, j), Q_(i, j)};
        },
        residual_);
  }
  // S = R + BᵀXB = L Lᵀ
  ops_.multiply(H_, B_, XB_);
  ops_.multiply_tn(B_, XB_, S_);
  S_ += R_;
  if (!ops_.invert_cholesky(S_, inverse_)) return {};
  // Y = (AᵀXB + N) L⁻ᵀ
  ops_.multiply_tn(A_, XB_, Kt_);
  if (cross_) Kt_ += N_;
  ops_.multiply_nt(Kt_, inverse_, Y_);
  ops_.multiply_nt(B_, inverse_, Bh_);
  // residual = AᵀXA - X - Y Yᵀ + Q
  ops_.multiply(H_, A_, V_);
  ops_.multiply_tn(A_, V_, T_);
  ops_.multiply_nt(Y_, Y_, U_);
  return ops_.measure(
      [this](int i, int j) {
        return std::array{T_(i, j), -H_(i, j), -U_(i, j), Q_(i, j)};
      },
      residual_);
}

bool LaneDoubling::polish() {
  Square& X = H_;
  Square& X_before = G_;
  residual_of_ = evaluate();
  bool pays = true;  // whether the previous step halved the residual
  for (int step = 0;; ++step) {
    const double worst = largest(residual_of_.worst);
    if (std::isnan(worst)) return false;
    const bool refine = pays && worst > kWorthRefining && step < kMaxNewtonSteps;
    if (!prove_stable(refine)) return false;
    if (!refine) return true;
    X_before = X;  // the proof is about this X
    LaneOps::add_symmetric(correction_, X);
    const LaneResidual then = evaluate();
    const double refined = largest(then.worst);
    if (!(refined < worst)) {
      X = X_before;
      residual_of_ = evaluate();
      return true;
    }
    residual_of_ = then;
    pays = refined <= 0.5 * worst;
  }
}

/// Computes E = A - B K or, continuous, its Cayley transform I + 2γ F with F = (A - B K - γI)⁻¹.
bool LaneDoubling::close_loop() {
  E_ = A_;
  ops_.subtract_product_nt(Bh_, Y_, E_);
  ops_.set_padding(E_, continuous_ ? -gamma_ : 0);
  if (!continuous_) return true;
  ops_.add_diagonal(E_, -gamma_);
  if (!ops_.factor(E_)) return false;
  ops_.set_identity(F_);
  ops_.solve(F_);  // F = (A - B K - γI)⁻¹
  E_ = F_;
  E_ *= 2 * gamma_;
  ops_.add_diagonal(E_, 1);
  return true;
}

bool LaneDoubling::prove_stable(bool refine) {
  if (!close_loop()) return false;
  if (refine) {
    // First term of Σ (Eᵏ)ᵀ M₀ Eᵏ that solves the closed loop's Lyapunov equation: 2γ Fᵀ M F, or M.
    correction_ = residual_;
    if (continuous_) {
      ops_.multiply(correction_, F_, T_);
      ops_.multiply_tn(F_, T_, correction_);
      correction_ *= 2 * gamma_;
    }
  }
  const double small = refine ? kVanished : kContracts;
  for (int i = 0; i < kMaxSquarings; ++i) {
    const Lane size = square_root(LaneOps::squared_norm(E_));
    bool decided = true;
    for (int lane = 0; lane < kLaneCount; ++lane) {
      const double norm = size[lane];
      stable_[static_cast<std::size_t>(lane)] = norm <= small;
      decided = decided && !(norm > small && norm < 1e100);  // NaN counts as decided
    }
    if (decided) return true;
    if (refine) {
      ops_.multiply(correction_, E_, T_);
      ops_.add_product_tn(E_, T_, correction_);
    }
    ops_.multiply(E_, E_, T_);
    swap(E_, T_);
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
