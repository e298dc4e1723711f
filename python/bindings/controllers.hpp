// SPDX-License-Identifier: Apache-2.0
/// Controllers in a loop with a plant, as arguments and as parts of results.
#pragma once

#include <Eigen/Core>

#include "quadtune/synthesis/pid/pid_gains.hpp"
#include "quadtune/workbench/systems/matrix_loop.hpp"
#include "support/arguments.hpp"

namespace quadtune::python {

/// @param A, B, C, D  from the output y of a plant to -u
[[nodiscard]] LoopController controller_of(const Eigen::MatrixXd& A, const Eigen::MatrixXd& B,
                                           const Eigen::MatrixXd& C, const Eigen::MatrixXd& D);
[[nodiscard]] LoopController controller_of(const PidGains& gains, PidMethod method);

/// Kp, Ki, Kd and Tf, of which the last may be omitted.
/// @throws OptionError  for another count, and for a negative Tf
[[nodiscard]] PidGains pid_gains_of(const Numbers& numbers, const char* name);

/// The method of an argument `integrator`.
/// @throws OptionError  for unknown words
[[nodiscard]] PidMethod integrator_method(const std::string& word);

}  // namespace quadtune::python
