// SPDX-License-Identifier: Apache-2.0
#include "quadtune/estimation/covariance_model.hpp"

#include <Eigen/Cholesky>

namespace quadtune {

Eigen::VectorXd parameters_of_block(const Eigen::Ref<const Eigen::MatrixXd>& block) {
  const Eigen::MatrixXd L = block.llt().matrixL();
  const Eigen::Index n = block.rows();
  Eigen::VectorXd parameters(n * (n + 1) / 2);
  for (Eigen::Index i = 0, k = 0; i < n; ++i) {
    for (Eigen::Index j = 0; j < i; ++j) parameters(k++) = L(i, j) / L(i, i);
    parameters(k++) = 2 * std::log(L(i, i));
  }
  if (block.llt().info() != Eigen::Success) parameters.setConstant(std::nan(""));
  return parameters;
}

Eigen::MatrixXd covariance(const CovarianceModel& model,
                           const Eigen::Ref<const Eigen::VectorXd>& parameters) {
  Eigen::MatrixXd result(model.size(), model.size());
  fill_covariance(model, parameters.data(), result);
  return result;
}

bool is_diagonal(const CovarianceModel& model) {
  const auto diagonal = [](const Eigen::MatrixXd& M) { return M.isDiagonal(0); };
  for (const ScaledCovariance& term : model.scaled)
    if (!diagonal(term.shape)) return false;
  for (const FullCovariance& term : model.full)
    if (term.entries.size() > 1) return false;
  return diagonal(model.fixed);
}

}  // namespace quadtune
