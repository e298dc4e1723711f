// SPDX-License-Identifier: Apache-2.0
#include "quadtune/model/inertia.hpp"

#include <fmt/format.h>

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <array>
#include <cmath>

#include "quadtune/errors.hpp"
#include "quadtune/matrix_checks.hpp"

namespace quadtune {
namespace {

constexpr double kMinInertia = 1e-30;  // [kg m²], so that the inverse does not overflow
constexpr double kMinRatio = 1e-9;     // relative to the largest

// Inertia of a point mass at d: m (|d|² I - d dᵀ).
Eigen::Matrix3d point_inertia(double mass, const Eigen::Vector3d& d) {
  return mass * (d.squaredNorm() * Eigen::Matrix3d::Identity() - d * d.transpose());
}

void require_part(const Sphere& part, std::size_t number) {
  const std::string where = fmt::format("part {}", number);
  if (!(part.mass > 0) || !std::isfinite(part.mass))
    throw InvalidInput(where, fmt::format("mass is {} kg, expected more than 0", part.mass));
  if (!(part.radius >= 0) || !std::isfinite(part.radius))
    throw InvalidInput(where, fmt::format("radius is {} m, expected 0 or more", part.radius));
  if (!part.position.allFinite())
    throw InvalidInput(where, "position is not finite, expected finite numbers");
}

// The body axis nearest to a principal axis, as a letter for messages.
char axis_name(const Eigen::Vector3d& principal_axis) {
  Eigen::Index axis = 0;
  principal_axis.cwiseAbs().maxCoeff(&axis);
  return "xyz"[axis];
}

}  // namespace

MassProperties mass_properties(const std::vector<Sphere>& parts) {
  if (parts.empty()) throw InvalidInput("mass_properties", "no parts, expected at least one");
  MassProperties whole;
  for (std::size_t i = 0; i < parts.size(); ++i) {
    require_part(parts[i], i + 1);
    whole.mass += parts[i].mass;
    whole.centre_of_mass += parts[i].mass * parts[i].position;
  }
  whole.centre_of_mass /= whole.mass;
  for (const Sphere& part : parts) {
    // 2/5 m r² of a solid sphere about its own centre, then the parallel-axis theorem.
    whole.inertia += 0.4 * part.mass * part.radius * part.radius * Eigen::Matrix3d::Identity();
    whole.inertia += point_inertia(part.mass, part.position - whole.centre_of_mass);
  }
  return whole;
}

void require_inertia(const Eigen::Matrix3d& J, const std::string& where, double tolerance) {
  require_finite(J, where, "inertia");
  require_symmetric(J, where, "inertia");
  const Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> principal(0.5 * (J + J.transpose()));
  const Eigen::Vector3d I = principal.eigenvalues();  // ascending
  const auto axis = [&](Eigen::Index i) { return axis_name(principal.eigenvectors().col(i)); };
  if (!(I(0) > 0))
    throw InvalidInput(
        where, fmt::format("inertia about {} is {:.6g} kg m2, expected more than 0 because a body "
                           "has mass off every axis",
                           axis(0), I(0)));
  if (!(I(0) >= kMinInertia) || !(I(0) >= kMinRatio * I(2)))
    throw InvalidInput(
        where, fmt::format("inertia about {} is {:.6g} kg m2, expected at least {:.2g} kg m2, "
                           "because no real body has less next to {:.6g} kg m2 about {}",
                           axis(0), I(0), std::max(kMinInertia, kMinRatio * I(2)), I(2), axis(2)));
  // I₁ + I₂ ≥ I₃ since I₁ + I₂ - I₃ = 2 ∫ x₃² dm; a plate meets it with equality, up to rounding.
  const double excess = I(2) - I(0) - I(1);
  if (excess > (tolerance + 1e-9) * I(2))
    throw InvalidInput(
        where, fmt::format("inertia violates the triangle inequality: about {} it is {:.6g} kg m2, "
                           "which exceeds the sum of the other two, {:.6g}, by {:.3g}; no rigid "
                           "body has such an inertia{}",
                           axis(2), I(2), I(0) + I(1), excess,
                           tolerance > 0 ? fmt::format(" (inertia_tolerance permits {:.3g})",
                                                       tolerance * I(2))
                                         : ""));
}

}  // namespace quadtune
