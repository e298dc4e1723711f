// SPDX-License-Identifier: Apache-2.0
/// Whether what an export tells of its laws and filters is true, by solving each problem again.
#pragma once

#include <filesystem>
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

/// Solves the problem of each Kalman filter that the files hold anew: are gains and covariances
/// those of its model and noise?
/// @return  one check; none where the export has no filters
[[nodiscard]] std::vector<VerifyCheck> check_filters(const std::filesystem::path& directory,
                                                     const Manifest& manifest);

}  // namespace quadtune
