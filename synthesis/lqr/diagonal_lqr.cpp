// SPDX-License-Identifier: Apache-2.0
#include "quadtune/synthesis/diagonal_lqr.hpp"

#include <fmt/format.h>

#include <cmath>
#include <utility>

#include "quadtune/discretize/zoh.hpp"
#include "quadtune/errors.hpp"
#include "quadtune/internal/joined.hpp"
#include "quadtune/matrix_checks.hpp"

namespace quadtune {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

namespace {

constexpr char kDiagonalWhere[] = "diagonal_lqr";

/// The cost with one weight of 1 and all others 0.
LqrWeights unit_cost(Index nx, Index nu, Index weight) {
  LqrWeights unit{MatrixXd::Zero(nx, nx), MatrixXd::Zero(nu, nu), {}};
  if (weight < nx)
    unit.Q(weight, weight) = 1;
  else
    unit.R(weight - nx, weight - nx) = 1;
  return unit;
}

VectorXd diagonal_of(const MatrixXd& M, const char* name) {
  require_shape(M, M.rows(), M.rows(), kDiagonalWhere, name, "weights are square");
  if (!M.isDiagonal(0))
    throw InvalidInput(kDiagonalWhere,
                       fmt::format("{} has entries off its diagonal, expected a diagonal "
                                   "matrix because only diagonal weights are searched",
                                   name));
  return M.diagonal();
}

}  // namespace

DiagonalLqr::DiagonalLqr(const ContinuousLti& plant, const LqrDesign& design)
    : inputs_(plant.B.cols()) {
  if (design.method != LqrMethod::continuous && !(design.dt > 0))
    throw InvalidInput(kDiagonalWhere,
                       fmt::format("dt is {} s, expected a positive number", design.dt));
  const ContinuousLti augmented = with_integrals(plant, design.integrals);
  const Index nx = augmented.A.rows();
  names_ = names_or_numbers(augmented.states, nx);
  for (const std::string& input : names_or_numbers(augmented.inputs, inputs_))
    names_.push_back(augmented.inputs.empty() ? "u" + input : input);
  for (Index i = 0; i < size(); ++i) {
    const LqrWeights unit = unit_cost(nx, inputs_, i);
    unit_costs_.push_back(
        design.method == LqrMethod::sampled ? sample(augmented, unit, design.dt).weights : unit);
  }
  if (design.method == LqrMethod::continuous)
    plant_ = augmented;
  else
    plant_ = discretize_zoh(augmented, design.dt);
}

LqrWeights DiagonalLqr::weights(const Eigen::Ref<const VectorXd>& w) const {
  if (w.size() != size())
    throw InvalidInput(kDiagonalWhere,
                       fmt::format("{} weights are given, expected {} ({})", w.size(), size(),
                                   internal::joined(names_, " ")));
  LqrWeights sum{MatrixXd::Zero(states(), states()), MatrixXd::Zero(inputs_, inputs_), {}};
  for (Index i = 0; i < size(); ++i) {
    if (!(w(i) >= 0) || !std::isfinite(w(i)))
      throw InvalidInput(kDiagonalWhere, fmt::format("the weight of {} is {}, expected 0 or more",
                                                     names_[static_cast<std::size_t>(i)], w(i)));
    const LqrWeights& unit = unit_costs_[static_cast<std::size_t>(i)];
    sum.Q += w(i) * unit.Q;
    sum.R += w(i) * unit.R;
    if (unit.N.size() == 0) continue;
    if (sum.N.size() == 0) sum.N = MatrixXd::Zero(states(), inputs_);
    sum.N += w(i) * unit.N;
  }
  return sum;
}

RiccatiResult DiagonalLqr::solve(const Eigen::Ref<const VectorXd>& w) const {
  return std::visit(
      [&](const auto& plant) {
        return lqr(plant, weights(w), {.evidence = RiccatiEvidence::essential});
      },
      plant_);
}

LqrDerivative DiagonalLqr::derivative(const Eigen::Ref<const VectorXd>& w,
                                      const RiccatiResult& solution) const {
  return std::visit([&](const auto& plant) { return LqrDerivative(plant, weights(w), solution); },
                    plant_);
}

MatrixXd DiagonalLqr::jacobian(const Eigen::Ref<const VectorXd>& w,
                               const RiccatiResult& solution) const {
  const LqrDerivative at = derivative(w, solution);
  MatrixXd J(inputs_ * states(), size());
  for (Index i = 0; i < size(); ++i)
    J.col(i) = at.along(unit_costs_[static_cast<std::size_t>(i)]).dK.reshaped();
  return J;
}

VectorXd DiagonalLqr::gradient(const Eigen::Ref<const VectorXd>& w, const RiccatiResult& solution,
                               const Eigen::Ref<const MatrixXd>& Y) const {
  const LqrWeights by = derivative(w, solution).gradient(Y);
  VectorXd g(size());
  for (Index i = 0; i < size(); ++i) {
    const LqrWeights& unit = unit_costs_[static_cast<std::size_t>(i)];
    g(i) = by.Q.cwiseProduct(unit.Q).sum() + by.R.cwiseProduct(unit.R).sum();
    if (unit.N.size() > 0) g(i) += by.N.cwiseProduct(unit.N).sum();
  }
  return g;
}

VectorXd diagonals_of(const LqrDesign& design) {
  const Index nx = design.Q.rows();
  const Index ni = design.Q_integral.rows();
  VectorXd w(nx + ni + design.R.rows());
  w.head(nx) = diagonal_of(design.Q, "Q");
  w.segment(nx, ni) = diagonal_of(design.Q_integral, "Q_integral");
  w.tail(design.R.rows()) = diagonal_of(design.R, "R");
  return w;
}

LqrDesign with_diagonals(LqrDesign design, const Eigen::Ref<const VectorXd>& w) {
  const Index nx = design.Q.rows();
  const Index ni = design.Q_integral.rows();
  const Index nu = design.R.rows();
  if (w.size() != nx + ni + nu)
    throw InvalidInput(kDiagonalWhere,
                       fmt::format("{} weights are given, expected {} for the states, {} for "
                                   "the integrals and {} for the inputs",
                                   w.size(), nx, ni, nu));
  design.Q = w.head(nx).asDiagonal();
  design.Q_integral = w.segment(nx, ni).asDiagonal();
  design.R = w.tail(nu).asDiagonal();
  return design;
}

}  // namespace quadtune
