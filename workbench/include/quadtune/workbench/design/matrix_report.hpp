// SPDX-License-Identifier: Apache-2.0
/// State feedback for flight programs that hold nothing but matrices on the 12 states and on
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

struct MatrixReport {
  FlownGains design;
  StandardAxes weights;
  Gains gains;  ///< the same law in the words that were asked for; in world axes without limits,
                ///< but in ned with those of keep_near_hover()
  FlownLoop flown;      ///< of the law about a hover
  MarginsReport ideal;  ///< of the same law with true states, rotors without lag and no delays
  std::optional<StoredEstimator> estimator;  ///< of the flown loop; none: true states
  std::vector<std::string> messages;         ///< "note: …" and "warning: …" for the user
};

/// Designs by flown_gains() and judges the result.
/// @param design  with `matrix`; its weights replace those of Bryson's rule
/// @param flight  estimator and sensors are used; an estimator that is empty is that of the flight
///                program whose convention it is, where the vehicle's sensors feed it
/// @throws InvalidInput  for past commands, weights of changes, other integrals than the usual ones
///                       or without a weight, and as flown_gains()
/// @throws OptionError, NoSolution
[[nodiscard]] MatrixReport matrix_report(const Vehicle& vehicle, const LqiDesign& design,
                                         const FlightOptions& flight = {},
                                         const FlownLoopOptions& at = {});

/// The same law in the words of a flight program: its states, its axes and its inputs, which near
/// hover are a linear map of the wrench. With more than four inputs the least change of them.
/// @param gains  in the 12 states of ned and the wrench
/// @throws InvalidInput  for a convention that is not known or a law with a memory of commands
/// @throws NoSolution    for a vehicle that cannot hover
[[nodiscard]] Gains in_words(const Gains& gains, const Vehicle& vehicle, const MatrixWords& words);

}  // namespace quadtune
