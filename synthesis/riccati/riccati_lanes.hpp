// SPDX-License-Identifier: Apache-2.0
/// One Riccati equation in each lane, all at once, by structure-preserving doubling, with Newton
/// steps, residuals and the proof that each closed loop is stable.
///
/// Matrices as in riccati_doubling.hpp, which explains the steps, but for
///
/// | matrix   | content                                                                       |
/// |----------|-------------------------------------------------------------------------------|
/// | inverse_ | L⁻¹ with L Lᵀ = R, discrete S = R + BᵀXB, so that Kᵀ = Y L⁻¹                  |
/// | Bh_      | B L⁻ᵀ with the same L, so that B K = Bh Yᵀ                                    |
/// | S_       | discrete only: S                                                              |
/// | Kt_      | discrete only: AᵀXB + N                                                       |
#pragma once

#include <Eigen/Core>
#include <array>

#include "quadtune/synthesis/riccati_batch.hpp"
#include "riccati/doubling_steps.hpp"
#include "riccati/lane_ops.hpp"
#include "riccati/riccati_parts.hpp"

namespace quadtune::internal {

class LaneDoubling : DoublingSteps<LaneOps> {
 public:
  LaneDoubling(Eigen::Index nx, Eigen::Index nu);

  /// @param problems  checked, of one time; all with or all without a cross term
  /// @return          false when the lanes could not be carried to an end together
  bool solve(Time time, const std::array<const RiccatiMatrices*, kLaneCount>& problems,
             int max_iterations);

  /// Whether this lane's closed loop was proved stable.
  [[nodiscard]] bool stable(int lane) const { return stable_[static_cast<std::size_t>(lane)]; }
  /// Relative to the sum of the norms of the terms, in the caller's units.
  [[nodiscard]] double residual(int lane) const { return residual_of_.relative[lane]; }
  [[nodiscard]] int iterations() const { return iterations_; }
  /// X and K in the caller's units, into matrices of the right sizes.
  void store(int lane, Eigen::MatrixXd& X, Eigen::MatrixXd& K) const;

 private:
  using Square = LaneOps::Square;
  using Panel = LaneOps::Panel;

  bool load(const std::array<const RiccatiMatrices*, kLaneCount>& problems);
  void scale();
  bool polish();
  /// The residual matrix at X into residual_, with Y_, Bh_ and inverse_. NaN if S of some lane is
  /// not positive definite.
  LaneResidual evaluate();
  /// Squares the closed loop's map until it is small in every lane; with `refine` the same powers
  /// give Newton's correction of X. False when the map cannot be formed.
  bool prove_stable(bool refine);
  bool close_loop();

  /// Norm of the map of stable lanes that stand for themselves; powers of it vanish.
  static constexpr double kContracts = 0.5;
  /// Norm at which the sums of the correction are exact to its square.
  static constexpr double kVanished = 0.03;
  /// As in riccati_doubling.hpp.
  static constexpr double kTolerance = 1e-8;
  /// Doubling without pivots leaves some 1e-15 to 1e-14; a Newton step costs a quarter of it.
  static constexpr double kWorthRefining = 2e-14;
  static constexpr int kMaxNewtonSteps = 3;
  static constexpr int kMaxSquarings = 45;

  bool continuous_ = true;
  bool cross_ = false;
  int iterations_ = 0;
  LaneResidual residual_of_;
  std::array<bool, kLaneCount> stable_{};
  Square A_ = ops_.square(), Q_ = ops_.square();
  Square residual_ = ops_.square(), correction_ = ops_.square(), F_ = ops_.square();
  Panel B_ = ops_.panel(), Bs_ = ops_.panel(), Bh_ = ops_.panel();
  Panel N_ = ops_.panel(), Ns_ = ops_.panel();
  Panel XB_ = ops_.panel(), Y_ = ops_.panel(), Kt_ = ops_.panel();
  Panel R_ = ops_.small(), S_ = ops_.small(), Linv_ = ops_.small(), inverse_ = ops_.small();
};

}  // namespace quadtune::internal
