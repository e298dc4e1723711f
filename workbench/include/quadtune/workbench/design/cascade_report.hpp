// SPDX-License-Identifier: Apache-2.0
/// A vehicle's PID cascade, designed or given, with the evidence for its loops.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "quadtune/design.hpp"
#include "quadtune/model/vehicle.hpp"
#include "quadtune/synthesis/pid/pid_cascade.hpp"
#include "quadtune/workbench/design/margins_report.hpp"

namespace quadtune {

/// A cascade with its specification and the margins of all loops together.
struct CascadeReport {
  std::string vehicle;                 ///< name
  bool designed = false;               ///< otherwise its gains were given
  CascadeSpecification specification;  ///< with the lag that was used
  std::string published_source;        ///< empty if no gains are published
  /// Published gains of the vehicle; empty if there are none.
  std::optional<CascadeGains> published;
  PidCascade cascade;     ///< loops with their evidence
  DiscreteLti open_loop;  ///< all loops closed but the one at the wrench, where it is cut
  MarginsReport margins;  ///< of `open_loop`
};

/// Hover of the vehicle, with the lag of its slowest motor and its published gains.
/// @param vehicle  valid
/// @param where    file or vehicle, for messages
/// @throws NoSolution  if the vehicle cannot hover
[[nodiscard]] CascadeVehicle cascade_vehicle(const Vehicle& vehicle, const std::string& where);

/// The vehicle of the textbook plant: motors and commands without lag and delay.
[[nodiscard]] Vehicle without_lag(Vehicle vehicle);

/// @throws NoSolution  if a loop cannot be designed; names the loop and the highest feasible
///                     crossover
[[nodiscard]] CascadeReport design_cascade(const Vehicle& vehicle,
                                           const CascadeSpecification& specification,
                                           const std::string& where);

/// The same for given gains; nothing is designed.
/// @param vehicle  valid
/// @param gains    all six loops
/// @param method   integration method of the integrals
/// @param where    file or vehicle, for messages
[[nodiscard]] CascadeReport assess_written_cascade(const Vehicle& vehicle,
                                                   const CascadeGains& gains, PidMethod method,
                                                   const std::string& where);

/// The plant of an exported cascade: hover with the vehicle's motor lag, sampled.
/// @throws NoSolution  if the vehicle cannot hover
[[nodiscard]] DiscreteLti cascade_plant(const Vehicle& vehicle, const CascadeDesign& cascade,
                                        const std::string& where);

/// Warnings about weak margins of each loop and of all loops together; see margin_warnings().
[[nodiscard]] std::vector<std::string> cascade_warnings(const CascadeReport& report);

/// Whether all loops together have a pole on or outside the unit circle.
[[nodiscard]] bool unstable(const CascadeReport& report);

}  // namespace quadtune
