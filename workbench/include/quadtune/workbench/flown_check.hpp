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
#include "quadtune/workbench/flight_plan.hpp"

namespace quadtune {

/// Analyses the flown loop of each law about a hover at 1.1 m, with the sensors of the vehicle and
/// the estimator that they feed. The detail of a check names the mode of the largest |z|, and of an
/// unstable loop which changes would stabilize it.
///
/// @param gains    no check unless has_flown_loop(), or for gains without a sample period
/// @param cascade  a PID cascade
/// @param estimator  that the laws were designed with; none: by the convention of the gains
/// @return         one check for each law. A law that cannot be analysed gives a failed check with
///                 the reason.
/// @throws NoSolution  if the vehicle cannot fly the trim of the gains
[[nodiscard]] std::vector<VerifyCheck> check_flown_loops(
    const Vehicle& vehicle, const std::optional<Gains>& gains,
    const std::optional<CascadeDesign>& cascade,
    const std::optional<StoredEstimator>& estimator = {});

/// A hover under an exported law, as check_flown_loops() analyses it.
/// @param stored      estimator that the law was designed with
/// @param convention  of the gains; without a stored estimator it chooses that of its flight
/// program;
///                    empty: by the sensors
/// @throws InvalidInput
[[nodiscard]] PlannedFlight hover_under(const Vehicle& vehicle, const Controller& controller,
                                        const std::optional<StoredEstimator>& stored,
                                        const std::string& convention);

/// Whether gains for this trim can be analysed on a FlownPlant: the trim is a hover with the
/// heading north.
[[nodiscard]] bool has_flown_loop(const TrimResult& trim);

}  // namespace quadtune
