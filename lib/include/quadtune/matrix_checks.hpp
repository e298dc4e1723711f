// SPDX-License-Identifier: Apache-2.0
/// Checks that every public function applies to its matrix arguments.
#pragma once

#include <Eigen/Core>
#include <string>

namespace quadtune {

/// The shape as messages write it: "3x4".
[[nodiscard]] std::string shape(const Eigen::Ref<const Eigen::MatrixXd>& M);

/// @throws InvalidInput  "where: A has nan at (2,3), expected finite numbers" (1-based).
void require_finite(const Eigen::Ref<const Eigen::MatrixXd>& M, const std::string& where,
                    const std::string& name);

/// @throws InvalidInput  "where: R is 3x3, expected 4x4 (why)".
void require_shape(const Eigen::Ref<const Eigen::MatrixXd>& M, Eigen::Index rows, Eigen::Index cols,
                   const std::string& where, const std::string& name, const std::string& why);

/// Accepts asymmetry of up to 1e-10 of the largest entry as rounding.
/// @throws InvalidInput  with the pair of entries that differs most, and the difference.
void require_symmetric(const Eigen::Ref<const Eigen::MatrixXd>& M, const std::string& where,
                       const std::string& name);

}  // namespace quadtune
