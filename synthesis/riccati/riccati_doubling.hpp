// SPDX-License-Identifier: Apache-2.0
/// Structure-preserving doubling for both Riccati equations, written once over the kernels that do
/// the arithmetic (`Ops`: sizes known to the compiler, or not).
///
/// In scaled states z, x = D z. The closed loop's Lyapunov equation, solved by squaring (Smith
/// 1968), gives the Newton step; that its powers vanish is the proof that X is stabilizing.
#pragma once

#include <Eigen/Core>
#include <cmath>

#include "riccati/doubling_steps.hpp"
#include "riccati/riccati_parts.hpp"
#include "riccati/riccati_scaling.hpp"

namespace quadtune::internal {

template <class Ops>
class Doubling : public DoublingSolver, protected DoublingSteps<Ops> {
 public:
  Doubling(Eigen::Index nx, Eigen::Index nu) : Steps(nx, nu) {}

  bool solve(const RiccatiEquation& problem, const Eigen::MatrixXd& factor_R,
             const RiccatiOptions& options, Candidate& found, SquaredNorms& norms) override {
    load(problem, factor_R);
    return solve_loaded(problem.time == Time::continuous, options, found, norms);
  }

 protected:
  using Steps = DoublingSteps<Ops>;
  using Square = typename Ops::Square;
  using Panel = typename Ops::Panel;
  using Steps::At_, Steps::Qt_, Steps::E_, Steps::G_, Steps::H_, Steps::T_, Steps::U_, Steps::next_,
      Steps::V_, Steps::gamma_, Steps::ops_;

  bool solve_loaded(bool continuous, const RiccatiOptions& options, Candidate& found,
                    SquaredNorms& norms) {
    if (continuous && !Steps::start_continuous(ops_.speed(At_, G_, Qt_))) return false;
    if (!continuous) Steps::start_discrete();
    if (!Steps::iterate(options.max_iterations, kStands, found.iterations)) return false;
    return polish(continuous, found, norms);
  }

  /// Fills the scaled matrices: A, B, Q, N as given; A_, Q_ of the problem without cross term.
  void load(const RiccatiEquation& problem, const Eigen::MatrixXd& factor_R) {
    cross_ = problem.has_cross_term();
    ops_.load_square(problem.A, A_);
    ops_.load_square(problem.Q, T_);
    ops_.scaled_symmetric(T_, 1, Q_);
    ops_.load_panel(problem.B, B_);
    ops_.load_small(problem.R, R_);
    ops_.invert_factor(factor_R, Linv_);
    ops_.times_small_transposed(B_, Linv_, Bs_);  // Bs = B L⁻ᵀ, so that G = Bs Bsᵀ
    ops_.outer(Bs_, G_);
    if (cross_) {
      ops_.load_panel(problem.N, N_);
      ops_.times_small_transposed(N_, Linv_, Ns_);
      ops_.outer(Bs_, Ns_, T_);
      ops_.subtract(A_, T_, At_);  // A - B R⁻¹ Nᵀ
      ops_.outer(Ns_, T_);
      ops_.subtract(Q_, T_, Qt_);  // Q - N R⁻¹ Nᵀ
    } else {
      ops_.copy(A_, At_);
      ops_.copy(Q_, Qt_);
    }
    norm_A_ = ops_.norm_frobenius(At_);
    norm_G_ = ops_.norm_frobenius(G_);
    norm_Q_ = ops_.norm_frobenius(Qt_);
    ops_.balance(At_, G_, Qt_);
    ops_.scale_square(At_, -1, 1);
    ops_.scale_square(G_, -1, -1);
    ops_.scale_square(Qt_, 1, 1);
    ops_.scale_panel(B_, -1);
    ops_.scale_panel(Bs_, -1);
    if (cross_) {
      ops_.scale_square(A_, -1, 1);
      ops_.scale_square(Q_, 1, 1);
      ops_.scale_panel(N_, 1);
      ops_.scale_panel(Ns_, 1);
    } else {
      ops_.copy(At_, A_);
      ops_.copy(Qt_, Q_);
    }
  }

