// SPDX-License-Identifier: Apache-2.0
/// Eigenvalues of a real matrix.
#pragma once

#include <Eigen/Core>

namespace quadtune::internal {

/// By LAPACK, which balances first. Empty when its QR iteration did not end.
[[nodiscard]] Eigen::VectorXcd eigenvalues(Eigen::MatrixXd M);

}  // namespace quadtune::internal
