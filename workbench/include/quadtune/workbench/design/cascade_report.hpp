// SPDX-License-Identifier: Apache-2.0
/// A vehicle's PID cascade, designed or written, with the evidence of its loops.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "quadtune/design.hpp"
#include "quadtune/model/vehicle.hpp"
#include "quadtune/synthesis/pid_cascade.hpp"
#include "quadtune/workbench/design/margins_report.hpp"

namespace quadtune {

/// A cascade with what it was designed for and how it does as a whole.
struct CascadeReport {
  std::string vehicle;                 ///< name
  bool designed = false;               ///< not written
  CascadeSpecification specification;  ///< with the lag that was used
  std::string published_source;        ///< empty where nothing is published
  std::optional<CascadeGains> published;
  PidCascade cascade;
  DiscreteLti open_loop;  ///< all loops, cut at the wrench
  MarginsReport margins;  ///< there
};

/// Hover of the vehicle with the lag of its slowest motor and its published gains.
/// @param where  the file or vehicle that asked for it
/// @throws NoSolution  if the vehicle cannot hover
[[nodiscard]] CascadeVehicle cascade_vehicle(const Vehicle& vehicle, const std::string& where);

/// The vehicle of the textbook plant: rotors and commands without lag and delay.
[[nodiscard]] Vehicle without_lag(Vehicle vehicle);

/// @throws NoSolution  naming the loop that cannot be had, and the highest that can.
[[nodiscard]] CascadeReport design_cascade(const Vehicle& vehicle,
                                           const CascadeSpecification& specification,
                                           const std::string& where);

/// The same for gains that were written, with nothing beside it.
/// @param method  of the integrals
[[nodiscard]] CascadeReport assess_written_cascade(const Vehicle& vehicle,
                                                   const CascadeGains& gains, PidMethod method,
                                                   const std::string& where);

/// What the loop of an exported cascade is closed around: hover with the vehicle's lag, sampled.
/// @throws NoSolution  if the vehicle cannot hover
[[nodiscard]] DiscreteLti cascade_plant(const Vehicle& vehicle, const CascadeDesign& cascade,
                                        const std::string& where);

/// What a careful engineer would not fly, of each loop and of all together; see margin_warnings().
[[nodiscard]] std::vector<std::string> cascade_warnings(const CascadeReport& report);

/// Whether a pole of all loops together is not inside the unit circle.
[[nodiscard]] bool unstable(const CascadeReport& report);

}  // namespace quadtune
