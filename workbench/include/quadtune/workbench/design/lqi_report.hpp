// SPDX-License-Identifier: Apache-2.0
/// State feedback for the flown plant, with the evidence on that plant and on the ideal one.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "quadtune/exports/stored_estimator.hpp"
#include "quadtune/gains.hpp"
#include "quadtune/model/vehicle.hpp"
#include "quadtune/workbench/design/margins_report.hpp"
#include "quadtune/workbench/flight/flight_options.hpp"
#include "quadtune/workbench/flown/flown_loop.hpp"
#include "quadtune/workbench/flown/flown_lqi.hpp"

namespace quadtune {

/// A state feedback with its evidence.
struct LqiReport {
  FlownLqi design;      ///< its gains have the bounds of keep_near_hover()
  FlownLoop flown;      ///< loop of the complete law at hover
  MarginsReport ideal;  ///< of the same law with true states, no motor lag and no delays
  std::optional<StoredEstimator> estimator;  ///< of the flown loop; none: true states
  std::vector<std::string> messages;         ///< for the user, flown_messages()
};

/// Designs with flown_lqi() and analyses the result.
/// @param vehicle  valid
/// @param options  required margins, integrals, weights and period
/// @param flight   estimator and sensors are used
/// @param at       hover and evidence of the analysis
/// @throws OptionError, InvalidInput, NoSolution
[[nodiscard]] LqiReport lqi_report(const Vehicle& vehicle, const FlownLqiOptions& options,
                                   const FlightOptions& flight = {},
                                   const FlownLoopOptions& at = {});

/// A hover under a state feedback; with the vehicle's own sensors unless `flight` overrides them.
/// @throws OptionError, InvalidInput
[[nodiscard]] PlannedFlight hover_under(const Vehicle& vehicle, const Gains& gains,
                                        const FlightOptions& flight = {});

}  // namespace quadtune
