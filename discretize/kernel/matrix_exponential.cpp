// SPDX-License-Identifier: Apache-2.0
#include "quadtune/discretize/matrix_exponential.hpp"

#include <fmt/format.h>

#include "kernel/exponential_kernel.hpp"
#include "quadtune/errors.hpp"
#include "quadtune/matrix_checks.hpp"

namespace quadtune {

struct MatrixExponential::Workspace {
  explicit Workspace(Eigen::Index n)
      : storage(internal::ExponentialKernel::storage_size(n, 0)),
        kernel(n, 0, storage.data()),
        none(n, 0) {}

  Eigen::VectorXd storage;
  internal::ExponentialKernel kernel;
  Eigen::MatrixXd none;  // no inputs
};

MatrixExponential::MatrixExponential(Eigen::Index n) {
  if (n < 1)
    throw InvalidInput("matrix_exponential", fmt::format("n is {}, expected at least 1 row", n));
  workspace_ = std::make_unique<Workspace>(n);
}
MatrixExponential::~MatrixExponential() = default;
MatrixExponential::MatrixExponential(MatrixExponential&&) noexcept = default;
MatrixExponential& MatrixExponential::operator=(MatrixExponential&&) noexcept = default;

ExponentialStatus MatrixExponential::solve(const Eigen::Ref<const Eigen::MatrixXd>& A,
                                           Eigen::Ref<Eigen::MatrixXd> E) {
  const Eigen::Index n = workspace_->kernel.n();
  if (A.rows() != n || A.cols() != n)
    require_shape(A, n, n, "matrix_exponential", "A", "the size of the workspace");
  if (E.rows() != n || E.cols() != n)
    require_shape(E, n, n, "matrix_exponential", "E", "the size of the workspace");
  if (!A.allFinite()) require_finite(A, "matrix_exponential", "A");
  return workspace_->kernel.solve(A, workspace_->none, 1.0, E, workspace_->none);
}

ExponentialResult matrix_exponential(const Eigen::Ref<const Eigen::MatrixXd>& A) {
  require_shape(A, A.rows(), A.rows(), "matrix_exponential", "A", "A must be square");
  ExponentialResult result;
  result.E.resize(A.rows(), A.rows());
  result.status = MatrixExponential(A.rows()).solve(A, result.E);
  return result;
}

}  // namespace quadtune
