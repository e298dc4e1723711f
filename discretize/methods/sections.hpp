// SPDX-License-Identifier: Apache-2.0
/// Builds a single-channel system from its poles and zeros without forming its polynomials.
#pragma once

#include <Eigen/Core>

#include "quadtune/lti.hpp"

namespace quadtune::internal {

/// First- and second-order sections in series. Near z = 1 the coefficients of a polynomial of
/// degree 6 do not determine its roots accurately; those of a section do.
///
/// @param poles, zeros  closed under conjugation; not more zeros than poles, at least one pole
/// @param z             a real point, neither pole nor zero, at which the system has the value
///                      `value`
/// @return  a system without names, with the given dt
[[nodiscard]] DiscreteLti series_of_sections(const Eigen::VectorXcd& poles,
                                             const Eigen::VectorXcd& zeros, double z, double value,
                                             double dt);

}  // namespace quadtune::internal
