// SPDX-License-Identifier: Apache-2.0
/// Inertia of bodies composed of spheres and point masses, and the validity of an inertia matrix.
#pragma once

#include <Eigen/Core>
#include <string>
#include <vector>

namespace quadtune {

/// A solid sphere of uniform density; a radius of 0 makes it a point mass.
struct Sphere {
  double mass = 0;                                     ///< [kg], > 0
  double radius = 0;                                   ///< [m], ≥ 0
  Eigen::Vector3d position = Eigen::Vector3d::Zero();  ///< of its centre [m]
};

/// Mass, centre of mass and inertia of a rigid assembly of parts.
struct MassProperties {
  double mass = 0;                                           ///< [kg]
  Eigen::Vector3d centre_of_mass = Eigen::Vector3d::Zero();  ///< in the parts' axes [m]
  Eigen::Matrix3d inertia = Eigen::Matrix3d::Zero();         ///< about the centre of mass [kg m²]
};

/// J = Σ 2/5 m r² I + m (|d|² I - d dᵀ), d from the common centre of mass (parallel axes).
/// @throws InvalidInput  if there are no parts, a mass is not positive or a radius is negative.
[[nodiscard]] MassProperties mass_properties(const std::vector<Sphere>& parts);

/// Checks that J can be the inertia of a rigid body: finite, symmetric, with principal moments of
/// at least 1e-30 kg m² and 1e-9 of the largest, none larger than the sum of the other two.
///
/// @param J          inertia about the centre of mass [kg m²]
/// @param where      beginning of messages
/// @param tolerance  Relative amount by which the largest moment may exceed that sum, since
///                   measured moments of flat bodies can violate the inequality.
/// @throws InvalidInput  with the axis and the violation.
void require_inertia(const Eigen::Matrix3d& J, const std::string& where, double tolerance = 0);

}  // namespace quadtune
