// SPDX-License-Identifier: Apache-2.0
/// Whether what a manifest tells of its gains beyond their numbers is true: weights and evidence.
#pragma once

#include <vector>

#include "quadtune/exports/manifest.hpp"
#include "quadtune/exports/verify.hpp"

namespace quadtune {

/// Solves the LQR problem of the manifest's weights anew and asks: are its gains those of the
/// manifest, and is the evidence (status, poles, residual, condition) that of this problem.
///
/// @return  no check where the manifest has no gains or not both weights
/// @throws NoSolution  if the vehicle has no such trim.
[[nodiscard]] std::vector<VerifyCheck> check_evidence(const Vehicle& vehicle,
                                                      const Manifest& manifest);

}  // namespace quadtune
