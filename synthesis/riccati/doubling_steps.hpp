// SPDX-License-Identifier: Apache-2.0
/// The steps of structure-preserving doubling for both Riccati equations: Chu, Fan, Lin 2005
/// (continuous) and Chu, Fan, Lin, Wang 2004 (discrete).
#pragma once

#include <Eigen/Core>
#include <algorithm>
#include <cmath>
#include <limits>

namespace quadtune::internal {

/// @tparam Ops  the kernels that do the arithmetic; see kernel_ops.hpp
template <class Ops>
class DoublingSteps {
 protected:
  using Square = typename Ops::Square;

  DoublingSteps(Eigen::Index nx, Eigen::Index nu) : ops_(nx, nu) {}

  /// Cayley transform of the Hamiltonian matrix at γ: E_, G_, H_ of the doubling.
  /// A γ near an eigenvalue shows in the condition of the two matrices solved with; then it moves.
  bool start_continuous(double speed) {
    gamma_ = speed;
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
    ops_.swap(G_, next_);
    return true;
  }

  /// With A_γ = A - γI and W = A_γᵀ + Q A_γ⁻¹ G:
  /// E = I + 2γ W⁻ᵀ, G = 2γ A_γ⁻¹ G W⁻¹ (left in next_), H = 2γ W⁻¹ Q A_γ⁻¹.
  /// @return  the worse of the conditions of A_γ and W, 1-norm; infinite when one is singular
  double cayley(double gamma) {
    const double infinite = std::numeric_limits<double>::infinity();
    ops_.set_padding(At_, -gamma);
    ops_.copy(At_, W_);
    ops_.add_diagonal(W_, -gamma);
    const double norm_A = ops_.norm1(W_);
    if (!ops_.factor(W_)) return infinite;
    ops_.identity(V_);
    ops_.solve(V_);  // V = A_γ⁻¹
    const double condition_A = norm_A * ops_.norm1(V_);
    ops_.multiply(Qt_, V_, H_);
    ops_.multiply(V_, G_, U_);
    ops_.multiply(H_, G_, T_);
    ops_.transpose(At_, W_);
    ops_.add_diagonal(W_, -gamma);
    ops_.add(W_, T_);
    const double norm_W = ops_.norm1(W_);
    if (!ops_.factor(W_)) return infinite;
    ops_.identity(V_);
    ops_.solve(V_);
    ops_.solve(H_);  // V = W⁻¹, H = W⁻¹ Q A_γ⁻¹
    const double condition = std::max(condition_A, norm_W * ops_.norm1(V_));
    if (!std::isfinite(condition)) return infinite;
    ops_.multiply(U_, V_, T_);
    ops_.scaled_symmetric(T_, 2 * gamma, next_);
    ops_.copy(H_, T_);
    ops_.scaled_symmetric(T_, 2 * gamma, H_);
    ops_.transpose(V_, E_);
    ops_.multiply_by(E_, 2 * gamma);
    ops_.add_diagonal(E_, 1);
    return condition;
  }

  void start_discrete() {
    ops_.set_padding(At_, 0);
    ops_.copy(At_, E_);
    ops_.scaled_symmetric(Qt_, 1, H_);
  }

  /// E ← E (I+GH)⁻¹ E, G ← G + E (I+GH)⁻¹ G Eᵀ, H ← H + Eᵀ H (I+GH)⁻¹ E until H changes by less
  /// than `stands` of it. Convergence is quadratic: the next change would be about its square.
  bool iterate(int max_iterations, double stands, int& iterations) {
    for (iterations = 1; iterations <= max_iterations; ++iterations) {
      ops_.multiply(G_, H_, W_);
      ops_.add_diagonal(W_, 1);
      if (!ops_.factor(W_)) return false;
      ops_.copy(E_, V_);
      ops_.solve(V_);  // V = (I+GH)⁻¹ E
      ops_.multiply(H_, V_, T_);
      const auto [change, size] = ops_.add_product_tn(E_, T_, H_);
      if (!std::isfinite(size)) return false;
      if (change <= stands * size) return true;
      ops_.copy(G_, U_);
      ops_.solve(U_);  // U = (I+GH)⁻¹ G
      ops_.multiply(E_, U_, T_);
      ops_.add_product_nt(T_, E_, G_);
      ops_.multiply(E_, V_, T_);
      ops_.swap(E_, T_);
    }
    return false;
  }

  static constexpr double kGoodCondition = 1e6;

  Ops ops_;
  double gamma_ = 1;
  Square At_ = ops_.square(), Qt_ = ops_.square();  ///< of the problem without cross term
  Square E_ = ops_.square(), G_ = ops_.square(), H_ = ops_.square(), W_ = ops_.square();
  Square T_ = ops_.square(), U_ = ops_.square(), V_ = ops_.square(), next_ = ops_.square();
};

}  // namespace quadtune::internal
