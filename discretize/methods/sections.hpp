// SPDX-License-Identifier: Apache-2.0
/// A system of one channel from its poles and zeros, without writing its polynomials out.
#pragma once

#include <Eigen/Core>

#include "quadtune/lti.hpp"

namespace quadtune::internal {

/// Sections of first and second order in series. Near z = 1 the coefficients of a polynomial of
/// order 6 no longer know where its roots are; those of a section do.
///
/// @param poles, zeros  closed under conjugation; no more zeros than poles, at least one pole
/// @param z             real, no pole and no zero, where the system has the value `value`
/// @return  without names; dt as given
[[nodiscard]] DiscreteLti series_of_sections(const Eigen::VectorXcd& poles,
                                             const Eigen::VectorXcd& zeros, double z, double value,
                                             double dt);

}  // namespace quadtune::internal
