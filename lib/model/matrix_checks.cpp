// SPDX-License-Identifier: Apache-2.0
#include "quadtune/matrix_checks.hpp"

#include <fmt/format.h>

#include <cmath>

#include "quadtune/errors.hpp"

namespace quadtune {

std::string shape(const Eigen::Ref<const Eigen::MatrixXd>& M) {
  return fmt::format("{}x{}", M.rows(), M.cols());
}

void require_finite(const Eigen::Ref<const Eigen::MatrixXd>& M, const std::string& where,
                    const std::string& name) {
  // The sum is finite only if every entry is; unlike allFinite() it is vectorized.
  if (std::isfinite(M.cwiseAbs().sum()) || M.allFinite()) return;
  for (Eigen::Index i = 0; i < M.rows(); ++i)
    for (Eigen::Index j = 0; j < M.cols(); ++j)
      if (!std::isfinite(M(i, j)))
        throw InvalidInput(where, fmt::format("{} has {} at ({},{}), expected finite numbers", name,
                                              M(i, j), i + 1, j + 1));
}

void require_shape(const Eigen::Ref<const Eigen::MatrixXd>& M, Eigen::Index rows, Eigen::Index cols,
                   const std::string& where, const std::string& name, const std::string& why) {
  if (M.rows() != rows || M.cols() != cols)
    throw InvalidInput(
        where, fmt::format("{} is {}, expected {}x{} ({})", name, shape(M), rows, cols, why));
}

void require_symmetric(const Eigen::Ref<const Eigen::MatrixXd>& M, const std::string& where,
                       const std::string& name) {
  if (M.size() == 0) return;
  Eigen::Index row = 0;
  Eigen::Index col = 0;
  const double worst = (M - M.transpose()).cwiseAbs().maxCoeff(&row, &col);
  const double scale = M.cwiseAbs().maxCoeff();
  if (worst <= 1e-10 * scale) return;
  throw InvalidInput(
      where,
      fmt::format("{} is not symmetric: ({},{}) is {} and ({},{}) is {}, which differ "
                  "by {:.3g}; expected equal entries",
                  name, col + 1, row + 1, M(col, row), row + 1, col + 1, M(row, col), worst));
}

}  // namespace quadtune
