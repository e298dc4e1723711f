// SPDX-License-Identifier: Apache-2.0
/// The whole PID cascade of a multirotor near hover: attitude, heading, height, horizontal
/// position.
#pragma once

#include <Eigen/Core>
#include <limits>
#include <optional>
#include <string>
#include <vector>

#include "quadtune/cascade.hpp"
#include "quadtune/synthesis/pid/cascade_loop.hpp"

namespace quadtune {

/// The vehicle that a cascade controls.
struct CascadeVehicle {
  ContinuousLti hover;  ///< 12 states of ned_convention(), inputs T, tau_x, tau_y, tau_z
  /// Time constant of thrust and torques [s], ≥ 0; CascadeSpecification::lag, if set, replaces it.
  double lag = 0;
  /// Available change of T, tau_x, tau_y, tau_z at hover [N, N m], > 0; infinite if unknown. It
  /// limits the gain of a loop whose speed is neither specified nor bounded by a published loop:
  /// such a loop commands all of it at an error of 0.2 rad in roll and pitch, 0.35 rad in heading
  /// and 0.5 m in height, and a tilt of 0.2 rad at an error of 0.5 m in x and y.
  Eigen::Vector4d authority = Eigen::Vector4d::Constant(std::numeric_limits<double>::infinity());
  std::optional<CascadeGains> published;  ///< gains in use on this vehicle
};

/// One designed loop and, if there is one, its published counterpart.
struct CascadeAxisDesign {
  CascadeAxis axis = CascadeAxis::x;       ///< the loop, by the quantity that it controls
  CascadeLoopBounds bounds;                ///< bounds of the design
  CascadeLoopDesign design;                ///< gains in the sign of the loop; Kd > 0 damps
  std::optional<PidGains> published;       ///< with the same sign convention
  CascadeLoopEvidence published_evidence;  ///< with the published inner loop
};

/// The loops of a cascade with their evidence.
struct PidCascade {
  CascadeGains gains;                    ///< empty unless all loops are solved
  std::vector<CascadeAxisDesign> loops;  ///< inner loops first; ends with the first unsolved one
  DiscreteLti plant;  ///< hover with lag and delays: from the wrench to the 12 states as measured
  Eigen::VectorXcd poles;          ///< of the closed loop with all axes; empty unless solved
  std::vector<std::string> notes;  ///< e.g. that the axes are coupled

  /// Whether all loops are designed.
  [[nodiscard]] bool solved() const { return !gains.loops.empty(); }
  /// The loop that could not be designed; only if not solved().
  [[nodiscard]] const CascadeAxisDesign& failed() const { return loops.back(); }
};

/// Designs the loops by design_cascade_loop(), inner loops first; each outer loop is designed
/// around its closed inner loop.
///
/// @throws InvalidInput  if the model is not that of a hovering vehicle with 12 states, if a
///                       period, lag or delay is out of range, or if a requirement is invalid as in
///                       CascadeLoopBounds.
/// Theory: "PID cascade of a vehicle".
[[nodiscard]] PidCascade pid_cascade(const CascadeVehicle& vehicle,
                                     const CascadeSpecification& specification);

/// Computes the same evidence for given gains.
/// @throws InvalidInput  for the reasons of pid_cascade(), and if the gains of a loop are missing
[[nodiscard]] PidCascade assess_cascade(const CascadeVehicle& vehicle,
                                        const CascadeSpecification& specification,
                                        const CascadeGains& gains);

/// Computes the sampled model of hover between the commanded wrench and the measured states. It
/// includes the lag of the wrench, the hold, and the delays with which the loops measure the
/// states.
[[nodiscard]] DiscreteLti sampled_hover(const CascadeVehicle& vehicle,
                                        const CascadeSpecification& specification);

/// Appends a first-order lag [s] to each input, as additional states. If lag is 0, the plant is
/// returned unchanged.
[[nodiscard]] ContinuousLti with_actuator_lag(const ContinuousLti& plant, double lag);

}  // namespace quadtune
