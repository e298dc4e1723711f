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
#include "quadtune/synthesis/cascade_loop.hpp"

namespace quadtune {

/// What the cascade flies.
struct CascadeVehicle {
  ContinuousLti hover;  ///< 12 states of ned_convention(), inputs T, tau_x, tau_y, tau_z
  double lag = 0;  ///< time constant of thrust and torques [s], ≥ 0; the specification's if any
  /// How far T, tau_x, tau_y, tau_z may move at hover [N, N m], > 0; infinite when not known. A
  /// loop whose speed is neither said nor measured by a published one uses all of it for an error
  /// of 0.2 rad in roll and pitch, 0.35 rad of heading, 0.5 m of height, and asks for 0.2 rad at an
  /// error of 0.5 m in x and y.
  Eigen::Vector4d authority = Eigen::Vector4d::Constant(std::numeric_limits<double>::infinity());
  std::optional<CascadeGains> published;  ///< gains that fly on it today
};

/// One loop as designed, and as published.
struct CascadeAxisDesign {
  CascadeAxis axis = CascadeAxis::x;
  CascadeLoopBounds bounds;                ///< that it was designed within
  CascadeLoopDesign design;                ///< gains of the loop's own sign, Kd > 0 damps
  std::optional<PidGains> published;       ///< in the same form
  CascadeLoopEvidence published_evidence;  ///< with the published loop inside
};

struct PidCascade {
  CascadeGains gains;                    ///< empty unless all loops are solved
  std::vector<CascadeAxisDesign> loops;  ///< from the inside out; ends with the first not solved
  DiscreteLti plant;  ///< hover with lag and delays: from the wrench to the 12 states as measured
  Eigen::VectorXcd poles;  ///< of the whole loop closed, all axes together; empty unless solved
  std::vector<std::string> notes;  ///< e.g. of axes that are coupled

  [[nodiscard]] bool solved() const { return !gains.loops.empty(); }
  /// The loop that could not be had.
  [[nodiscard]] const CascadeAxisDesign& failed() const { return loops.back(); }
};

/// Designs the loops one by one, each around those inside it, by design_cascade_loop().
///
/// @throws InvalidInput  for a model that is no hovering vehicle of 12 states, a period, lag or
///                       delay out of range, or requirements as for CascadeLoopBounds.
/// Theory: "PID synthesis".
[[nodiscard]] PidCascade pid_cascade(const CascadeVehicle& vehicle,
                                     const CascadeSpecification& specification);

/// The same evidence for gains that came from elsewhere: as if they had been designed.
/// @throws InvalidInput  likewise, and for gains that lack a loop
[[nodiscard]] PidCascade assess_cascade(const CascadeVehicle& vehicle,
                                        const CascadeSpecification& specification,
                                        const CascadeGains& gains);

/// Hover as the flight computer sees it: with lag behind the wrench, held, sampled, and the states
/// measured as late as the loops see them.
[[nodiscard]] DiscreteLti sampled_hover(const CascadeVehicle& vehicle,
                                        const CascadeSpecification& specification);

/// A plant with first-order lag [s] behind each input, as more states; as it is where lag is 0.
[[nodiscard]] ContinuousLti with_actuator_lag(const ContinuousLti& plant, double lag);

}  // namespace quadtune
