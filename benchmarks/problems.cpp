// SPDX-License-Identifier: Apache-2.0
#include "problems.hpp"

#include <cmath>
#include <random>

namespace quadtune::bench {

using Eigen::Index;
using Eigen::MatrixXd;

Problem random_problem(Index nx) {
  std::mt19937_64 generator(static_cast<std::uint64_t>(nx));
  std::normal_distribution<double> normal;
  const Index nu = std::max<Index>(1, nx / 3);
  Problem p{.A = MatrixXd(nx, nx),
            .B = MatrixXd(nx, nu),
            .Q = MatrixXd::Identity(nx, nx),
            .R = MatrixXd::Identity(nu, nu)};
  for (double& a : p.A.reshaped()) a = normal(generator) / std::sqrt(static_cast<double>(nx));
  for (double& b : p.B.reshaped()) b = normal(generator);
  return p;
}

Problem hover_problem() {
  constexpr double m = 0.063, Ixx = 5.82857e-5, Iyy = 7.16914e-5, Izz = 1.0e-4, g = 9.81;
  Problem p{.A = MatrixXd::Zero(12, 12), .B = MatrixXd::Zero(12, 4), .Q = {}, .R = {}};
  // position, roll pitch yaw, velocity, rates; north-east-down
  p.A.block(0, 6, 3, 3).setIdentity();
  p.A.block(3, 9, 3, 3).setIdentity();
  p.A(6, 4) = -g;
  p.A(7, 3) = g;
  p.B(8, 0) = -1 / m;
  p.B(9, 1) = 1 / Ixx;
  p.B(10, 2) = 1 / Iyy;
  p.B(11, 3) = 1 / Izz;
  Eigen::VectorXd q(12);
  q << Eigen::Vector3d::Constant(100), Eigen::Vector3d::Constant(100), Eigen::Vector3d::Constant(4),
      Eigen::Vector3d::Constant(1);
  p.Q = q.asDiagonal();
  p.R = Eigen::Vector4d(100, 1e6, 1e6, 1e6).asDiagonal();
  return p;
}

Problem hover_with_integrals() {
  const Problem hover = hover_problem();
  Problem p{.A = MatrixXd::Zero(16, 16), .B = MatrixXd::Zero(16, 4), .Q = {}, .R = hover.R};
  p.A.topLeftCorner(12, 12) = hover.A;
  p.B.topRows(12) = hover.B;
  const Index integrated[] = {0, 1, 2, 5};
  for (Index i = 0; i < 4; ++i) p.A(12 + i, integrated[i]) = 1;
  p.Q = MatrixXd::Identity(16, 16);
  p.Q.topLeftCorner(12, 12) = hover.Q;
  return p;
}

Problem unit_weights(Problem problem) {
  problem.Q.setIdentity();
  problem.R.setIdentity();
  return problem;
}

}  // namespace quadtune::bench
