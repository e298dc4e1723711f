// SPDX-License-Identifier: Apache-2.0
/// What a design file may be exported to. exports/ has the exporters themselves.
#pragma once

#include <string>
#include <vector>

namespace quadtune {

/// A flight program, or a format, for which files are written.
struct ExportTarget {
  std::string name;
  /// Whether its files hold a law's past commands and lags; others take a matrix alone.
  bool takes_memory = false;
  bool needs_gains = false;  ///< whether there is nothing to write without a state feedback
  /// Whether its files are a firmware's parameters, which hold a PID cascade and nothing else.
  bool is_firmware = false;
  /// The estimator of its flight program, with which a design that is exported to it is flown if
  /// the vehicle's sensors feed it: a name of EstimatorKind; empty: by the sensors.
  std::string estimator = {};
};

/// The targets in the order of the documentation: uquad, mambo, json, mat, c, px4, ardupilot,
/// betaflight, crazyflie, then those that were added.
[[nodiscard]] const std::vector<ExportTarget>& export_targets();

/// Adds a target, or replaces the one of its name. Not while other threads read designs.
void add_export_target(ExportTarget target);

/// @throws InvalidInput  naming the word, the targets that exist, and the nearest.
[[nodiscard]] const ExportTarget& export_target(const std::string& name, const std::string& where);

}  // namespace quadtune
