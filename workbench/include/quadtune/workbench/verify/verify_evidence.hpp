// SPDX-License-Identifier: Apache-2.0
/// Checks the evidence for laws and filters of an export by solving each problem again.
#pragma once

#include <filesystem>
#include <vector>

#include "quadtune/exports/manifest.hpp"
#include "quadtune/exports/verify.hpp"

namespace quadtune {

/// Solves the LQR problem with the manifest's weights and checks that its gains and its evidence
/// (status, poles, residual, condition) are those of the manifest.
///
/// @return  no check if the manifest lacks the gains or one of the weights
/// @throws NoSolution  if the vehicle has no such trim
[[nodiscard]] std::vector<VerifyCheck> check_evidence(const Vehicle& vehicle,
                                                      const Manifest& manifest);

/// Solves the problem of each Kalman filter in the files and checks that gains and covariances are
/// those of its model and noise.
/// @return  one check; none if the export has no filters
[[nodiscard]] std::vector<VerifyCheck> check_filters(const std::filesystem::path& directory,
                                                     const Manifest& manifest);

}  // namespace quadtune
