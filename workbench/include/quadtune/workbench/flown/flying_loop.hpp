// SPDX-License-Identifier: Apache-2.0
/// The loop of state feedback gains as implemented: named gains, poles, margins and model.
#pragma once

#include <Eigen/Core>
#include <optional>

#include "quadtune/design.hpp"
#include "quadtune/exports/verify.hpp"
#include "quadtune/gains.hpp"
#include "quadtune/linearize/linearize.hpp"
#include "quadtune/model/vehicle.hpp"
#include "quadtune/synthesis/riccati.hpp"
#include "quadtune/synthesis/state_feedback.hpp"
#include "quadtune/workbench/design/margins_report.hpp"

namespace quadtune {

/// The gains of a solved design with all data that are needed to apply them.
[[nodiscard]] Gains make_gains(const Vehicle& vehicle, const Linearization& model,
                               const LqrDesign& lqr, const StateFeedback& feedback);

/// Poles of the loop as implemented: discrete if the law is sampled, otherwise continuous.
[[nodiscard]] Eigen::VectorXcd flying_poles(const Linearization& model, const Gains& gains,
                                            const RiccatiResult& riccati);

/// Margins of the same loop, cut at the plant's inputs.
[[nodiscard]] MarginsReport flying_margins(const Linearization& model, const Gains& gains,
                                           const RiccatiResult& riccati,
                                           MarginsEvidence evidence = MarginsEvidence::full);

/// The continuous model for gains from another source: the vehicle linearized at gains.x0.
/// @throws NoSolution  if the vehicle has no such trim
[[nodiscard]] Linearization linearization_of(const Vehicle& vehicle, const Gains& gains);

/// The yaw [rad] at which a feedback of horizontal position is valid, because the position is in
/// world axes; empty if the gains feed back none, or errors along the heading.
[[nodiscard]] std::optional<double> yaw_of(const Gains& gains);

/// The same, sampled with the sample time of the gains.
[[nodiscard]] VerifyModel model_of(const Vehicle& vehicle, const Gains& gains);

}  // namespace quadtune
