// SPDX-License-Identifier: Apache-2.0
#include <fmt/format.h>

#include <Eigen/Eigenvalues>
#include <algorithm>

#include "quadtune/errors.hpp"
#include "quadtune/exports/verify.hpp"
#include "quadtune/matrix_checks.hpp"

namespace quadtune {
namespace {

int index_of(const std::vector<Signal>& signals, const std::string& name) {
  for (std::size_t i = 0; i < signals.size(); ++i)
    if (signals[i].name == name) return static_cast<int>(i);
  throw InvalidInput("closed_loop_poles",
                     fmt::format("no state '{}' in the plant, expected {}", name, names(signals)));
}

}  // namespace

Eigen::VectorXcd closed_loop_poles(const DiscreteLti& plant, const Gains& gains) {
  validate(plant, "closed_loop_poles");
  validate(gains, "closed_loop_poles");
  const auto nx = static_cast<Eigen::Index>(gains.states.size());
  const auto ni = static_cast<Eigen::Index>(gains.integrals.size());
  require_shape(plant.A, nx, nx, "closed_loop_poles", "plant.A", "states: " + names(gains.states));
  if (names(plant.inputs) != names(gains.inputs))
    throw InvalidInput("closed_loop_poles", fmt::format("the plant's inputs are {}, expected {}",
                                                        names(plant.inputs), names(gains.inputs)));
  std::vector<int> order;
  for (const Signal& state : gains.states) order.push_back(index_of(plant.states, state.name));
  const Eigen::MatrixXd A = plant.A(order, order);
  const Eigen::MatrixXd B = plant.B(order, Eigen::all);
  const double sign = gains.sign_law == SignLaw::set_point_minus_state ? -1 : 1;

  // [x; i]⁺ = [A + s B K, B K_int; s dt E, I] [x; i], s = -1 for set point minus state
  Eigen::MatrixXd M = Eigen::MatrixXd::Identity(nx + ni, nx + ni);
  M.topLeftCorner(nx, nx) = A + sign * B * gains.K;
  for (Eigen::Index i = 0; i < ni; ++i) {
    M.col(nx + i).head(nx) = B * gains.K_int.col(i);
    M(nx + i, index_of(gains.states, gains.integrals[static_cast<std::size_t>(i)].name)) =
        sign * plant.dt;
  }
  Eigen::VectorXcd poles = M.eigenvalues();
  std::sort(poles.begin(), poles.end(), [](const auto& a, const auto& b) {
    return a.real() != b.real() ? a.real() < b.real() : a.imag() < b.imag();
  });
  return poles;
}

}  // namespace quadtune
