// SPDX-License-Identifier: Apache-2.0
/// Reads the tables [[kalman]] and [estimator] of a design file.
#pragma once

#include <filesystem>

#include "quadtune/design.hpp"
#include "quadtune/internal/toml_reader.hpp"

namespace quadtune::internal {

/// Reads one [[kalman]].
/// @param folder  that of the design file; the path of a tuned model is relative to it
[[nodiscard]] KalmanDesign read_kalman(const TomlTable& table, const std::filesystem::path& folder);

/// Reads [estimator].
/// @param folder  as above
/// @throws InvalidInput  if the tuned model is for another vehicle
[[nodiscard]] EstimatorDesign read_estimator(const TomlTable& table,
                                             const std::filesystem::path& folder,
                                             const Vehicle& vehicle);

}  // namespace quadtune::internal