  /// Judges X = H; takes Newton steps while they pay; writes X, K and the residual back.
  bool polish(bool continuous, Candidate& found, SquaredNorms& norms) {
    Residual now = residual(continuous);
    if (!std::isfinite(now.worst())) return false;
    for (int step = 0;; ++step) {
      const bool refine = now.worst() > worth_refining_ && step < kMaxNewtonSteps;
      if (!prove_stable(continuous, refine)) return false;
      if (!refine) break;
      ops_.copy(H_, G_);  // to go back to
      ops_.add_symmetric(correction_, H_);
      const Residual then = residual(continuous);
      if (!(then.worst() < now.worst())) {
        ops_.copy(G_, H_);
        now = residual(continuous);
        break;
      }
      const bool paid = then.worst() < 0.5 * now.worst();
      now = then;
      if ((!paid || now.worst() <= worth_refining_) && proof_covers_correction(continuous)) break;
      if (!paid) step = kMaxNewtonSteps;
    }
    publish(continuous, now, found, norms);
    return true;
  }

  void publish(bool continuous, const Residual& of_X, Candidate& found, SquaredNorms& norms) {
    fill_norms(of_X, norms);
    ops_.times_small(Y_, continuous ? Linv_ : Sinv_, Kt_);
    ops_.store_solution(H_, Kt_, found.X, found.K);
  }

  /// Leaves the residual matrix in residual_, Y_ with Y Yᵀ the quadratic term, and, for the
  /// discrete equation, B K's factor; all by the caller's data, scaled by exact powers of two.
  Residual residual(bool continuous) {
    ops_.panel(H_, B_, XB_);
    if (continuous) {
      // Y = X Bs + Ns; residual = AᵀX + XA - Y Yᵀ + Q
      ops_.times_small_transposed(XB_, Linv_, Y_);
      if (cross_) ops_.add_panel(Y_, Ns_);
      ops_.multiply_transposed(A_, H_, T_);
      ops_.outer(Y_, U_);
      return ops_.residual_continuous(T_, U_, Q_, residual_);
    }
    // S = R + BᵀXB, F = BᵀXA + Nᵀ, Y = Fᵀ L⁻ᵀ with L Lᵀ = S; residual = AᵀXA - X - Y Yᵀ + Q
    if (!ops_.invert_inner(R_, B_, XB_, Sinv_)) return {};
    ops_.panel_transposed(A_, XB_, Kt_);
    if (cross_) ops_.add_panel(Kt_, N_);
    ops_.times_small_transposed(Kt_, Sinv_, Y_);
    ops_.multiply(H_, A_, V_);
    ops_.multiply_transposed(A_, V_, T_);
    ops_.outer(Y_, U_);
    return ops_.residual_discrete(T_, H_, U_, Q_, residual_);
  }

  /// B K of the present X into BK.
  void feedback(bool continuous, Square& BK) {
    if (!continuous) ops_.times_small(Y_, Sinv_, Kt_);
    ops_.outer(continuous ? Bs_ : B_, continuous ? Y_ : Kt_, BK);
  }

  /// Leaves in E_ the closed loop A - B K, or, continuous, its Cayley transform I + 2γ F with
  /// F = (A - B K - γI)⁻¹ left in F_. All poles are stable exactly when the powers of E_ vanish.
  bool close_loop(bool continuous) {
    feedback(continuous, BK_);
    ops_.subtract(A_, BK_, E_);
    if (!continuous) return true;
    ops_.add_diagonal(E_, -gamma_);
    ops_.set_padding(E_, -2 * gamma_);
    if (!ops_.factor(E_)) return false;
    ops_.identity(F_);
    ops_.solve(F_);
    ops_.copy(F_, E_);
    ops_.multiply_by(E_, 2 * gamma_);
    ops_.add_diagonal(E_, 1);
    return true;
  }

  /// First term of the sum Σ (Eᵏ)ᵀ M₀ Eᵏ that solves the closed loop's Lyapunov equation for M:
  /// M₀ = 2γ Fᵀ M F, or M itself when discrete.
  void start_sum(bool continuous, Square& M) {
    if (!continuous) return;
    ops_.multiply(M, F_, T_);
    ops_.multiply_transposed(F_, T_, M);
    ops_.multiply_by(M, 2 * gamma_);
  }

