// SPDX-License-Identifier: Apache-2.0
/// How much a hovering vehicle moves because of the errors of its sensors: the covariance of the
/// flown loop. Theory: docs/theory.md, "Predicted deviations".
#pragma once

#include <Eigen/Core>

#include "quadtune/workbench/flight/flight_plan.hpp"
#include "quadtune/workbench/flown/flown_loop.hpp"

namespace quadtune {

/// Standard deviations over many flights, in calm air.
struct PredictedRms {
  double time = 0;          ///< since the vehicle was at rest with all states known [s]
  Eigen::VectorXd state;    ///< (12) of the true states of ned_convention()
  Eigen::VectorXd error;    ///< (12) of the estimates' errors
  Eigen::VectorXd command;  ///< (nu) of the law's commands
  /// (12) Of the states, the part that the product of pitch rate and roll adds, by which the
  /// heading turns: contained in `state` and, likewise, in `command`. It grows with the noise
  /// squared.
  Eigen::VectorXd turned;
};

/// @param time  [s], > 0. States that the sensors observe are stationary after some seconds; the
///              others drift for ever.
/// @return      infinite entries for a loop that is not stable
/// @throws InvalidInput  as flown_plant(), or for a time that is not positive
[[nodiscard]] PredictedRms predicted_rms(const PlannedFlight& plan, double time,
                                         const FlownLoopOptions& options = {});

}  // namespace quadtune
