// SPDX-License-Identifier: Apache-2.0
#include "quadtune/discretize/tustin.hpp"

#include <fmt/format.h>

#include <Eigen/Eigenvalues>
#include <Eigen/LU>
#include <cmath>
#include <limits>

#include "period.hpp"
#include "quadtune/errors.hpp"

namespace quadtune {
namespace {

// The pole of A nearest to 2/dt, when it is so near that I - A dt/2 is singular to rounding.
void refuse_pole(const Eigen::MatrixXd& A, double dt) {
  const double forbidden = 2 / dt;
  const Eigen::VectorXcd poles = A.eigenvalues();
  Eigen::Index nearest = 0;
  const double distance =
      (poles.array() - std::complex<double>(forbidden)).abs().minCoeff(&nearest);
  const double rounding =
      16 * static_cast<double>(A.rows()) * std::numeric_limits<double>::epsilon();
  if (distance > rounding * forbidden) return;
  throw InvalidInput(
      "tustin", fmt::format("A has a pole at {:.6g} 1/s, expected none at 2/dt because the "
                            "transformation sends it to infinity (dt is {} s); take another dt",
                            poles[nearest].real(), dt));
}

}  // namespace

DiscreteLti discretize_tustin(const ContinuousLti& plant, double dt) {
  validate(plant, "tustin");
  internal::require_period(dt, "tustin");
  refuse_pole(plant.A, dt);
  const Eigen::Index nx = plant.A.rows();
  const Eigen::MatrixXd I = Eigen::MatrixXd::Identity(nx, nx);
  const Eigen::MatrixXd C = plant.C.size() ? plant.C : I;
  const Eigen::MatrixXd half = plant.A * (dt / 2);
  const Eigen::PartialPivLU<Eigen::MatrixXd> lu(I - half);
  const Eigen::MatrixXd Ct = lu.transpose().solve(C.transpose());
  DiscreteLti result{
      .A = lu.solve(I + half),
      .B = lu.solve(plant.B * dt),
      .C = Ct.transpose(),
      .D = plant.D.size() ? plant.D : Eigen::MatrixXd::Zero(C.rows(), plant.B.cols()),
      .dt = dt,
      .states = plant.states,
      .inputs = plant.inputs,
      .outputs = plant.C.size() ? plant.outputs : plant.states};
  result.D += 0.5 * C * result.B;  // C T B dt/2
  if (!result.A.allFinite() || !result.B.allFinite() || !result.C.allFinite() ||
      !result.D.allFinite())
    internal::refuse_long_period(dt, "tustin");
  return result;
}

}  // namespace quadtune
