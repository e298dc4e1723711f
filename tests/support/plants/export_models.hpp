// SPDX-License-Identifier: Apache-2.0
/// Sampled hover models with stabilizing gains, for tests of the steps after the synthesis.
#pragma once

#include "quadtune/exports/content.hpp"
#include "quadtune/gains.hpp"
#include "quadtune/lti.hpp"

namespace quadtune::testing {

/// uquad at hover, 12 states in its convention, rotor speeds, sampled exactly at 10 ms.
[[nodiscard]] DiscreteLti sampled_uquad();

/// The Mambo at hover, 12 states in its convention, wrench, sampled exactly at 5 ms.
[[nodiscard]] DiscreteLti sampled_mambo();

/// The states of `plant` without x, y and their velocities: uquad's build without GPS.
[[nodiscard]] DiscreteLti without_horizontal_position(const DiscreteLti& plant);

/// LQR gains by the Riccati recursion, weights 1 on states and integrals but 1e3 on angles.
///
/// @param R           weight of every input
/// @param integrated  names of integrated states, advanced by dt times the error
[[nodiscard]] Gains hover_gains(const DiscreteLti& plant, const std::string& convention,
                                InputKind kind, double R,
                                const std::vector<std::string>& integrated = {});

/// Everything that a design of uquad's hover exports: integrals of x, y, z and theta.
[[nodiscard]] ExportContent uquad_content();

/// Likewise for the Mambo: state feedback, the published cascade, two Kalman filters.
[[nodiscard]] ExportContent mambo_content();

}  // namespace quadtune::testing