  /// Doubles the number of terms of the sum: M ← M + Eᵀ M E.
  void double_sum(Square& M) {
    ops_.multiply(M, E_, T_);
    ops_.add_product_tn(E_, T_, M);
  }

  /// Right sides of the Lyapunov equations that the condition is estimated from: I into h0_, X²
  /// (discrete AcᵀX²Ac, Ac in E_) into h2_, in the caller's units.
  void load_norm_sums(bool continuous) {
    ops_.squared_scales(h0_);  // D I D
    ops_.divide_rows_twice(H_, T_);
    ops_.multiply(H_, T_, h2_);  // D X² D = X_z D⁻² X_z
    if (!continuous) {
      ops_.multiply(h2_, E_, T_);
      ops_.multiply_transposed(E_, T_, h2_);
    }
  }

  /// Proves X stabilizing by squaring E_ until it is small. The same powers solve the closed loop's
  /// Lyapunov equation for h0_, h2_ and, with `refine`, Newton's correction of X.
  bool prove_stable(bool continuous, bool refine) {
    if (!close_loop(continuous)) return false;
    load_norm_sums(continuous);
    start_sum(continuous, h0_);
    start_sum(continuous, h2_);
    if (refine) {
      ops_.copy(residual_, correction_);
      start_sum(continuous, correction_);
    }
    for (int i = 0; i < kMaxSquarings; ++i) {
      const double size = ops_.norm_frobenius(E_);
      if (!(size < 1e100)) return false;
      if (size <= kVanished) return true;
      double_sum(h0_);
      double_sum(h2_);
      if (refine) double_sum(correction_);
      ops_.multiply(E_, E_, T_);
      ops_.swap(E_, T_);
    }
    return false;
  }

  /// Whether xᵀ h₀ x, a Lyapunov function of the closed loop before the correction, is one of the
  /// closed loop after it: with dA the difference, h₀ dA (discrete (Ac + dA)ᵀ h₀ dA) must be small
  /// against the I that h₀ was made for.
  bool proof_covers_correction(bool continuous) {
    feedback(continuous, T_);
    ops_.subtract(BK_, T_, U_);  // dA
    ops_.multiply(h0_, U_, V_);
    if (!continuous) {
      ops_.subtract(A_, T_, E_);
      ops_.multiply_transposed(E_, V_, T_);
      ops_.swap(T_, V_);
    }
    return ops_.weighted_norm(V_) < 0.05;
  }

  void fill_norms(const Residual& of_X, SquaredNorms& norms) const {
    norms.residual = of_X.squared;
    norms.terms = of_X.squared_terms;
    norms.A = squared(norm_A_);
    norms.G = squared(norm_G_);
    norms.Q = squared(norm_Q_);
    norms.X = squared(ops_.weighted_norm(H_));
    norms.h0 = squared(ops_.weighted_norm(h0_));
    norms.h2 = squared(ops_.weighted_norm(h2_));
  }

  static double squared(double x) { return x * x; }

  /// Norm of the powers at which the sums are exact to its square.
  static constexpr double kVanished = 0.03;
  /// Change of H after which the next one is lost in rounding.
  static constexpr double kStands = 1e-8;
  static constexpr int kMaxNewtonSteps = 8;
  static constexpr int kMaxSquarings = 45;

  /// Below this residual, which rounding leaves in sums of so many terms, a step cannot pay.
  double worth_refining_ = std::max(4e-15, 5e-17 * static_cast<double>(ops_.size()));
  bool cross_ = false;
  double norm_A_ = 0;
  double norm_G_ = 0;
  double norm_Q_ = 0;
  Square A_ = ops_.square(), Q_ = ops_.square();
  Square residual_ = ops_.square(), correction_ = ops_.square(), F_ = ops_.square();
  Square BK_ = ops_.square(), h0_ = ops_.square(), h2_ = ops_.square();
  Panel B_ = ops_.panel(), Bs_ = ops_.panel(), N_ = ops_.panel(), Ns_ = ops_.panel();
  Panel XB_ = ops_.panel(), Y_ = ops_.panel(), Kt_ = ops_.panel();
  Panel R_ = ops_.small(), Linv_ = ops_.small(), Sinv_ = ops_.small();
};

}  // namespace quadtune::internal
