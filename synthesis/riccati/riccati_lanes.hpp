// SPDX-License-Identifier: Apache-2.0
/// Solves one Riccati equation in each lane simultaneously by structure-preserving doubling, with
/// Newton steps, residuals and a proof that each closed loop is stable.
///
/// The matrices are those of riccati_doubling.hpp, which explains the steps, except for
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

  /// Solves all problems.
  /// @param problems  validated, all continuous or all discrete; all with or all without a cross
  ///                  term
  /// @return          false if the common algorithm fails in any lane
  bool solve(Time time, const std::array<const RiccatiMatrices*, kLaneCount>& problems,
             int max_iterations);

  /// Whether the closed loop of this lane is proved to be stable.
  [[nodiscard]] bool stable(int lane) const { return stable_[static_cast<std::size_t>(lane)]; }
  /// The residual relative to the sum of the norms of the terms, in the caller's units.
  [[nodiscard]] double residual(int lane) const { return residual_of_.relative[lane]; }
  [[nodiscard]] int iterations() const { return iterations_; }
  /// Writes X and K in the caller's units to matrices of the correct sizes.
  void store(int lane, Eigen::MatrixXd& X, Eigen::MatrixXd& K) const;

 private:
  using Square = LaneOps::Square;
  using Panel = LaneOps::Panel;

  bool load(const std::array<const RiccatiMatrices*, kLaneCount>& problems);
  void scale();
  bool polish();
  /// Computes the residual matrix at X in residual_, and Y_, Bh_ and inverse_. NaN if S of any lane
  /// is not positive definite.
  LaneResidual evaluate();
  /// Squares the map of the closed loop until it is small in every lane. With `refine`, the same
  /// powers yield Newton's correction of X. False if the map cannot be computed.
  bool prove_stable(bool refine);
  bool close_loop();

  /// Norm of a power of the map below which a lane is stable, since further powers converge to 0.
  static constexpr double kContracts = 0.5;
  /// Norm of a power at which the relative error of the correction is its square.
  static constexpr double kVanished = 0.03;
  /// Same as in riccati_doubling.hpp.
  static constexpr double kTolerance = 1e-8;
  /// Doubling without pivoting leaves residuals of 1e-15 to 1e-14; a Newton step costs a quarter of
  /// it.
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
