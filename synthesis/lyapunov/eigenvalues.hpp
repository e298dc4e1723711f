// SPDX-License-Identifier: Apache-2.0
/// Eigenvalues of a real matrix.
#pragma once

#include <Eigen/Core>

namespace quadtune::internal {

/// Computed by LAPACK with balancing. Empty if its QR iteration did not converge.
[[nodiscard]] Eigen::VectorXcd eigenvalues(Eigen::MatrixXd M);

}  // namespace quadtune::internal
