// SPDX-License-Identifier: Apache-2.0
#include "kernel/matrix_logarithm.hpp"

#include <unsupported/Eigen/MatrixFunctions>

namespace quadtune::internal {

Eigen::MatrixXd matrix_logarithm(const Eigen::MatrixXd& A) { return A.log(); }

}  // namespace quadtune::internal
