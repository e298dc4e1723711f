// SPDX-License-Identifier: Apache-2.0
/// Solves both Riccati equations by structure-preserving doubling, then by Newton's method, and
/// proves the solution stabilizing. The arithmetic is a template parameter (`Ops`).
///
/// All matrices are in scaled states z, x = D z. A Newton step solves the Lyapunov equation of the
/// closed loop by squaring (Smith 1968); the convergence of the powers to 0 proves that X is
/// stabilizing.
///
/// What each matrix holds after the doubling; L Lᵀ = R, and M is the right side of a Lyapunov
/// equation A_cᵀΔ + ΔA_c + M = 0 (discrete A_cᵀΔA_c - Δ + M = 0), A_c = A - B K.
///
/// | matrix           | content                                                               |
/// |------------------|-----------------------------------------------------------------------|
/// | A_, B_, Q_, N_   | the caller's matrices, scaled; R_ is not scaled                       |
/// | Linv_, Bs_, Ns_  | L⁻¹, B L⁻ᵀ, N L⁻ᵀ                                                     |
/// | H_               | X                                                                     |
/// | G_               | the X before a Newton step                                            |
/// | XB_              | X B                                                                   |
/// | Sinv_            | discrete only: inverse of the Cholesky factor of S = R + BᵀXB         |
/// | Y_               | Y Yᵀ = KᵀSK (continuous KᵀRK), the quadratic term of the equation     |
/// | Kt_              | discrete BᵀXA + Nᵀ, transposed, then Kᵀ; continuous Kᵀ at the end     |
/// | residual_        | residual matrix of the equation at X                                  |
/// | BK_              | B K of the X that is proved to be stabilizing                         |
/// | F_               | continuous only: (A_c - γI)⁻¹                                         |
/// | E_               | S₀ = I + 2γ F (discrete A_c), then its powers S₀², S₀⁴, …             |
/// | h0_, h2_         | M = I and M = X² (discrete A_cᵀX²A_c), then the solutions Δ           |
/// | correction_      | M = residual_, then the solution Δ, Newton's correction of X          |
/// | T_, U_, V_       | intermediate products                                                 |
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
  using Steps::A_tilde_, Steps::Q_tilde_, Steps::E_, Steps::G_, Steps::H_, Steps::T_, Steps::U_,
      Steps::V_, Steps::gamma_, Steps::ops_;

  bool solve_loaded(bool continuous, const RiccatiOptions& options, Candidate& found,
                    SquaredNorms& norms) {
    if (continuous && !Steps::start_continuous(ops_.speed(A_tilde_, G_, Q_tilde_))) return false;
    if (!continuous) Steps::start_discrete();
    if (!Steps::iterate(options.max_iterations, kTolerance, found.iterations)) return false;
    return polish(continuous, found, norms);
  }

  /// Fills the scaled matrices: A, B, Q, N as given; Ã, Q̃, G of the problem without cross term.
  void load(const RiccatiEquation& problem, const Eigen::MatrixXd& factor_R) {
    cross_ = problem.has_cross_term();
    ops_.load_square(problem.A, A_);
    ops_.load_square(problem.Q, T_);
    ops_.scaled_symmetric(T_, 1, Q_);
    ops_.load_panel(problem.B, B_);
    ops_.load_small(problem.R, R_);
    ops_.invert_factor(factor_R, Linv_);
    ops_.multiply_small_nt(B_, Linv_, Bs_);
    ops_.multiply_nt(Bs_, G_);  // G = B R⁻¹ Bᵀ
    if (cross_) {
      ops_.load_panel(problem.N, N_);
      ops_.multiply_small_nt(N_, Linv_, Ns_);
      ops_.multiply_nt(Bs_, Ns_, T_);
      A_tilde_.set_difference(A_, T_);  // Ã = A - B R⁻¹ Nᵀ
      ops_.multiply_nt(Ns_, T_);
      Q_tilde_.set_difference(Q_, T_);  // Q̃ = Q - N R⁻¹ Nᵀ
    } else {
      A_tilde_ = A_;
      Q_tilde_ = Q_;
    }
    norm_A_ = ops_.norm_frobenius(A_tilde_);
    norm_G_ = ops_.norm_frobenius(G_);
    norm_Q_ = ops_.norm_frobenius(Q_tilde_);
    scale();
  }

  /// D⁻¹AD, D⁻¹B, D⁻¹GD⁻¹, DQD, DN
  void scale() {
    ops_.balance(A_tilde_, G_, Q_tilde_);
    ops_.scale_square(A_tilde_, -1, 1);
    ops_.scale_square(G_, -1, -1);
    ops_.scale_square(Q_tilde_, 1, 1);
    ops_.scale_panel(B_, -1);
    ops_.scale_panel(Bs_, -1);
    if (cross_) {
      ops_.scale_square(A_, -1, 1);
      ops_.scale_square(Q_, 1, 1);
      ops_.scale_panel(N_, 1);
      ops_.scale_panel(Ns_, 1);
    } else {
      A_ = A_tilde_;
      Q_ = Q_tilde_;
    }
  }

  /// Computes the residual of X = H, refines X by Newton steps while they reduce it sufficiently,
  /// and writes X, K and the residual to `found`.
  bool polish(bool continuous, Candidate& found, SquaredNorms& norms) {
    Square& X = H_;
    Square& X_before = G_;
    Residual now = residual(continuous);
    if (!std::isfinite(now.worst())) return false;
    bool pays = true;  // whether the previous step halved the residual
    for (int step = 0;; ++step) {
      const bool refine = pays && now.worst() > worth_refining_ && step < kMaxNewtonSteps;
      if (!prove_stable(continuous, refine)) return false;
      if (!refine) break;
      X_before = X;
      ops_.add_symmetric(correction_, X);  // X ← X + Δ
      const Residual then = residual(continuous);
      if (!(then.worst() < now.worst())) {
        X = X_before;
        now = residual(continuous);
        break;
      }
      pays = then.worst() < 0.5 * now.worst();
      now = then;
      if ((!pays || now.worst() <= worth_refining_) && proof_covers_correction(continuous)) break;
    }
    publish(continuous, now, found, norms);
    return true;
  }

  void publish(bool continuous, const Residual& of_X, Candidate& found, SquaredNorms& norms) {
    fill_norms(of_X, norms);
    // Kᵀ = Y L⁻¹ with L Lᵀ = R, discrete S
    ops_.multiply_small(Y_, continuous ? Linv_ : Sinv_, Kt_);
    ops_.store_solution(H_, Kt_, found.X, found.K);
  }

  /// Computes residual_, Y_ and, for the discrete equation, Sinv_ from the caller's data, which are
  /// scaled exactly, by powers of two.
  Residual residual(bool continuous) {
    ops_.multiply_panel(H_, B_, XB_);
    if (continuous) {
      // Y = X B L⁻ᵀ + N L⁻ᵀ
      ops_.multiply_small_nt(XB_, Linv_, Y_);
      if (cross_) Y_ += Ns_;
      // residual = AᵀX + XA - Y Yᵀ + Q
      ops_.multiply_tn(A_, H_, T_);
      ops_.multiply_nt(Y_, U_);
      return ops_.residual_continuous(T_, U_, Q_, residual_);
    }
    // S = R + BᵀXB = L Lᵀ, Y = (AᵀXB + N) L⁻ᵀ
    if (!ops_.invert_inner(R_, B_, XB_, Sinv_)) return {};
    ops_.multiply_panel_tn(A_, XB_, Kt_);
    if (cross_) Kt_ += N_;
    ops_.multiply_small_nt(Kt_, Sinv_, Y_);
    // residual = AᵀXA - X - Y Yᵀ + Q
    ops_.multiply(H_, A_, V_);
    ops_.multiply_tn(A_, V_, T_);
    ops_.multiply_nt(Y_, U_);
    return ops_.residual_discrete(T_, H_, U_, Q_, residual_);
  }

  /// Computes BK = B K of the current X: B L⁻ᵀ Yᵀ (discrete B (Y L⁻¹)ᵀ).
  void feedback(bool continuous, Square& BK) {
    if (!continuous) ops_.multiply_small(Y_, Sinv_, Kt_);
    ops_.multiply_nt(continuous ? Bs_ : B_, continuous ? Y_ : Kt_, BK);
  }

  /// Computes E = A_c or, continuous, its Cayley transform I + 2γ F with F = (A_c - γI)⁻¹. All
  /// poles are stable if and only if the powers of E converge to 0.
  bool close_loop(bool continuous) {
    feedback(continuous, BK_);
    E_.set_difference(A_, BK_);  // A_c = A - B K
    if (!continuous) return true;
    ops_.add_diagonal(E_, -gamma_);
    ops_.set_padding(E_, -2 * gamma_);
    if (!ops_.factor(E_)) return false;
    ops_.set_identity(F_);
    ops_.solve(F_);  // F = (A_c - γI)⁻¹
    E_ = F_;
    E_ *= 2 * gamma_;
    ops_.add_diagonal(E_, 1);  // E = I + 2γ F
    return true;
  }

  /// M ← 2γ Fᵀ M F, the first term of the sum Σ (Eᵏ)ᵀ M₀ Eᵏ that solves the Lyapunov equation.
  /// In discrete time, the first term is M itself.
  void start_sum(bool continuous, Square& M) {
    if (!continuous) return;
    ops_.multiply(M, F_, T_);
    ops_.multiply_tn(F_, T_, M);
    M *= 2 * gamma_;
  }

  /// M ← M + Eᵀ M E, which doubles the number of terms of the sum.
  void double_sum(Square& M) {
    ops_.multiply(M, E_, T_);
    ops_.add_product_tn(E_, T_, M);
  }

  /// Sets the right-hand sides of the Lyapunov equations for the condition estimate: I and X²
  /// (discrete A_cᵀX²A_c) in the caller's units.
  void load_norm_sums(bool continuous) {
    ops_.set_squared_scales(h0_);  // D I D
    // D X² D = X_z D⁻² X_z
    ops_.divide_rows_twice(H_, T_);
    ops_.multiply(H_, T_, h2_);
    if (!continuous) {
      ops_.multiply(h2_, E_, T_);
      ops_.multiply_tn(E_, T_, h2_);
    }
  }

  /// Proves X stabilizing by squaring E until it is small. The same powers solve the Lyapunov
  /// equations for h0_, h2_ and, with `refine`, for Newton's correction of X.
  bool prove_stable(bool continuous, bool refine) {
    if (!close_loop(continuous)) return false;
    load_norm_sums(continuous);
    start_sum(continuous, h0_);
    start_sum(continuous, h2_);
    if (refine) {
      correction_ = residual_;
      start_sum(continuous, correction_);
    }
    for (int i = 0; i < kMaxSquarings; ++i) {
      const double size = ops_.norm_frobenius(E_);
      if (!(size < 1e100)) return false;
      if (size <= kVanished) return true;
      double_sum(h0_);
      double_sum(h2_);
      if (refine) double_sum(correction_);
      ops_.multiply(E_, E_, T_);  // E ← E²
      swap(E_, T_);
    }
    return false;
  }

  /// Whether xᵀ h₀ x, a Lyapunov function of the closed loop before the correction, is also one of
  /// the closed loop after it. With the difference dA of both loops, h₀ dA (discrete (A_c + dA)ᵀ h₀
  /// dA) must be small compared with the I for which h₀ was computed.
  bool proof_covers_correction(bool continuous) {
    Square& BK_now = T_;
    feedback(continuous, BK_now);
    U_.set_difference(BK_, BK_now);  // dA
    ops_.multiply(h0_, U_, V_);      // h₀ dA
    if (!continuous) {
      E_.set_difference(A_, BK_now);  // A_c + dA
      ops_.multiply_tn(E_, V_, T_);
      swap(T_, V_);
    }
    return ops_.weighted_norm(V_) < 0.05;
  }

  void fill_norms(const Residual& of_X, SquaredNorms& norms) const {
    const auto squared = [](double x) { return x * x; };
    norms.residual = of_X.squared;
    norms.terms = of_X.squared_terms;
    norms.A = squared(norm_A_);
    norms.G = squared(norm_G_);
    norms.Q = squared(norm_Q_);
    norms.X = squared(ops_.weighted_norm(H_));
    norms.h0 = squared(ops_.weighted_norm(h0_));
    norms.h2 = squared(ops_.weighted_norm(h2_));
  }

  /// Norm of a power at which the relative error of the sums is its square.
  static constexpr double kVanished = 0.03;
  /// Relative change of H after which the next change would be below rounding.
  static constexpr double kTolerance = 1e-8;
  static constexpr int kMaxNewtonSteps = 8;
  static constexpr int kMaxSquarings = 45;

  /// Residual due to rounding in sums of this length; below it, a Newton step cannot improve X.
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
