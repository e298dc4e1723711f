// SPDX-License-Identifier: Apache-2.0
/// The matrix logarithm, in its own source file because its templates take long to compile.
#pragma once

#include <Eigen/Core>

namespace quadtune::internal {

/// The principal logarithm. Not meaningful, possibly NaN, if A has an eigenvalue at 0 or on the
/// negative real axis.
/// @param A  (n × n), finite
[[nodiscard]] Eigen::MatrixXd matrix_logarithm(const Eigen::MatrixXd& A);

}  // namespace quadtune::internal
