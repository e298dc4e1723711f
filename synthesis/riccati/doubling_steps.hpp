// SPDX-License-Identifier: Apache-2.0
/// The steps of structure-preserving doubling for both Riccati equations: Chu, Fan, Lin, Wang 2004
/// (discrete) and Chu, Fan, Lin 2005 (continuous). In scaled states and without cross term,
///
///     continuous  ÃᵀX + XÃ - XGX + Q̃ = 0,    discrete  X = ÃᵀX (I + GX)⁻¹ Ã + Q̃,    G = B R⁻¹ Bᵀ
///
/// What each matrix holds. The papers' A_k is E_k here.
///
/// | matrix   | cayley(γ), continuous only                  | step k of iterate()              |
/// |----------|---------------------------------------------|----------------------------------|
/// | A_tilde_ | Ã                                           | –                                |
/// | Q_tilde_ | Q̃                                           | –                                |
/// | E_       | out: E₀                                     | E_k, then E_{k+1}                |
/// | G_       | G, kept in case γ must be changed           | G_k, then G_{k+1}                |
/// | H_       | Q̃ A_γ⁻¹, then W⁻¹ Q̃ A_γ⁻¹, then out: H₀     | H_k, then H_{k+1}; in the end X  |
/// | G0_      | out: G₀                                     | –                                |
/// | W_       | A_γ, then W                                 | I + G_k H_k                      |
/// | V_       | A_γ⁻¹, then W⁻¹                             | (I + G_k H_k)⁻¹ E_k              |
/// | U_       | A_γ⁻¹ G                                     | (I + G_k H_k)⁻¹ G_k              |
/// | T_       | an intermediate product                     | an intermediate product          |
#pragma once

#include <Eigen/Core>
#include <algorithm>
#include <cmath>
#include <limits>

namespace quadtune::internal {

/// @tparam Ops  the arithmetic: KernelOps or LaneOps. Ops::factor(M) factors M, solve(X) then sets
///              X ← M⁻¹ X.
template <class Ops>
class DoublingSteps {
 protected:
  using Square = typename Ops::Square;

  DoublingSteps(Eigen::Index nx, Eigen::Index nu) : ops_(nx, nu) {}

  /// Computes E₀, G₀, H₀ by the Cayley transform of the Hamiltonian matrix [Ã -G; -Q̃ -Ãᵀ] at γ. If
  /// γ is close to one of its eigenvalues, A_γ or W is ill-conditioned, and another γ is tried.
  bool start_continuous(double gamma) {
    gamma_ = gamma;
    if (!(gamma_ > 0) || !std::isfinite(gamma_)) return false;
    double best_gamma = gamma_;
    double best = std::numeric_limits<double>::infinity();
    for (const double factor : {1.0, 1.6, 0.62, 2.7, 0.37, 5.0, 0.2}) {
      const double condition = cayley(gamma_ * factor);
      if (condition < best) {
        best = condition;
        best_gamma = gamma_ * factor;
      }
      if (condition < kGoodCondition) break;
    }
    if (!std::isfinite(best)) return false;
    if (best >= kGoodCondition) cayley(best_gamma);
    gamma_ = best_gamma;
    swap(G_, G0_);
    return true;
  }

  /// With A_γ = Ã - γI and W = A_γᵀ + Q̃ A_γ⁻¹ G:
  /// E₀ = I + 2γ W⁻ᵀ, G₀ = 2γ A_γ⁻¹ G W⁻¹, H₀ = 2γ W⁻¹ Q̃ A_γ⁻¹.
  /// @return  the larger of the conditions of A_γ and W, 1-norm; infinite if one is singular
  double cayley(double gamma) {
    const double infinite = std::numeric_limits<double>::infinity();
    ops_.set_padding(A_tilde_, -gamma);
    // V = A_γ⁻¹
    W_ = A_tilde_;
    ops_.add_diagonal(W_, -gamma);
    const double norm_A = ops_.norm1(W_);
    if (!ops_.factor(W_)) return infinite;
    ops_.set_identity(V_);
    ops_.solve(V_);
    const double condition_A = norm_A * ops_.norm1(V_);
    ops_.multiply(Q_tilde_, V_, H_);  // H = Q̃ A_γ⁻¹
    ops_.multiply(V_, G_, U_);        // U = A_γ⁻¹ G
    // W = A_γᵀ + Q̃ A_γ⁻¹ G
    ops_.multiply(H_, G_, T_);
    ops_.transpose(A_tilde_, W_);
    ops_.add_diagonal(W_, -gamma);
    W_ += T_;
    const double norm_W = ops_.norm1(W_);
    if (!ops_.factor(W_)) return infinite;
    ops_.set_identity(V_);
    ops_.solve(V_);  // V = W⁻¹
    ops_.solve(H_);  // H = W⁻¹ Q̃ A_γ⁻¹
    const double condition = std::max(condition_A, norm_W * ops_.norm1(V_));
    if (!std::isfinite(condition)) return infinite;
    // G₀ = 2γ A_γ⁻¹ G W⁻¹, symmetric up to rounding
    ops_.multiply(U_, V_, T_);
    ops_.scaled_symmetric(T_, 2 * gamma, G0_);
    // H₀ = 2γ W⁻¹ Q̃ A_γ⁻¹, likewise
    T_ = H_;
    ops_.scaled_symmetric(T_, 2 * gamma, H_);
    // E₀ = I + 2γ W⁻ᵀ
    ops_.transpose(V_, E_);
    E_ *= 2 * gamma;
    ops_.add_diagonal(E_, 1);
    return condition;
  }

  /// E₀ = Ã, G₀ = G, H₀ = Q̃
  void start_discrete() {
    ops_.set_padding(A_tilde_, 0);
    E_ = A_tilde_;
    ops_.scaled_symmetric(Q_tilde_, 1, H_);
  }

  /// Doubles until the relative change of H_k is less than `tolerance`. Convergence is quadratic:
  /// the next change would be approximately its square.
  bool iterate(int max_iterations, double tolerance, int& iterations) {
    for (iterations = 1; iterations <= max_iterations; ++iterations) {
      // V = (I + G_k H_k)⁻¹ E_k
      ops_.multiply(G_, H_, W_);
      ops_.add_diagonal(W_, 1);
      if (!ops_.factor(W_)) return false;
      V_ = E_;
      ops_.solve(V_);
      // H_{k+1} = H_k + E_kᵀ H_k (I + G_k H_k)⁻¹ E_k
      ops_.multiply(H_, V_, T_);
      const auto [change, size] = ops_.add_product_tn(E_, T_, H_);
      if (!std::isfinite(size)) return false;
      if (change <= tolerance * size) return true;
      // G_{k+1} = G_k + E_k (I + G_k H_k)⁻¹ G_k E_kᵀ
      U_ = G_;
      ops_.solve(U_);
      ops_.multiply(E_, U_, T_);
      ops_.add_product_nt(T_, E_, G_);
      // E_{k+1} = E_k (I + G_k H_k)⁻¹ E_k
      ops_.multiply(E_, V_, T_);
      swap(E_, T_);
    }
    return false;
  }

  static constexpr double kGoodCondition = 1e6;

  Ops ops_;
  double gamma_ = 1;
  Square A_tilde_ = ops_.square(), Q_tilde_ = ops_.square();
  Square E_ = ops_.square(), G_ = ops_.square(), H_ = ops_.square(), W_ = ops_.square();
  Square T_ = ops_.square(), U_ = ops_.square(), V_ = ops_.square(), G0_ = ops_.square();
};

}  // namespace quadtune::internal
