// SPDX-License-Identifier: Apache-2.0
/// The matrix logarithm, in one source file because its templates are many.
#pragma once

#include <Eigen/Core>

namespace quadtune::internal {

/// The principal logarithm; NaN or nonsense when A has eigenvalues at 0 or on the negative real
/// axis.
/// @param A  (n × n), finite
[[nodiscard]] Eigen::MatrixXd matrix_logarithm(const Eigen::MatrixXd& A);

}  // namespace quadtune::internal
