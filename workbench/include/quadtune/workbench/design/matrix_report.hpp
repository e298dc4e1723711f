// SPDX-License-Identifier: Apache-2.0
/// State feedback for flight programs that implement only matrices on the 12 states and on
/// integrals, designed on the flown plants. Theory: docs/theory.md, "Gains of a given structure".
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "quadtune/design.hpp"
#include "quadtune/exports/stored_estimator.hpp"
#include "quadtune/gains.hpp"
#include "quadtune/model/vehicle.hpp"
#include "quadtune/workbench/design/margins_report.hpp"
#include "quadtune/workbench/design/standard_axes.hpp"
#include "quadtune/workbench/flight/flight_options.hpp"
#include "quadtune/workbench/flown/flown_gains.hpp"
#include "quadtune/workbench/flown/flown_loop.hpp"

namespace quadtune {

/// A matrix design with its evidence.
struct MatrixReport {
  FlownGains design;     ///< gains of each group of axes
  StandardAxes weights;  ///< by Bryson's rule, or those of the design file
  /// The same law in the requested convention; without limits in world axes, with those of
  /// keep_near_hover() in ned.
  Gains gains;
  FlownLoop flown;      ///< of the law at hover
  MarginsReport ideal;  ///< of the same law with true states, no motor lag and no delays
  std::optional<StoredEstimator> estimator;  ///< of the flown loop; none: true states
  std::vector<std::string> messages;         ///< "note: …" and "warning: …" for the user
};

/// Designs with flown_gains() and analyses the result.
/// @param vehicle  valid
/// @param design   with `matrix`; its weights override those of Bryson's rule
/// @param flight   estimator and sensors are used; if the estimator is empty, it is that of the
///                 flight program with this convention, provided that the vehicle has the sensors
///                 for it
/// @param at       hover and evidence of the analysis
/// @throws InvalidInput  for past commands, weights on changes, integrals other than the usual ones
///                       or without a weight, and as flown_gains()
/// @throws OptionError, NoSolution
[[nodiscard]] MatrixReport matrix_report(const Vehicle& vehicle, const LqiDesign& design,
                                         const FlightOptions& flight = {},
                                         const FlownLoopOptions& at = {});

/// Converts a law to the states, axes and inputs of a flight program, which are a linear map of the
/// wrench near hover. With more than four inputs, their minimum-norm change is used.
/// @param gains    from the 12 states of ned to the wrench
/// @param vehicle  whose rotors the law commands
/// @param words    convention and inputs of the result
/// @throws InvalidInput  if the convention is unknown or the law has a memory of commands
/// @throws NoSolution    if the vehicle cannot hover
[[nodiscard]] Gains describe(const Gains& gains, const Vehicle& vehicle,
                             const MatrixConvention& words);

}  // namespace quadtune
