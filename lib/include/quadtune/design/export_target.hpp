// SPDX-License-Identifier: Apache-2.0
/// The targets to which a design file can be exported. The exporters themselves are in exports/.
#pragma once

#include <string>
#include <vector>

namespace quadtune {

/// A flight code or a file format for which files are exported.
struct ExportTarget {
  std::string name;  ///< as a design file and `export --to` name it
  /// Whether its files can hold past commands and motor lags; other targets hold a matrix only.
  bool takes_memory = false;
  bool needs_gains = false;  ///< whether an export requires state-feedback gains
  /// Whether its files are firmware parameters, which hold only a PID cascade.
  bool is_firmware = false;
  /// The estimator of the target's flight code, a name of EstimatorKind. Designs that are exported
  /// to the target are flown with it if the vehicle has the sensors that it needs. Empty: chosen by
  /// the sensors.
  std::string estimator = {};
};

/// The targets in the order of the documentation: uquad, mambo, json, mat, c, px4, ardupilot,
/// betaflight, crazyflie, followed by those that were added.
[[nodiscard]] const std::vector<ExportTarget>& export_targets();

/// Adds a target or replaces the target of the same name. Not safe while other threads read
/// designs.
void add_export_target(ExportTarget target);

/// @throws InvalidInput  with the unknown name, the known targets and the nearest of them.
[[nodiscard]] const ExportTarget& export_target(const std::string& name, const std::string& where);

}  // namespace quadtune
