// SPDX-License-Identifier: Apache-2.0
/// Checks of `verify` and `design` that control laws stabilize the flown vehicle.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "quadtune/design.hpp"
#include "quadtune/exports/stored_estimator.hpp"
#include "quadtune/exports/verify.hpp"
#include "quadtune/gains.hpp"
#include "quadtune/linearize/linearize.hpp"
#include "quadtune/model/vehicle.hpp"
#include "quadtune/workbench/flight/flight_plan.hpp"
#include "quadtune/workbench/flown/flown_loop.hpp"

namespace quadtune {

/// The flown loop of one law.
struct FlownLaw {
  std::string name;               ///< "state feedback" or "PID cascade"
  std::optional<FlownLoop> loop;  ///< none if it cannot be analysed
  /// For an unstable loop the changes that would stabilize it, or why it cannot be analysed; empty:
  /// none.
  std::string problem;

  /// Whether the loop was analysed and no mode of it grows.
  [[nodiscard]] bool holds() const { return loop && !loop->grows(); }
};

/// Analyses the flown loop of each law at a hover at 1.1 m, with the sensors of the vehicle and the
/// estimator that they support.
///
/// @param vehicle    valid
/// @param gains      not analysed unless has_flown_loop(), nor without a sample period
/// @param cascade    a PID cascade
/// @param estimator  with which the laws were designed; none: according to the gains' convention
/// @param margins    whether margins of the state feedback's loops are computed
/// @param cascade_margins  whether margins of the cascade's loops are computed
/// @throws NoSolution  if the vehicle cannot fly the trim of the gains
[[nodiscard]] std::vector<FlownLaw> flown_laws(const Vehicle& vehicle,
                                               const std::optional<Gains>& gains,
                                               const std::optional<CascadeDesign>& cascade,
                                               const std::optional<StoredEstimator>& estimator = {},
                                               bool margins = false, bool cascade_margins = false);

/// One check per law; its detail names the mode with the largest |z|, and the problem.
[[nodiscard]] std::vector<VerifyCheck> checks_of(const std::vector<FlownLaw>& laws);

/// The estimator of the flight program that reads gains of a convention, as its exporter names it
/// (ExportTarget::estimator), if the vehicle has the sensors that it needs; otherwise empty.
[[nodiscard]] std::string estimator_of_program(const Vehicle& vehicle,
                                               const std::string& convention);

/// A hover under an exported law, as analysed by flown_laws().
/// @param vehicle     valid
/// @param controller  the law
/// @param stored      estimator with which the law was designed
/// @param convention  of the gains; without a stored estimator it selects that of its flight
///                    program; empty: according to the sensors
/// @throws InvalidInput
[[nodiscard]] PlannedFlight hover_under(const Vehicle& vehicle, const Controller& controller,
                                        const std::optional<StoredEstimator>& stored,
                                        const std::string& convention);

/// Whether gains for this trim can be analysed on a FlownPlant: the trim is a hover with the
/// heading north.
[[nodiscard]] bool has_flown_loop(const TrimResult& trim);

}  // namespace quadtune
