// SPDX-License-Identifier: Apache-2.0
/// Motion of a hovering vehicle due to the errors of its sensors, from the covariance of the flown
/// loop. Theory: docs/theory.md, "Predicted deviations".
#pragma once

#include <Eigen/Core>

#include "quadtune/workbench/flight/flight_plan.hpp"
#include "quadtune/workbench/flown/flown_loop.hpp"

namespace quadtune {

/// Standard deviations over many flights, in calm air.
struct PredictedRms {
  double time = 0;          ///< since the vehicle was at rest with known states [s]
  Eigen::VectorXd state;    ///< (12) of the true states of ned_convention()
  Eigen::VectorXd error;    ///< (12) of the estimates' errors
  Eigen::VectorXd command;  ///< (nu) of the law's commands
  /// (12) For each state, the contribution of the product of pitch rate and roll, which turns the
  /// heading; included in `state` and in `command`. It grows with the square of the noise.
  Eigen::VectorXd turned;
};

/// @param plan     of a hover
/// @param time     [s], > 0. States that the sensors observe are stationary after some seconds; the
///                 others drift without bound.
/// @param options  height of the hover, and evidence
/// @return         infinite entries if the loop is unstable
/// @throws InvalidInput  as flown_plant(), or if the time is not positive
[[nodiscard]] PredictedRms predicted_rms(const PlannedFlight& plan, double time,
                                         const FlownLoopOptions& options = {});

}  // namespace quadtune
