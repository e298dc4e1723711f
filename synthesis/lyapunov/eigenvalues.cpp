// SPDX-License-Identifier: Apache-2.0
#include "lyapunov/eigenvalues.hpp"

#include "lyapunov/lapack.hpp"

namespace quadtune::internal {

Eigen::VectorXcd eigenvalues(Eigen::MatrixXd M) {
  const auto n = static_cast<lapack_int>(M.rows());
  Eigen::VectorXd real(n);
  Eigen::VectorXd imaginary(n);
  double unused = 0;
  if (n == 0 || LAPACKE_dgeev(LAPACK_COL_MAJOR, 'N', 'N', n, M.data(), n, real.data(),
                              imaginary.data(), &unused, 1, &unused, 1) != 0)
    return {};
  Eigen::VectorXcd values(n);
  values.real() = real;
  values.imag() = imaginary;
  return values;
}

}  // namespace quadtune::internal
