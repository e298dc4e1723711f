// SPDX-License-Identifier: Apache-2.0
/// Matchers for matrices that reject non-finite entries before they compare.
#pragma once

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <Eigen/Core>

namespace quadtune::testing {

/// Every entry within `tolerance` of the expected one, absolutely.
MATCHER_P2(MatrixNear, expected, tolerance, "is near the expected matrix") {
  const Eigen::MatrixXd& want = expected;
  const Eigen::MatrixXd& got = arg;
  if (got.rows() != want.rows() || got.cols() != want.cols()) {
    *result_listener << "which is " << got.rows() << "x" << got.cols() << ", expected "
                     << want.rows() << "x" << want.cols();
    return false;
  }
  if (!got.allFinite()) {
    *result_listener << "which has entries that are not finite:\n" << got;
    return false;
  }
  if (got.size() == 0) return true;
  Eigen::Index i = 0;
  Eigen::Index j = 0;
  const double worst = (got - want).cwiseAbs().maxCoeff(&i, &j);
  *result_listener << "which is off by " << worst << " at (" << i + 1 << "," << j + 1
                   << "): " << got(i, j) << " instead of " << want(i, j);
  return worst <= tolerance;
}

/// ‖got - expected‖ ≤ tolerance · ‖expected‖, Frobenius.
MATCHER_P2(MatrixRelativelyNear, expected, tolerance, "is relatively near the expected matrix") {
  const Eigen::MatrixXd& want = expected;
  const Eigen::MatrixXd& got = arg;
  if (got.rows() != want.rows() || got.cols() != want.cols() || !got.allFinite()) {
    *result_listener << "which has another shape or entries that are not finite:\n" << got;
    return false;
  }
  const double relative = (got - want).norm() / want.norm();
  *result_listener << "which is off by " << relative << " relative";
  return relative <= tolerance;
}

}  // namespace quadtune::testing
