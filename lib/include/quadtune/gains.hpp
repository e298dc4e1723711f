// SPDX-License-Identifier: Apache-2.0
/// A state-feedback gain with everything that is needed to apply it rightly.
#pragma once

#include <Eigen/Core>
#include <string>
#include <vector>

#include "quadtune/convention.hpp"
#include "quadtune/lti.hpp"

namespace quadtune {

/// u = u0 + K (x_sp - x) + K_int ∫(x_sp - x) for SignLaw::set_point_minus_state.
///
/// The integral is over the listed states only, in seconds times the state's unit, advanced once a
/// sample by the error times dt.
struct Gains {
  Eigen::MatrixXd K;              ///< (nu × nx) [input unit / state unit]
  Eigen::MatrixXd K_int;          ///< (nu × ni) [input unit / (state unit · s)]; ni may be 0
  std::vector<Signal> states;     ///< nx
  std::vector<Signal> inputs;     ///< nu
  std::vector<Signal> integrals;  ///< ni; names of integrated states, their units times s
  Eigen::VectorXd x0;             ///< (nx) trim state, the set point that the gain was made for
  Eigen::VectorXd u0;             ///< (nu) trim input
  std::string vehicle;            ///< name of the vehicle
  std::string convention;         ///< name of the convention
  InputKind input_kind = InputKind::rotor_speed;
  SignLaw sign_law = SignLaw::set_point_minus_state;
  double dt = 0;  ///< sample period of the law [s]; 0 means continuous
};

/// Checks shapes and finiteness.
/// @throws InvalidInput  naming the matrix, its shape and what was expected.
void validate(const Gains& gains, const std::string& where);

/// The listed states as Gains::integrals: their names, their units times s. Names of no state are
/// passed over.
[[nodiscard]] std::vector<Signal> integral_signals(const std::vector<Signal>& states,
                                                   const std::vector<std::string>& integrated);

/// The loop of the gains, integrals included, cut at the plant's inputs: L with L under negative
/// feedback the loop as it flies.
///
/// @param plant  sampled, with the gains' states in any order, and the gains' inputs
/// @return       nx + ni states, those of the gains and their integrals; nu inputs and outputs
/// @throws InvalidInput  for a plant of other states or inputs
[[nodiscard]] DiscreteLti open_loop(const DiscreteLti& plant, const Gains& gains);

}  // namespace quadtune
