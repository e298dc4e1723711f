// SPDX-License-Identifier: Apache-2.0
/// How a mission is flown, with the option names of `quadtune fly`.
#pragma once

#include <cstdint>
#include <optional>
#include <string>

namespace quadtune {

/// The functions that use the options validate their words: an unknown word throws OptionError.
struct FlightOptions {
  std::string vehicle;            ///< name or file
  std::string mission = "hover";  ///< name or file
  std::string controller;         ///< as controller_kind() reads it; empty: according to the gains
  std::string gains;       ///< a file, an export, "designed" or "published"; empty: "designed"
  std::string integrator;  ///< "euler", "backward-euler", "tustin"; empty: the gains' own
  /// "mambo", "mambo-original", "mambo-raw", "uquad", "general", "truth"; empty: according to
  /// the sensors.
  std::string estimator;
  std::string flow;                           ///< "full", "simplified", "off"; empty: "full"
  std::optional<double> flow_rate;            ///< [Hz]; none: the vehicle's
  std::string sensors;                        ///< "ideal", "real"; empty: "real"
  std::string wind = "calm";                  ///< as parse_wind() reads it
  std::optional<double> duration;             ///< [s]; none: the mission's
  std::string solver = "bogacki-shampine-3";  ///< method of the integration, see Integrator
  std::optional<double> step;                 ///< [s]; none: that of FlightSetup
  std::string allocation;                     ///< "prioritized" or "clipped"; empty: prioritized
  std::string take_off;                       ///< "climb" or "thrust"; empty: the mission's
  bool dynamic_environment = false;           ///< see Environment::dynamic
  std::uint64_t seed = 1;                     ///< of noise and turbulence
};

}  // namespace quadtune
