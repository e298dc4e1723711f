// SPDX-License-Identifier: Apache-2.0
#include "least_norm.hpp"

#include <Eigen/QR>
#include <vector>

namespace quadtune::internal {
namespace {

using Decomposition = Eigen::CompleteOrthogonalDecomposition<Eigen::MatrixXd>;

Decomposition decompose(const Eigen::MatrixXd& C) {
  Decomposition decomposition;
  decomposition.setThreshold(kRankTolerance);
  decomposition.compute(C);
  return decomposition;
}

// Dykstra's method identifies the active bounds; solving for the free entries makes them exact to
// rounding.
Eigen::VectorXd solve_free_entries(const Eigen::MatrixXd& C, const Eigen::VectorXd& d,
                                   const Eigen::VectorXd& low, const Eigen::VectorXd& high,
                                   const Eigen::VectorXd& near) {
  std::vector<Eigen::Index> free;
  for (Eigen::Index i = 0; i < near.size(); ++i)
    if (near(i) > low(i) && near(i) < high(i)) free.push_back(i);
  if (free.empty()) return near;
  Eigen::VectorXd f = near;
  f(free).setZero();
  const Eigen::MatrixXd C_free = C(Eigen::all, free);
  f(free) = least_norm(C_free, d - C * f);
  const bool better = (C * f - d).norm() <= (C * near - d).norm();
  const bool inside = (f.array() >= low.array()).all() && (f.array() <= high.array()).all();
  return better && inside ? f : near;
}

}  // namespace

Eigen::VectorXd least_norm(const Eigen::MatrixXd& C, const Eigen::VectorXd& d) {
  return decompose(C).solve(d);
}

// Boyle and Dykstra 1986: alternating projections on the plane C f = d and on the bounds, where the
// last correction of the bounds is undone before each projection, converge to the projection of the
// start on the intersection. From 0 this is the vector of least norm.
Eigen::VectorXd bounded_least_norm(const Eigen::MatrixXd& C, const Eigen::VectorXd& d,
                                   const Eigen::VectorXd& low, const Eigen::VectorXd& high) {
  constexpr int kMaxSweeps = 5000;
  constexpr double kStill = 1e-13;
  const Decomposition plane = decompose(C);
  Eigen::VectorXd f = Eigen::VectorXd::Zero(C.cols());
  Eigen::VectorXd correction = f;
  for (int sweep = 0; sweep < kMaxSweeps; ++sweep) {
    const Eigen::VectorXd on_plane = f - plane.solve(C * f - d);
    const Eigen::VectorXd next = (on_plane + correction).cwiseMax(low).cwiseMin(high);
    correction += on_plane - next;
    const bool still = (next - f).norm() <= kStill * (1 + next.norm()) && sweep > 0;
    f = next;
    if (still) break;
  }
  return solve_free_entries(C, d, low, high, f);
}

}  // namespace quadtune::internal
