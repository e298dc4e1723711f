// SPDX-License-Identifier: Apache-2.0
/// Exact Jacobians with Ceres jets. Private to this folder: no public header includes Ceres.
#pragma once

#include <ceres/jet.h>

#include <Eigen/Core>
#include <algorithm>

namespace quadtune::internal {

/// Derivatives are computed four at a time, so that one type serves any number of rotors.
inline constexpr int kJetWidth = 4;
using Jet = ceres::Jet<double, kJetWidth>;
using JetVector = Eigen::Matrix<Jet, Eigen::Dynamic, 1>;

/// f(z) and ∂f/∂z.
struct ValueAndJacobian {
  Eigen::VectorXd value;
  Eigen::MatrixXd jacobian;  ///< (rows × z.size())
};

/// @param f     maps a JetVector to a vector of `rows` jets.
/// @param z     the point of evaluation; at least one entry.
template <class F>
[[nodiscard]] ValueAndJacobian differentiate(const F& f, const Eigen::VectorXd& z,
                                             Eigen::Index rows) {
  ValueAndJacobian result{Eigen::VectorXd(rows), Eigen::MatrixXd(rows, z.size())};
  for (Eigen::Index first = 0; first < z.size(); first += kJetWidth) {
    const Eigen::Index width = std::min<Eigen::Index>(kJetWidth, z.size() - first);
    JetVector zj = z.cast<Jet>();
    for (Eigen::Index j = 0; j < width; ++j) zj(first + j).v(j) = 1;
    const auto fj = f(zj);
    for (Eigen::Index i = 0; i < rows; ++i) {
      result.value(i) = fj(i).a;
      result.jacobian.row(i).segment(first, width) = fj(i).v.head(width).transpose();
    }
  }
  return result;
}

}  // namespace quadtune::internal
