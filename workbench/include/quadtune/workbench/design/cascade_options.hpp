// SPDX-License-Identifier: Apache-2.0
/// What is asked of a vehicle's cascade, in the words of `quadtune pid`.
#pragma once

#include <optional>
#include <string>

#include "quadtune/cascade.hpp"
#include "quadtune/model/vehicle.hpp"

namespace quadtune {

/// Words are checked by what takes the options: a word that is not known throws OptionError. Where
/// nothing is said, a requirement is that of CascadeSpecification.
struct CascadeOptions {
  /// "flown": all gains at once on the flown plant; "loops": loop by loop. Empty: flown where
  /// usually_on_flown_plant() and no option of the loops is set.
  std::string method;
  /// "flown", or "ideal": the textbook plant without rotor lag, loop by loop. Empty: flown.
  std::string plant;
  std::optional<double> dt = {};  ///< sample period [s], > 0; none: that of the published gains, or
                                  ///< kUsualPeriod

  std::optional<std::string> structure = {};  ///< "pid", "p-pi"; none: pid

  // Options of the loops.
  std::optional<double> Ms_max = {};  ///< of every loop, > 1
  /// Where the loops of the rates cross 1 [rad/s]: "roll=40,x=2"; one number stands for all loops.
  std::optional<std::string> bandwidth = {};
  /// How late the loops see their values [s], likewise.
  std::optional<std::string> sensor_delay = {};
  std::optional<double> motor_lag = {};        ///< [s], 0 to kLongestLag; none: the vehicle's
  std::optional<double> tracking_max = {};     ///< max |value / set point|, > 1
  std::optional<std::string> integral = {};    ///< loops with an integral: "roll,x" or "none"
  std::optional<std::string> integrator = {};  ///< "euler", "backward-euler", "tustin"; none: euler
  std::optional<bool> use_published = {};      ///< CascadeSpecification::use_published; none: true
};

/// @throws OptionError  naming the option, what came and what was expected
[[nodiscard]] CascadeSpecification cascade_specification(const CascadeOptions& options,
                                                         const Vehicle& vehicle);

}  // namespace quadtune
