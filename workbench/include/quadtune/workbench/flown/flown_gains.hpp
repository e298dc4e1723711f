// SPDX-License-Identifier: Apache-2.0
/// Gains with a given structure, for the PID cascade and for programs with a single gain matrix,
/// designed on the flown plants of a vehicle. Theory: docs/theory.md, "Gains of a given structure".
#pragma once

#include <Eigen/Core>
#include <array>
#include <optional>
#include <string>
#include <vector>

#include "quadtune/cascade.hpp"
#include "quadtune/gains.hpp"
#include "quadtune/model/vehicle.hpp"
#include "quadtune/synthesis/flown_axis.hpp"
#include "quadtune/synthesis/margins.hpp"
#include "quadtune/tuning/fixed_gains.hpp"
#include "quadtune/workbench/design/standard_axes.hpp"
#include "quadtune/workbench/flown/flown_family.hpp"

namespace quadtune {

/// The gains of one group of axes and their results.
struct FlownAxisGains {
  FlownAxis axis = FlownAxis::north;  ///< group of axes
  /// u = -F y, where y are the estimates of states_of(axis) and the integral of the first of them.
  Eigen::RowVectorXd F;
  double tilt_integral = 0;  ///< Ki/Kp of the tilt loop [1/s], see with_tilt_integral(); 0: no
                             ///< integral
  double rate_lead = 0;      ///< as FlownGainsOptions::rate_lead; 0 for altitude and yaw
  double rate_filter = 0;    ///< likewise
  FixedGainsResult search;   ///< how the gains were found
  std::vector<LoopMargins> margins;  ///< at the law's output, of each member of the family
};

/// Gains of all groups of axes.
struct FlownGains {
  std::vector<FlownAxisGains> axes;       ///< in the order of kFlownAxes
  std::vector<FlownFamilyMember> family;  ///< vehicles for which the gains were designed
  std::vector<std::string> notes;         ///< for the designer, e.g. about a bound that is not met

  /// The worst margins of the nominal members; the other members are only required to be stable.
  [[nodiscard]] double Ms() const;
  [[nodiscard]] double disk() const;  ///< the smallest disk margin, likewise
};

/// The maximum tilt [rad] that a loop without an integral may have under the torque of a motor that
/// produces 10 % less thrust than the others at hover.
inline constexpr double kMaxLoadTilt = 0.1;

/// Options of flown_gains().
struct FlownGainsOptions {
  double dt = 0.005;    ///< control period [s], > 0
  double now = 0;       ///< as with_integrals(): 0 for a cascade, 1 for state feedback
  MarginBounds bounds;  ///< for the nominal members
  /// In place of bounds.Ms for a group of axes, in the order of kFlownAxes; > 1, at most bounds.Ms.
  std::array<std::optional<double>, kFlownAxes.size()> axis_Ms = {};
  /// Whether the tilt loops get an integral if a motor that is 10 % weaker would tilt the vehicle
  /// by more than kMaxLoadTilt.
  bool tilt_integral = true;
  /// p_pi: every loop of the cascade must be representable as a gain followed by a PI controller of
  /// the rate.
  CascadeStructure structure = CascadeStructure::pid;
  /// As PidLoop::rate_lead of the roll and pitch loops [s], ≥ 0: a lead near the motor lag
  /// compensates a part of it. None: 0, or what firmware_gains() chooses.
  std::optional<double> rate_lead = {};
  double rate_filter = 0;                    ///< as PidLoop::rate_filter [s], ≥ 0
  std::optional<StandardAxes> weights = {};  ///< none: standard_axes()
  std::string estimator = "";                ///< as flown_family()
};

/// Minimizes a quadratic cost with weights by Bryson's rule over the family of flown plants, with
/// bounds on the margins of every nominal member; the other members must be stable.
/// @throws InvalidInput, OptionError  as flown_family()
/// @throws NoSolution    if no gains are found that stabilize every member
[[nodiscard]] FlownGains flown_gains(const Vehicle& vehicle, const FlownGainsOptions& options = {});

/// Designs some groups of axes again, from their present gains, e.g. with a smaller axis_Ms. The
/// bounds are met less accurately than by flown_gains(): one search instead of up to three.
/// @param gains    from flown_gains(); receives the new gains of these groups
/// @param groups   to be designed again
/// @param vehicle  that of `gains`
/// @param options  as those of `gains` except for bounds and axis_Ms
void redesign(FlownGains& gains, const std::vector<FlownAxis>& groups, const Vehicle& vehicle,
              const FlownGainsOptions& options);

/// The same gains as a cascade: x and y command pitch and roll.
[[nodiscard]] CascadeGains as_cascade(const FlownGains& gains, double dt);
/// The same gains as state feedback with integrals of px, py, pz and yaw in heading axes.
/// @throws InvalidInput  if a tilt loop has an integral or a lead, which such a matrix cannot
///                       represent
[[nodiscard]] Gains as_state_feedback(const FlownGains& gains, const Vehicle& vehicle, double dt);

}  // namespace quadtune
