// SPDX-License-Identifier: Apache-2.0
/// The steady Kalman filter of matrices.
#pragma once

#include <string>

#include "quadtune/internal/json_fwd.hpp"
#include "quadtune/synthesis/kalman.hpp"

namespace quadtune::report {

/// @param dt  sample period [s], 1 of a discrete model without one; 0 of a continuous filter
[[nodiscard]] internal::Json to_json(const KalmanResult& result, double dt);
[[nodiscard]] std::string to_text(const KalmanResult& result, double dt);

}  // namespace quadtune::report
