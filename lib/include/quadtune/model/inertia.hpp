// SPDX-License-Identifier: Apache-2.0
/// Inertia of bodies made of spheres and point masses, and whether a matrix can be an inertia.
#pragma once

#include <Eigen/Core>
#include <string>
#include <vector>

namespace quadtune {

/// A solid sphere of even density; radius 0 makes it a point mass.
struct Sphere {
  double mass = 0;                                     ///< [kg], > 0
  double radius = 0;                                   ///< [m], ≥ 0
  Eigen::Vector3d position = Eigen::Vector3d::Zero();  ///< of its centre [m]
};

/// Mass and inertia of a rigid set of parts.
struct MassProperties {
  double mass = 0;                                           ///< [kg]
  Eigen::Vector3d centre_of_mass = Eigen::Vector3d::Zero();  ///< in the parts' axes [m]
  Eigen::Matrix3d inertia = Eigen::Matrix3d::Zero();         ///< about the centre of mass [kg m²]
};

/// J = Σ 2/5 m r² I + m (|d|² I - d dᵀ), d from the common centre of mass (parallel axes).
/// @throws InvalidInput  for no parts, a mass that is not positive or a negative radius.
[[nodiscard]] MassProperties mass_properties(const std::vector<Sphere>& parts);

/// Checks that J can be the inertia of a body: finite, symmetric, principal moments of at least
/// 1e-30 kg m² and 1e-9 of the largest, and none larger than the sum of the other two.
///
/// @param tolerance  Share of the largest moment by which it may exceed that sum: measured moments
///                   of a flat body do.
/// @throws InvalidInput  naming the axis and by how much.
void require_inertia(const Eigen::Matrix3d& J, const std::string& where, double tolerance = 0);

}  // namespace quadtune
