// SPDX-License-Identifier: Apache-2.0
/// Whether a matrix can be the dynamics of a sampled plant.
#pragma once

#include <Eigen/Core>
#include <string>

namespace quadtune {

/// Why A is not e^(A_c dt) for a real A_c: it has a real logarithm if and only if no eigenvalue is
/// 0 and each Jordan block of a negative one occurs an even number of times (Culver 1966). A
/// sampled plant with delays has eigenvalues 0 as well. Its motion is slow compared with the sample
/// period, so it also has eigenvalues near 1: if one is within 0.5 of 1, the result is empty.
/// @param A  (n × n)
/// @return   "has the eigenvalue 0"; empty if there is no reason
[[nodiscard]] std::string why_not_sampled(const Eigen::MatrixXd& A);

}  // namespace quadtune
