// SPDX-License-Identifier: Apache-2.0
/// Matrices of uniform random numbers from a seeded generator. Eigen's Random() uses global state,
/// which depends on the tests that ran before.
#pragma once

#include <Eigen/Core>
#include <random>

namespace quadtune::testing {

/// Entries uniform in [-1, 1), column by column.
[[nodiscard]] inline Eigen::MatrixXd uniform_matrix(Eigen::Index rows, Eigen::Index cols,
                                                    std::mt19937_64& random) {
  std::uniform_real_distribution<double> uniform(-1, 1);
  return Eigen::MatrixXd::NullaryExpr(rows, cols, [&] { return uniform(random); });
}

/// A vector of such entries.
[[nodiscard]] inline Eigen::VectorXd uniform_vector(Eigen::Index size, std::mt19937_64& random) {
  return uniform_matrix(size, 1, random);
}

}  // namespace quadtune::testing
