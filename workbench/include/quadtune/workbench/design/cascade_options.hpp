// SPDX-License-Identifier: Apache-2.0
/// Requirements on a vehicle's cascade, with the option names of `quadtune pid`.
#pragma once

#include <optional>
#include <string>

#include "quadtune/cascade.hpp"
#include "quadtune/design/firmware_options.hpp"
#include "quadtune/model/vehicle.hpp"

namespace quadtune {

/// The functions that use the options validate their words: an unknown word throws OptionError.
/// Requirements without a value have the default of CascadeSpecification.
struct CascadeOptions {
  /// "flown": all gains at once on the flown plant; "loops": loop by loop. Empty: "flown" if
  /// usually_on_flown_plant() and no option of the loops is set, otherwise "loops".
  std::string method;
  /// "flown", or "ideal": the textbook plant without motor lag, loop by loop. Empty: "flown".
  std::string plant;
  /// Sample period [s], > 0; none: that of the published gains, or kUsualPeriod.
  std::optional<double> dt = {};

  std::optional<std::string> structure = {};  ///< "pid", "p-pi"; none: pid, or that of the firmware
  /// "px4", "ardupilot", "betaflight" or "crazyflie": the gains must also satisfy the bounds in the
  /// loops of this firmware (firmware_gains()); none: no firmware. Only on the flown plant.
  std::optional<std::string> for_firmware = {};
  FirmwareOptions firmware = {};  ///< version and set-up of that firmware
  /// Lead of the rate in the roll and pitch loops [s], 0 to kMaxLag (PidLoop::rate_lead), only on
  /// the flown plant; none: as firmware_gains() chooses, 0 without a firmware.
  std::optional<double> rate_lead = {};

  // Options of the loops.
  std::optional<double> Ms_max = {};  ///< of every loop, > 1
  /// Crossover of the rate loops [rad/s]: "roll=40,x=2"; a single number applies to all loops.
  std::optional<std::string> bandwidth = {};
  /// Delay of the measurements of the loops [s], in the same form.
  std::optional<std::string> sensor_delay = {};
  std::optional<double> motor_lag = {};        ///< [s], 0 to kMaxLag; none: the vehicle's
  std::optional<double> tracking_max = {};     ///< max |value / set point|, > 1
  std::optional<std::string> integral = {};    ///< loops with an integral: "roll,x" or "none"
  std::optional<std::string> integrator = {};  ///< "euler", "backward-euler", "tustin"; none: euler
  std::optional<bool> use_published = {};      ///< CascadeSpecification::use_published; none: true
};

/// @throws OptionError  if a value is invalid; names the option, the value and what was expected
[[nodiscard]] CascadeSpecification cascade_specification(const CascadeOptions& options,
                                                         const Vehicle& vehicle);

}  // namespace quadtune
