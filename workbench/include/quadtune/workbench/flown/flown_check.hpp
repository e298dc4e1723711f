// SPDX-License-Identifier: Apache-2.0
/// Whether control laws hold the vehicle that flies, as a question of `verify` and `design`.
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
  std::string problem;            ///< of an unstable loop which changes would stabilize it, or why
                                  ///< it cannot be analysed; empty: none

  [[nodiscard]] bool holds() const { return loop && !loop->grows(); }
};

/// Analyses the flown loop of each law about a hover at 1.1 m, with the sensors of the vehicle and
/// the estimator that they feed.
///
/// @param gains      none unless has_flown_loop(), nor for gains without a sample period
/// @param cascade    a PID cascade
/// @param estimator  that the laws were designed with; none: by the convention of the gains
/// @param margins    whether margins of the state feedback's loops are computed
/// @throws NoSolution  if the vehicle cannot fly the trim of the gains
[[nodiscard]] std::vector<FlownLaw> flown_laws(const Vehicle& vehicle,
                                               const std::optional<Gains>& gains,
                                               const std::optional<CascadeDesign>& cascade,
                                               const std::optional<StoredEstimator>& estimator = {},
                                               bool margins = false);

/// One check for each law: the detail names the mode of the largest |z|, and the problem.
[[nodiscard]] std::vector<VerifyCheck> checks_of(const std::vector<FlownLaw>& laws);

/// The estimator of the flight program that reads gains of a convention, as its exporter names it
/// (ExportTarget::estimator), if the vehicle has the sensors that it needs; otherwise empty.
[[nodiscard]] std::string estimator_of_program(const Vehicle& vehicle,
                                               const std::string& convention);

/// A hover under an exported law, as flown_laws() analyses it.
/// @param stored      estimator that the law was designed with
/// @param convention  of the gains; without a stored estimator it chooses that of its flight
///                    program; empty: by the sensors
/// @throws InvalidInput
[[nodiscard]] PlannedFlight hover_under(const Vehicle& vehicle, const Controller& controller,
                                        const std::optional<StoredEstimator>& stored,
                                        const std::string& convention);

/// Whether gains for this trim can be analysed on a FlownPlant: the trim is a hover with the
/// heading north.
[[nodiscard]] bool has_flown_loop(const TrimResult& trim);

}  // namespace quadtune
